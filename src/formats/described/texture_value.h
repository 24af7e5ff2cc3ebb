#pragma once

// The value of a texture in a scene that is described by typed parameters, as far as one image with a factor and an
// offset can express it.

#include <cstdint>

#include "math/rgb.h"
#include "scene/texture.h"

namespace pertev::described {

/// The value of a texture: offset + factor * texel. Without an image it is `factor`.
struct TextureValue {
    Rgb factor = {1, 1, 1}, offset = {0, 0, 0};
    TextureRef ref;             // its image is one of the loader, or kNoImage
    int32_t made = -1;          // or one of Parts::made
    float exponent = 1;         // the gamma of the stored values; applied before factor and offset
    bool ignores_alpha = false; // an opacity is that of the colour, even if the image has an alpha channel

    bool is_of_vertices = false; // the colours of a mesh's vertices, times factor

    bool has_image() const { return ref.has_image() || made >= 0; }
    /// Returns the same value times `color`.
    TextureValue scaled(Rgb color) const {
        TextureValue value = *this;
        value.factor = color * value.factor;
        value.offset = color * value.offset;
        return value;
    }
};
inline TextureValue constant(Rgb color) {
    TextureValue value;
    value.factor = color;
    return value;
}

} // namespace pertev::described
