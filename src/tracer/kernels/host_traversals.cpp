// The traversals of pictures on a CPU: eight boxes of one ray at a time.

#include "tracer/kernels/simd_traversals_body.h"

namespace pertev {

void add_host_kernels(std::vector<TraversalKernel>& rows) {
    add_simd_row<TraversalOptions{}, false>(rows);
    add_simd_row<TraversalOptions{}, true>(rows);
    add_simd_row<TraversalOptions{.near_first = false}, false>(rows);
    add_simd_row<TraversalOptions{.near_first = false}, true>(rows);
}

} // namespace pertev
