#pragma once

// The form of images on a device: bytes as they are, and floats with as few bits as hold the same values. So a picture
// with 16 bits per channel, of integers or halves, takes half the memory of its floats on the host, and its texels do
// not change.

#include <cstdint>
#include <span>
#include <vector>

#include "scene/scene.h"
#include "shading/texture_lookup.h"

namespace pertev {

struct PackedTexels {
    TexelDepth depth = TexelDepth::Float;
    std::vector<uint16_t> words; // [texels * 4]; empty for Float
};

/// Packs the texels of a float image, `rgba` with four channels each.
PackedTexels pack_texels(std::span<const float> rgba);

/// Values of texels of depth Srgb16, linear. [kSrgbWords]
std::span<const float> srgb_words_table();

/// Bytes of all images on a device, without mip-maps.
uint64_t texture_bytes(const Scene& scene);

} // namespace pertev
