#pragma once

// Colours by other primaries than ours: linear R, G, B of a picture to linear Rec. 709, which all light is computed in.
//
// Source: SMPTE RP 177 for the matrix of a set of primaries; the adaptation of the white point by Bradford's cone
// responses (Lam 1985, as Lindbloom gives them), so that white stays white.

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

/// Whether colours by these primaries are ours: no number is further than 0.0005 from that of Rec. 709.
bool is_rec709(const ColorPrimaries& primaries);

/// The matrix that makes linear R, G, B by these primaries linear Rec. 709. Nothing where they are degenerate: a number
/// that is not finite or larger than 4, primaries on one line, or a white that no positive amounts of them give.
std::optional<ColorMatrix> rec709_from(const ColorPrimaries& primaries);

/// Multiplies R, G, B of each pixel, with or without alpha. Grey pictures and pixels that are not finite stay.
void convert_colors(const ColorMatrix& matrix, Image& image);

} // namespace pertev
