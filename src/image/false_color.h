#pragma once

// Numbers as false colours, with their scale: dark is little, bright is much.

#include <cstdint>
#include <string>

#include "image/image.h"

namespace pertev {

/// `t` in [0, 1], clamped: 8-bit sRGB from dark violet over red to pale yellow, of rising lightness throughout.
struct FalseColor {
    uint8_t r, g, b;
};
FalseColor false_color(float t);

/// Sets a pixel; nothing outside the picture.
void set_pixel(Rgba8Image& image, uint32_t x, uint32_t y, FalseColor color);
/// Digits, the point, letters of units and blanks, each 8 pixels wide and 10 high, from the upper left corner (x, y)
/// on.
void draw_text(Rgba8Image& image, uint32_t x, uint32_t y, const std::string& text, FalseColor color);

/// A scale of even steps in the logarithm.
struct FalseColorScale {
    float least = 1, most = 1000; // 0 < least < most; what is beyond is shown as these
    std::string unit;             // "lx", "cd/m2"
};
inline constexpr uint32_t kFalseColorScaleRows = 32;

/// Each pixel's luminance times `factor`. The scale stands in kFalseColorScaleRows rows beneath the picture, with its
/// ends, what is 1, 2 or 5 times a power of ten between them as far as there is room, and the unit.
Rgba8Image draw_false_colors(const Image& linear, float factor, const FalseColorScale& scale);

/// Up to the first 1, 2 or 5 times a power of ten that no more than one pixel in two hundred exceeds, and from a
/// thousandth of that on. Of a black picture 0.001 to 1.
FalseColorScale fitting_scale(const Image& linear, float factor, std::string unit);

} // namespace pertev
