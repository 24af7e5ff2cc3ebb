#include "apps/viewer/reference_is_better.h"

#include <algorithm>
#include <cmath>

namespace pertev {
namespace {

/// Position of the middle of pixel `at` of `of` among `among` pixels: the first of two, and the weight of the other.
struct Between {
    uint32_t first, second;
    double share;
};
Between between(uint32_t at, uint32_t of, uint32_t among) {
    const double rank = std::clamp((at + 0.5) * among / of - 0.5, 0.0, among - 1.0);
    const auto first = static_cast<uint32_t>(rank);
    return {first, std::min(first + 1, among - 1), rank - first};
}

} // namespace

bool reference_is_better(const Rgba8Image& whole, const Rgba8Image& half, const Rgba8Image& reconstruction) {
    double own = 0, both = 0;
    for (uint32_t y = 0; y < whole.height; ++y) {
        const Between row = between(y, whole.height, reconstruction.height);
        for (uint32_t x = 0; x < whole.width; ++x) {
            const Between column = between(x, whole.width, reconstruction.width);
            const std::size_t pixel = 4 * (std::size_t(y) * whole.width + x);
            for (std::size_t c = 0; c < 3; ++c) {
                const auto at = [&](uint32_t left, uint32_t top) {
                    return double(reconstruction.pixels[4 * (std::size_t(top) * reconstruction.width + left) + c]);
                };
                const double above = std::lerp(at(column.first, row.first), at(column.second, row.first), column.share);
                const double below =
                    std::lerp(at(column.first, row.second), at(column.second, row.second), column.share);
                const double value = whole.pixels[pixel + c], of_half = value - half.pixels[pixel + c],
                             of_other = value - std::lerp(above, below, row.share);
                own += of_half * of_half;
                both += of_other * of_other;
            }
        }
    }
    return both > 2 * own;
}

} // namespace pertev
