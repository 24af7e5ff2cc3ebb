#pragma once

// Texture images and how a material looks one up. (u, v) = (0, 0) is the upper left corner of the image's top row
// (glTF); readers whose format has v pointing up flip it.

#include <cstdint>
#include <string>
#include <vector>

#include "base/host_device.h"
#include "image/image.h"

namespace pertev {

enum class Wrap : uint8_t { Repeat, MirroredRepeat, ClampToEdge };
enum class TextureFilter : uint8_t { Nearest, Linear };

inline constexpr int32_t kNoImage = -1;

/// One decoded image; exactly one of the two holds pixels.
struct TextureImage {
    std::string name;
    Rgba8Image rgba8;
    Image rgba_float; // 4 channels, linear; for HDR and EXR sources
};

/// One use of an image by a material slot.
struct TextureRef {
    int32_t image = kNoImage; // index into Scene::images; kNoImage: the slot's factor alone counts
    Wrap wrap_s = Wrap::Repeat, wrap_t = Wrap::Repeat;
    TextureFilter filter = TextureFilter::Linear;
    uint8_t uv_set = 0;   // 0 or 1
    bool is_srgb = false; // colour channels of an 8-bit image are sRGB-encoded
    uint8_t channel = 0;  // 0 to 3, for slots that read one number
    // uv' = (m00 u + m01 v + m02, m10 u + m11 v + m12), KHR_texture_transform as one matrix
    float m00 = 1, m01 = 0, m02 = 0, m10 = 0, m11 = 1, m12 = 0;

    HD bool has_image() const { return image != kNoImage; }
};

} // namespace pertev
