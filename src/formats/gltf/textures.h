#pragma once

// Texture slots of materials: glTF's textureInfo -> texture -> (image, sampler) chain as one TextureRef, with
// KHR_texture_transform as a matrix. Images are handed to the TextureLoader, each once, when first used.

#include <deque>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "base/sink.h"
#include "formats/files/load_textures.h"
#include "formats/gltf/buffers.h"
#include "formats/gltf/document.h"
#include "scene/texture.h"

namespace pertev::gltf {

/// Reads KHR_texture_transform. Throws Error(BadInput) for one that is invalid.
TextureTransform read_texture_transform(const JsonValue& transform);

class Textures {
public:
    Textures(const Document& document, Buffers& buffers, TextureLoader& loader, Sink& sink);

    /// The texture that `info`, a textureInfo, describes. The result has no image, with a warning, if that is missing,
    /// of an unsupported kind. Its set of texture coordinates is that of the file
    /// (formats/gltf/texture_sets.h). Throws Error(BadInput) for an invalid
    /// textureInfo.
    TextureRef read(const JsonValue& info);

private:
    int32_t image(const JsonValue& reference);
    int32_t add_image(const JsonValue& image);
    void leave_out_without_image(const JsonValue& texture);
    void read_sampler(const JsonValue& sampler, TextureRef& texture) const;

    const Document& document_;
    Buffers& buffers_;
    TextureLoader& loader_;
    Sink& sink_;
    std::vector<std::optional<int32_t>> images_; // [glTF image] the loader's index, once requested
    std::map<std::pair<const std::byte*, std::size_t>, int32_t> by_bytes_; // several glTF images may share a view
    std::deque<std::vector<std::byte>> embedded_; // contents of data URIs, which the loader reads later
};

} // namespace pertev::gltf
