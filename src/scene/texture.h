#pragma once

// Texture images, and their use in materials. (u, v) = (0, 0) is the upper left corner of the image's top row (glTF);
// readers of formats with v upwards flip it.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "base/host_device.h"
#include "image/image.h"
#include "math/vec2.h"

namespace pertev {

enum class Wrap : uint8_t { Repeat, MirroredRepeat, ClampToEdge };
enum class TextureFilter : uint8_t { Nearest, Linear };

inline constexpr int32_t kNoImage = -1;
inline constexpr std::size_t kTextureSets = 4; // number of sets of texture coordinates of a mesh

/// A decoded image; exactly one of the two members has pixels.
struct TextureImage {
    std::string name;
    Rgba8Image rgba8;
    Image rgba_float; // 4 channels, linear; from HDR and EXR files
};

/// The use of an image by a texture slot of a material.
struct TextureRef {
    int32_t image = kNoImage; // index into Scene::images; kNoImage: only the slot's factor counts
    Wrap wrap_s = Wrap::Repeat, wrap_t = Wrap::Repeat;
    TextureFilter filter = TextureFilter::Linear;
    uint8_t uv_set = 0;   // below kTextureSets
    bool is_srgb = false; // colour channels of an 8-bit image are sRGB-encoded
    uint8_t channel = 0;  // 0 to 3, for slots that use one channel
    // uv' = (m00 u + m01 v + m02, m10 u + m11 v + m12), KHR_texture_transform as one matrix
    float m00 = 1, m01 = 0, m02 = 0, m10 = 0, m11 = 1, m12 = 0;

    HD bool has_image() const { return image != kNoImage; }
};

/// The transform of texture coordinates, which are scaled, then rotated, then moved.
struct TextureTransform {
    Vec2 offset = {0, 0}, scale = {1, 1};
    float rotation = 0; // radians, counter-clockwise in u right, v down
};

/// Sets the matrix of a texture. Source: KHR_texture_transform, whose rotation's sign is that of its words, pictures
/// and test model; the GLSL in its text turns the other way (KhronosGroup/glTF #1563).
void set_transform(TextureRef& texture, const TextureTransform& transform);

} // namespace pertev
