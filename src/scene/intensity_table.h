#pragma once

// A goniometric light's intensity by direction: a table over the unit square, which a layout maps to directions of the
// light's frame. In that frame +z is Light::direction, +y is Light::up, and +x lies to the right for whoever looks
// along +z with +y up (to the left in a mirrored frame).

#include <cstdint>
#include <memory>

#include "base/hash.h"
#include "image/image.h"
#include "math/rgb.h"
#include "math/scalar.h"

namespace pertev {

enum class TableLayout : uint8_t {
    Angles,      // rows: the angle from +z, from first_angle to last_angle; columns: once around it, from +x towards +y
    Octahedron,  // the equal-area octahedron (math/octahedron.h)
    Perspective, // a picture at z = 1, seen from the light: columns to the right (+x), rows downwards (-y)
    PictureIrradiance, // values of Perspective are irradiance of the plane here: intensity times cosine cubed
};

enum class TableFilter : uint8_t {
    Nearest, // each value fills its cell of the square
    Linear,  // bilinear between the centres of cells
    Knots, // bilinear between values at angles (Angles only): the first and last rows have first_angle and last_angle,
           // and the first column is at +x
};

struct IntensityTable {
    TableLayout layout = TableLayout::Angles;
    TableFilter filter = TableFilter::Linear;
    float first_angle = 0, last_angle = kPi; // Angles: radians; no light beyond them
    float half_width = 1, half_height = 1;   // Perspective, PictureIrradiance: tangents of half the angles of view
    Image values;                            // 3 channels in [0, 1], of which the greatest is 1
    Rgb integral;                            // over all directions, sr: the power of an intensity of 1 W/sr, in W
    Hash128 hash;                            // covers all members above

    /// Returns the numbers of cells of the square, each with its own probability of being sampled.
    uint32_t columns() const { return values.width; }
    uint32_t rows() const { return filter == TableFilter::Knots ? values.height - 1 : values.height; }
    /// Returns the mean of the table's values over a cell.
    Rgb mean_of_cell(uint32_t column, uint32_t row) const;
    /// Returns the solid angle of a cell, sr; of PictureIrradiance its area, over which its values are integrated.
    double measure_of_cell(uint32_t column, uint32_t row) const;
};

/// Completes a table whose values are numbers of any size, and of 1 to 4 channels (luminance, or colours; alpha means
/// nothing). Values that are negative or not finite become 0. `greatest` becomes what the values were divided by, 0
/// for a black table, which stays black. Knots need Angles and two rows.
std::shared_ptr<const IntensityTable> make_intensity_table(IntensityTable table, float& greatest);

/// Returns the table of a light that is symmetric about its axis, from `intensity(angle)` at angles up to
/// `last_angle`, radians, between which it is linear.
template <class Intensity>
IntensityTable make_round_table(float last_angle, const Intensity& intensity) {
    constexpr uint32_t kRows = 1025;
    IntensityTable table;
    table.filter = TableFilter::Knots;
    table.last_angle = last_angle;
    table.values = {.width = 1, .height = kRows, .channels = 1, .pixels = {}};
    for (uint32_t i = 0; i < kRows; ++i)
        table.values.pixels.push_back(intensity(last_angle * (static_cast<float>(i) / (kRows - 1))));
    return table;
}

} // namespace pertev
