#pragma once

// Coarser levels of a scene's images, made on the device from the images there.

#include <vector>

#include "device/buffer.h"
#include "shading/texture_lookup.h"

namespace pertev {

class MipMapLevels {
public:
    /// Makes the levels of `images`, whose pixels are on the device; `are_srgb` says whose colours are sRGB-encoded,
    /// and `linear_from_srgb` is on the device. Throws Error(OutOfMemory).
    MipMapLevels(Queue& queue, std::vector<TextureImageView> images, const std::vector<bool>& are_srgb,
                 const float* linear_from_srgb);

    /// The images with their levels behind them.
    const TextureImageView* images() const { return views_.data(); }

private:
    Buffer<std::byte> texels_;
    Buffer<TextureImageView> views_;
};

} // namespace pertev
