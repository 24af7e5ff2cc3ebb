#include "trace/brute_force_traversal.h"
#include "tracer/kernels/traversal_kernels_body.h"

namespace pertev {

void add_brute_force_kernels(std::vector<TraversalKernel>& rows) {
    add_unordered_kernels<BruteForceTraversal>(TraversalKind::BruteForce, rows);
}

} // namespace pertev
