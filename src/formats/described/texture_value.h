#pragma once

// The value of a texture in a scene that is described by typed parameters, as far as one image with a factor and an
// offset can express it.

#include <cstdint>
#include <memory>

#include "formats/described/texture_mapping.h"
#include "math/rgb.h"
#include "scene/texture.h"

namespace pertev::described {

/// The conversion of a value after factor and offset.
enum class Curve {
    None,
    RoughnessOfWidth,    // a microfacet width: roughness is its root
    RoughnessOfRoot,     // pbrt-v4's remapped roughness, of which the width is the root
    RoughnessOfVersion3, // pbrt-v3's remapped roughness
    RoughnessOfGlass3,   // that of pbrt-v3's glass, where 0 stays smooth
    Root,                // one of two interfaces transmits it, for the colour of both
    BeneathCoat,         // the albedo of a diffuse surface beneath a smooth coat that reflects `amount` from inside
};

/// Returns `value` converted. A converted roughness is Pertev's: the root of the width.
float converted(Curve curve, float amount, float value);

/// The number that a coloured texel stands for.
enum class GreyOf {
    Channels,         // each channel counts for itself
    Mean,             // pbrt-v4, Mitsuba 0.6
    Luminance,        // Mitsuba 3
    EncodedLuminance, // before the encoding is taken off: pbrt-v3
};

/// Two colours mixed by the direction of a surface: the first with the share |normal . direction|.
struct NormalMix {
    DoubleVec3 direction; // unit, in the world of the file
    Rgb first, second;
    Curve curve = Curve::None; // converts the mixed colour
    float amount = 0;
    Rgb mean() const {
        const Rgb sum = 0.5f * (first + second);
        return {converted(curve, amount, sum.r), converted(curve, amount, sum.g), converted(curve, amount, sum.b)};
    }
};

/// The value of a texture: offset + factor * texel. Without an image it is `factor`.
struct TextureValue {
    Rgb factor = {1, 1, 1}, offset = {0, 0, 0};
    TextureRef ref;                    // its image is one of the loader, or kNoImage
    int32_t made = -1;                 // index into Parts::made; -1: none
    float exponent = 1;                // the gamma of the stored values; applied before factor and offset
    GreyOf grey_of = GreyOf::Channels; // applied to the texels before factor and offset
    bool ignores_alpha = false;        // an opacity is that of the colour, even if the image has an alpha channel
    bool is_framed = false;            // beyond the image, whose wrap is ClampToEdge, texels are black

    std::shared_ptr<const TextureMapping> mapping; // gives the coordinates of its image; null: the mesh does
    bool is_of_vertices = false;                   // the colours of a mesh's vertices, times factor
    std::shared_ptr<const NormalMix> by_normal;    // the value by direction, of which `factor` is the mean

    bool has_image() const { return ref.has_image() || made >= 0; }
    bool varies() const { return has_image() || by_normal != nullptr; }
    /// Returns the same value times `color`.
    TextureValue scaled(Rgb color) const {
        TextureValue value = *this;
        value.factor = color * value.factor;
        value.offset = color * value.offset;
        if (by_normal)
            value.by_normal = std::make_shared<NormalMix>(
                NormalMix{by_normal->direction, color * by_normal->first, color * by_normal->second});
        return value;
    }
};
inline TextureValue constant(Rgb color) {
    TextureValue value;
    value.factor = color;
    return value;
}

} // namespace pertev::described
