#pragma once

// Look-up tables for a picture's display, from .cube files: curves, a table of three dimensions, or curves that shape
// the light for the table.
//
// Source: Adobe Systems, "Cube LUT Specification 1.0", 2013; Blackmagic Design, DaVinci Resolve's .cube files (curves
// before a table, input ranges); Kasson, Nin, Plouffe, Hafner, "Performing color space conversions with
// three-dimensional linear interpolation", Journal of Electronic Imaging 4(3), 1995 (tetrahedra).

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "math/rgb.h"

namespace pertev {

inline constexpr uint32_t kMaxLutSide = 256;      // the specification has these limits
inline constexpr uint32_t kMaxLutCurve = 1 << 16; // points

class CubeLut {
public:
    /// Reads LUT_1D_SIZE, LUT_3D_SIZE, their domains (DOMAIN_MIN and DOMAIN_MAX, or LUT_1D_INPUT_RANGE and
    /// LUT_3D_INPUT_RANGE), TITLE, comments, curves and the table, whose red runs fastest. Throws Error(BadInput) with
    /// the file and the line.
    static CubeLut parse(std::span<const std::byte> bytes, const std::string& name);
    static CubeLut read(const std::filesystem::path& path);

    /// Interpolates the curves linearly, then between the four corners of the tetrahedron that holds the result. Both
    /// clamp to their domain. NaN counts as the least. The result is whatever the file has, also beyond [0, 1].
    Rgb operator()(Rgb color) const;

    uint32_t side() const { return side_; } // 0: there are only curves

private:
    struct Domain {
        Rgb low = {0, 0, 0}, high = {1, 1, 1};
        bool is_valid() const { return low.r < high.r && low.g < high.g && low.b < high.b; }
    };
    struct Lines;
    struct Reading;

    Rgb on_curves(Rgb color) const;
    Rgb in_table(Rgb color) const;
    Rgb at(uint32_t r, uint32_t g, uint32_t b) const {
        return table_[(static_cast<std::size_t>(b) * side_ + g) * side_ + r];
    }

    uint32_t side_ = 0;
    Domain curve_domain_, domain_;
    std::vector<Rgb> curves_; // each point has a value of each channel
    std::vector<Rgb> table_;  // [side^3]
};

} // namespace pertev
