#include "apps/viewer/window_shape.h"

#include <algorithm>
#include <cmath>

namespace pertev {
namespace {

constexpr double kLongest = 4;  // times the other side
constexpr double kMinSide = 16; // pixels

uint32_t even_side(double side) {
    return 2 * static_cast<uint32_t>(std::floor(std::max(side, kMinSide) / 2 + 1e-6)); // a third of 3840 is 1280
}

} // namespace

PictureSize size_for_window(uint32_t width, uint32_t height, uint64_t max_pixels) {
    const double across = std::min<double>(width, kLongest * height), down = std::min<double>(height, kLongest * width);
    const double scale = std::min(1.0, std::sqrt(static_cast<double>(max_pixels) / (across * down)));
    return {even_side(across * scale), even_side(down * scale)};
}

} // namespace pertev
