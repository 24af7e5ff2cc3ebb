#include "trace/binary/restart_trail_traversal.h"
#include "tracer/kernels/traversal_kernels_body.h"

namespace pertev {

void add_restart_trail_kernels(std::vector<TraversalKernel>& rows) {
    add_all_kernels<RestartTrailTraversal>(TraversalKind::RestartTrail, rows);
}

} // namespace pertev
