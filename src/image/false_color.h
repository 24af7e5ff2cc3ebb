#pragma once

// False colours for numbers, with a scale: low values are dark, high values bright.

#include <cstdint>
#include <string>

#include "image/image.h"

namespace pertev {

/// Colour for `t`, clamped to [0, 1]: 8-bit sRGB from dark violet over red to pale yellow, with monotonically rising
/// lightness.
struct FalseColor {
    uint8_t r, g, b;
};
FalseColor false_color(float t);

/// Sets a pixel; does nothing outside the picture.
void set_pixel(Rgba8Image& image, uint32_t x, uint32_t y, FalseColor color);
/// Draws digits, the point, letters of units and blanks, each 8 pixels wide and 10 high, with the upper left corner
/// at (x, y).
void draw_text(Rgba8Image& image, uint32_t x, uint32_t y, const std::string& text, FalseColor color);

/// A logarithmic scale.
struct FalseColorScale {
    float least = 1, most = 1000; // 0 < least < most; values beyond are clamped
    std::string unit;             // "lx", "cd/m2"
};
inline constexpr uint32_t kFalseColorScaleRows = 32;

/// Draws each pixel's luminance times `factor`. The scale is in kFalseColorScaleRows rows below the picture, labelled
/// with its ends, numbers that are 1, 2 or 5 times a power of ten as far as there is room, and the unit.
Rgba8Image draw_false_colors(const Image& linear, float factor, const FalseColorScale& scale);

/// A scale up to the first number that is 1, 2 or 5 times a power of ten and that at most one pixel in two hundred
/// exceeds, starting at a thousandth of that. For a black picture 0.001 to 1.
FalseColorScale fitting_scale(const Image& linear, float factor, std::string unit);

} // namespace pertev
