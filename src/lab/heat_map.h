#pragma once

// Counts a pixel as false colours: dark is little, bright is much; the scale stands beneath the picture, with its ends
// in numbers.

#include <cstdint>
#include <span>

#include "image/false_color.h"
#include "image/image.h"

namespace pertev {

/// A picture of `counts` ([height * width], row 0 on top); pale yellow at `most` and above. 16 rows of scale stand
/// below.
Rgba8Image draw_heat_map(std::span<const uint32_t> counts, uint32_t width, uint32_t height, uint32_t most);

/// The count that one pixel in two hundred exceeds: what a scale should end at.
uint32_t scale_end(std::span<const uint32_t> counts);

} // namespace pertev
