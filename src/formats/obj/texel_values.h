#pragma once

// Values of a decoded image, whatever its depth, for decisions about what an .mtl file's picture holds.

#include <cstddef>

#include "math/scalar.h"
#include "scene/texture.h"

namespace pertev {

inline std::size_t pixel_count(const TextureImage& image) {
    return max(image.rgba8.pixels.size(), image.rgba_float.pixels.size()) / 4;
}

/// Returns channel 0 to 3 of a pixel as stored, in [0, 1] for an 8-bit image.
inline float texel_value(const TextureImage& image, std::size_t pixel, std::size_t channel) {
    const std::size_t at = 4 * pixel + channel;
    return image.rgba8.pixels.empty() ? image.rgba_float.pixels[at] : static_cast<float>(image.rgba8.pixels[at]) / 255;
}

} // namespace pertev
