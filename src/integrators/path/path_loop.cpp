#include "integrators/path/path_loop.h"

#include "math/lanes.h"

namespace pertev {
namespace {

using Floats = Floats8;

} // namespace
} // namespace pertev

#include "integrators/path/path_loop.inl"

namespace pertev {

void render_pixels(const PathJob& job, const LoopTrees& trees, const BeginOrder& order, PixelRange range,
                   RayCounts& counts) {
#if defined(PERTEV_HAS_16_LANES)
    static const bool has_avx_512 = takes_sixteen_lanes();
    if (has_avx_512) return render_pixels_by_avx_512(job, trees, order, range, counts);
#endif
    render_range(job, trees, order, range, counts);
}

} // namespace pertev
