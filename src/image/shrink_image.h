#pragma once

// Scales pictures down by averaging the area of each new pixel. Each channel by itself, alpha too.

#include <cstdint>
#include <utility>

#include "image/image.h"

namespace pertev {

/// Returns the size with the same shape whose longer side is `longest` pixels; the same size if it is not larger.
std::pair<uint32_t, uint32_t> shrunk_size(uint32_t width, uint32_t height, uint32_t longest);

// Each scales a picture down to shrunk_size(). With `is_srgb` its colours are sRGB-encoded: the means are those of the
// linear values.
Rgba8Image shrink_image(const Rgba8Image& image, uint32_t longest, bool is_srgb);
Image shrink_image(const Image& image, uint32_t longest, bool is_srgb);

} // namespace pertev
