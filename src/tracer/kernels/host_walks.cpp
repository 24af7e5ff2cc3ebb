// The traversals of pictures on a CPU: eight boxes of one ray at a time.

#include "tracer/kernels/simd_traversals_body.h"

namespace pertev {

void add_host_kernels(std::vector<WalkKernel>& rows) {
    add_simd_row<WalkOptions{}, false>(rows);
    add_simd_row<WalkOptions{}, true>(rows);
    add_simd_row<WalkOptions{.near_first = false}, false>(rows);
    add_simd_row<WalkOptions{.near_first = false}, true>(rows);
}

} // namespace pertev
