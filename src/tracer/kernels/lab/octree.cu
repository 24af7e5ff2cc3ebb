#include "trace/cells/octree_traversal.h"
#include "tracer/kernels/traversal_kernels_body.h"

namespace pertev {

void add_octree_kernels(std::vector<TraversalKernel>& rows) {
    add_all_kernels<OctreeTraversal>(TraversalKind::Octree, rows);
}

} // namespace pertev
