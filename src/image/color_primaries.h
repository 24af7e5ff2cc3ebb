#pragma once

// Conversion of colours with other primaries to linear Rec. 709, in which all light is computed.
//
// Source: SMPTE RP 177 for the matrix of a set of primaries; chromatic adaptation of the white point by Bradford's
// cone responses (Lam 1985, as Lindbloom gives them), so that white stays white.

#include <array>
#include <optional>

#include "image/image.h"

namespace pertev {

struct Chromaticity {
    double x = 0, y = 0; // CIE 1931
};

struct ColorPrimaries {
    Chromaticity red, green, blue, white;
};

inline constexpr ColorPrimaries kRec709 = {
    .red = {0.64, 0.33}, .green = {0.30, 0.60}, .blue = {0.15, 0.06}, .white = {0.3127, 0.3290}};

using ColorMatrix = std::array<std::array<double, 3>, 3>; // row by row

/// Returns whether the primaries are those of Rec. 709, up to 0.0005 per number.
bool is_rec709(const ColorPrimaries& primaries);

/// The matrix from linear R, G, B with these primaries to linear Rec. 709. Nothing if they are degenerate: a number
/// that is not finite or larger than 4, primaries on one line, or a white that no positive amounts of them give.
std::optional<ColorMatrix> rec709_from(const ColorPrimaries& primaries);

/// Multiplies R, G, B of each pixel, with or without alpha. Grey pictures and pixels that are not finite do not
/// change.
void convert_colors(const ColorMatrix& matrix, Image& image);

} // namespace pertev
