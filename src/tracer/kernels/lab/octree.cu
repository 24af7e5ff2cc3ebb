#include "trace/cells/octree_walk.h"
#include "tracer/kernels/walk_kernels_body.h"

namespace pertev {

void add_octree_kernels(std::vector<WalkKernel>& rows) { add_all_kernels<OctreeWalk>(WalkKind::Octree, rows); }

} // namespace pertev
