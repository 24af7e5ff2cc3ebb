#pragma once

// Per-pixel counts in false colours: dark is low, bright is high. A colour scale below the picture has its two ends
// labelled.

#include <cstdint>
#include <span>

#include "image/false_color.h"
#include "image/image.h"

namespace pertev {

/// Draws `counts` ([height * width], row 0 on top). `most` and larger counts are pale yellow. The picture gets 16
/// more rows at the bottom for the scale.
Rgba8Image draw_heat_map(std::span<const uint32_t> counts, uint32_t width, uint32_t height, uint32_t most);

/// Returns the count that one pixel in two hundred exceeds: a good end for the scale.
uint32_t scale_end(std::span<const uint32_t> counts);

} // namespace pertev
