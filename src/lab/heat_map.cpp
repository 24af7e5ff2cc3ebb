#include "lab/heat_map.h"

#include <algorithm>
#include <string>
#include <vector>

#include "base/error.h"
#include "math/scalar.h"

namespace pertev {
namespace {

constexpr uint32_t kScaleRows = 16;

// Digits of 3 x 5 points, a row three bits, the topmost row first.
constexpr uint16_t kDigits[10] = {0b111101101101111, 0b010110010010111, 0b111001111100111, 0b111001111001111,
                                  0b101101111001001, 0b111100111001111, 0b111100111101111, 0b111001010010010,
                                  0b111101111101111, 0b111101111001111};

void set_pixel(Rgba8Image& image, uint32_t x, uint32_t y, FalseColor c) {
    if (x >= image.width || y >= image.height) return;
    uint8_t* p = &image.pixels[4 * (std::size_t(y) * image.width + x)];
    p[0] = c.r, p[1] = c.g, p[2] = c.b, p[3] = 255;
}

/// Twice as large as the points are, its upper left corner at (x, y).
void draw_number(Rgba8Image& image, uint32_t x, uint32_t y, uint32_t number, FalseColor color) {
    for (const char digit : std::to_string(number)) {
        const uint16_t points = kDigits[digit - '0'];
        for (uint32_t i = 0; i < 15; ++i) {
            if (!(points >> (14 - i) & 1)) continue;
            for (uint32_t k = 0; k < 4; ++k) {
                set_pixel(image, x + 2 * (i % 3) + k % 2, y + 2 * (i / 3) + k / 2, color);
            }
        }
        x += 8;
    }
}

} // namespace

FalseColor false_color(float t) {
    // Lightness rises evenly, hue turns once from violet to yellow.
    constexpr float stops[7][3] = {{0, 0, 10},     {50, 10, 95},   {122, 28, 109}, {190, 55, 84},
                                   {237, 105, 37}, {251, 180, 26}, {252, 255, 180}};
    const float at = clamp(t, 0.0f, 1.0f) * 6.0f;
    const int k = std::min(static_cast<int>(at), 5);
    const float f = at - static_cast<float>(k);
    const auto channel = [&](int c) {
        return static_cast<uint8_t>(floor(stops[k][c] + (stops[k + 1][c] - stops[k][c]) * f + 0.5f));
    };
    return {channel(0), channel(1), channel(2)};
}

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
    draw_number(image, 3, height + 4, 0, {255, 255, 255});
    const auto digits = static_cast<uint32_t>(std::to_string(most).size());
    if (width > 8 * digits + 16) draw_number(image, width - 8 * digits - 2, height + 4, most, {0, 0, 0});
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
