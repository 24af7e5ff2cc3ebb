#include "lab/heat_map.h"

#include <algorithm>
#include <string>
#include <vector>

#include "base/error.h"

namespace pertev {
namespace {

constexpr uint32_t kScaleRows = 16;

} // namespace

Rgba8Image draw_heat_map(std::span<const uint32_t> counts, uint32_t width, uint32_t height, uint32_t most) {
    PERTEV_CHECK(counts.size() == std::size_t(width) * height && most > 0);
    Rgba8Image image{width, height + kScaleRows, {}};
    image.pixels.assign(std::size_t(4) * image.width * image.height, 255);
    for (std::size_t i = 0; i < counts.size(); ++i) {
        const float t = static_cast<float>(counts[i]) / static_cast<float>(most);
        set_pixel(image, static_cast<uint32_t>(i % width), static_cast<uint32_t>(i / width), false_color(t));
    }
    for (uint32_t x = 0; x < width; ++x) {
        const FalseColor color = false_color((static_cast<float>(x) + 0.5f) / static_cast<float>(width));
        for (uint32_t y = 2; y < kScaleRows; ++y) set_pixel(image, x, height + y, color);
    }
    draw_text(image, 3, height + 4, "0", {255, 255, 255});
    const std::string end = std::to_string(most);
    const auto digits = static_cast<uint32_t>(end.size());
    if (width > 8 * digits + 16) draw_text(image, width - 8 * digits - 2, height + 4, end, {0, 0, 0});
    return image;
}

uint32_t scale_end(std::span<const uint32_t> counts) {
    if (counts.empty()) return 1;
    std::vector<uint32_t> sorted(counts.begin(), counts.end());
    const auto at = sorted.begin() + static_cast<std::ptrdiff_t>((sorted.size() - 1) * 199 / 200);
    std::ranges::nth_element(sorted, at);
    return std::max(*at, 1u);
}

} // namespace pertev
