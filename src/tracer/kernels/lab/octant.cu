#include "trace/binary/octant_walk.h"
#include "tracer/kernels/walk_kernels_body.h"

namespace pertev {

void add_octant_kernels(std::vector<WalkKernel>& rows) { add_other_kernels<OctantWalk>(WalkKind::Octants, rows); }

} // namespace pertev
