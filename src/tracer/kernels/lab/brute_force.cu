#include "trace/brute_force_walk.h"
#include "tracer/kernels/walk_kernels_body.h"

namespace pertev {

void add_brute_force_kernels(std::vector<WalkKernel>& rows) {
    add_unordered_kernels<BruteForceWalk>(WalkKind::BruteForce, rows);
}

} // namespace pertev
