// Compiled for AVX-512 (src/CMakeLists.txt), and empty where the compiler cannot keep its functions to itself.

#if defined(PERTEV_HAS_16_LANES)

#include "math/lanes16.h"

namespace pertev {
namespace {

using Floats = Floats16;

} // namespace
} // namespace pertev

#include "integrators/path/path_loop.inl"

namespace pertev {

void render_pixels_by_avx_512(const PathJob& job, const LoopTrees& trees, const BeginOrder& order, PixelRange range,
                              RayCounts& counts) {
    render_range(job, trees, order, range, counts);
}

} // namespace pertev

#endif
