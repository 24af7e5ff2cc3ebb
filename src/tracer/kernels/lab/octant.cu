#include "trace/binary/octant_traversal.h"
#include "tracer/kernels/traversal_kernels_body.h"

namespace pertev {

void add_octant_kernels(std::vector<TraversalKernel>& rows) {
    add_other_kernels<OctantTraversal>(TraversalKind::Octants, rows);
}

} // namespace pertev
