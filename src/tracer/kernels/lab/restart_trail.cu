#include "trace/binary/restart_trail_walk.h"
#include "tracer/kernels/walk_kernels_body.h"

namespace pertev {

void add_restart_trail_kernels(std::vector<WalkKernel>& rows) {
    add_all_kernels<RestartTrailWalk>(WalkKind::RestartTrail, rows);
}

} // namespace pertev
