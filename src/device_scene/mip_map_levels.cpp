#include "device_scene/mip_map_levels.h"

#include "device/launch.h"
#include "device_scene/halve_texture.h"

namespace pertev {
namespace {

std::size_t bytes_of(const TextureImageView& level) {
    const std::size_t texel = level.depth == TexelDepth::Byte ? 4 : 4 * sizeof(float);
    return (std::size_t(level.width) * level.height * texel + 15) / 16 * 16; // floats are aligned
}

/// Appends the levels of `images` without their pixels. Returns the bytes that these take.
std::size_t add_levels(std::vector<TextureImageView>& images) {
    const std::size_t count = images.size();
    std::size_t bytes = 0;
    for (std::size_t i = 0; i < count; ++i) {
        images[i].first_coarser = static_cast<uint32_t>(images.size());
        TextureImageView level = {.width = images[i].width,
                                  .height = images[i].height,
                                  .depth = images[i].depth == TexelDepth::Byte ? TexelDepth::Byte : TexelDepth::Float};
        while (level.width > 1 || level.height > 1) {
            level.width = halved_texels(level.width);
            level.height = halved_texels(level.height);
            bytes += bytes_of(level);
            images.push_back(level);
            ++images[i].coarser_levels;
        }
    }
    return bytes;
}

} // namespace

MipMapLevels::MipMapLevels(Queue& queue, std::vector<TextureImageView> images, const std::vector<bool>& are_srgb,
                           const float* linear_from_srgb) {
    const std::size_t count = images.size();
    texels_ = Buffer<std::byte>(queue, add_levels(images), "mip-maps");
    std::byte* texels = texels_.data();
    for (std::size_t i = 0; i < count; ++i) {
        TextureImageView from = images[i];
        for (uint32_t k = 0; k < images[i].coarser_levels; ++k) {
            TextureImageView& level = images[images[i].first_coarser + k];
            const bool has_bytes = level.depth == TexelDepth::Byte;
            const HalveTexture halve = {from,
                                        level.width,
                                        level.height,
                                        are_srgb[i],
                                        linear_from_srgb,
                                        has_bytes ? reinterpret_cast<uint8_t*>(texels) : nullptr,
                                        has_bytes ? nullptr : reinterpret_cast<float*>(texels)};
            launch(queue, "halve_texture", level.width * level.height, halve);
            level.rgba8 = halve.bytes;
            level.rgba_float = halve.floats;
            texels += bytes_of(level);
            from = level;
        }
    }
    views_ = Buffer<TextureImageView>(queue, std::span<const TextureImageView>(images), "mip-maps");
}

} // namespace pertev
