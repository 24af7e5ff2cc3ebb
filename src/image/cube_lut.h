#pragma once

// Three-dimensional look-up tables for a picture's display, from .cube files.
//
// Source: Adobe Systems, "Cube LUT Specification 1.0", 2013; Kasson, Nin, Plouffe, Hafner, "Performing color space
// conversions with three-dimensional linear interpolation", Journal of Electronic Imaging 4(3), 1995 (tetrahedra).

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "math/rgb.h"

namespace pertev {

inline constexpr uint32_t kMaxLutSide = 256; // the specification has this limit

class CubeLut {
public:
    /// Reads LUT_3D_SIZE, DOMAIN_MIN, DOMAIN_MAX, TITLE, comments and the table, whose red runs fastest. Throws
    /// Error(BadInput) with the file and the line, also for tables of one dimension, and Error(OverLimit).
    static CubeLut parse(std::span<const std::byte> bytes, const std::string& name);
    static CubeLut read(const std::filesystem::path& path);

    /// Interpolates between the four corners of the tetrahedron that holds `color`, which is clamped to the domain. NaN
    /// counts as the least. The result is whatever the table has, also beyond [0, 1].
    Rgb operator()(Rgb color) const;

    uint32_t side() const { return side_; }

private:
    Rgb at(uint32_t r, uint32_t g, uint32_t b) const {
        return table_[(static_cast<std::size_t>(b) * side_ + g) * side_ + r];
    }

    uint32_t side_ = 0;
    Rgb low_ = {0, 0, 0}, high_ = {1, 1, 1}; // the domain
    std::vector<Rgb> table_;                 // [side^3]
};

} // namespace pertev
