#pragma once

// Writes textures of materials: images as PNG in the file's binary chunk, with samplers and KHR_texture_transform. glTF
// fixes the channel and the encoding of every slot, so an image that has others is written a second time.

#include <array>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "base/sink.h"
#include "formats/gltf_writer/glb_parts.h"
#include "scene/scene.h"

namespace pertev::glb {

/// A channel of a texture of the scene, which a channel of a written one is; without a texture it is 1.
struct TextureChannel {
    const TextureRef* texture = nullptr;
    uint8_t channel = 0;
};

class TextureWriter {
public:
    /// `scene` is written to `parts`; `sink` gets what is lost. The arguments must outlive this object.
    TextureWriter(const Scene& scene, GlbParts& parts, Sink& sink) : scene_(scene), parts_(parts), sink_(sink) {}

    /// Returns a textureInfo that has these channels, with additional members such as a scale, or "" if none has an
    /// image. `owner` names the material in messages.
    std::string info(const std::array<TextureChannel, 4>& channels, bool is_srgb, const std::string& owner,
                     JsonMembers more = {});
    /// Returns a textureInfo with all channels of one texture.
    std::string info(const TextureRef& texture, bool is_srgb, const std::string& owner, JsonMembers more = {});
    /// Returns a textureInfo with the one channel that a slot has, at channel `to`.
    std::string channel(const TextureRef& texture, uint8_t to, const std::string& owner);

private:
    /// The images and channels that an image is made of, and its encoding.
    using Recipe = std::tuple<std::array<int32_t, 4>, std::array<uint8_t, 4>, std::array<bool, 4>, bool>;

    uint32_t image_of(const Recipe& recipe, const std::string& owner);
    Rgba8Image make_image(const Recipe& recipe, const std::string& owner);
    std::string transform_of(const TextureRef& texture, const std::string& owner);

    const Scene& scene_;
    GlbParts& parts_;
    Sink& sink_;
    std::map<Recipe, uint32_t> images_;
};

} // namespace pertev::glb
