#include "formats/load_textures.h"

#include <system_error>
#include <variant>

#include <fmt/format.h>

#include "base/error.h"
#include "base/parallel_for.h"
#include "base/read_file.h"
#include "image/decode_image.h"

namespace fs = std::filesystem;

namespace pertev {
namespace {

/// 4 linear channels, as TextureImage wants them.
Image to_rgba(const Image& image) {
    if (image.channels == 4) return image;
    const std::size_t pixels = std::size_t(image.width) * image.height;
    Image rgba{.width = image.width, .height = image.height, .channels = 4, .pixels = std::vector<float>(pixels * 4)};
    for (std::size_t i = 0; i < pixels; ++i) {
        const float* from = image.pixels.data() + i * image.channels;
        float* to = rgba.pixels.data() + i * 4;
        const bool is_grey = image.channels < 3;
        to[0] = from[0];
        to[1] = is_grey ? from[0] : from[1];
        to[2] = is_grey ? from[0] : from[2];
        to[3] = image.channels == 2 ? from[1] : 1.0f;
    }
    return rgba;
}

} // namespace

int32_t TextureLoader::add_file(const fs::path& from, const std::string& reference) {
    const fs::path path = access_.resolve(from, reference);
    const auto known = by_path_.find(path);
    if (known != by_path_.end()) return known->second;
    int32_t index = kNoImage;
    std::error_code ec;
    if (fs::exists(path, ec)) {
        index = static_cast<int32_t>(sources_.size());
        sources_.push_back({reference, path, {}});
    } else {
        messages_.warn(fmt::format("{}: there is no texture {}; its factor alone is used", from.string(), reference));
    }
    by_path_.emplace(path, index);
    return index;
}

int32_t TextureLoader::add_bytes(std::string name, std::span<const std::byte> bytes) {
    sources_.push_back({std::move(name), {}, bytes});
    return static_cast<int32_t>(sources_.size() - 1);
}

void TextureLoader::load_into(Scene& scene) {
    std::vector<TextureImage> decoded(sources_.size());
    std::vector<std::string> faults(sources_.size());
    std::vector<Messages> said(sources_.size());
    parallel_for(sources_.size(), 1, [&](uint64_t i) {
        const Source& source = sources_[i];
        decoded[i].name = source.name;
        try {
            std::vector<std::byte> file;
            if (!source.path.empty()) file = read_file(source.path);
            auto image = decode_image(source.path.empty() ? source.bytes : std::span<const std::byte>(file),
                                      source.path.empty() ? source.name : source.path.string(), &said[i]);
            if (auto* rgba8 = std::get_if<Rgba8Image>(&image)) {
                decoded[i].rgba8 = std::move(*rgba8);
            } else {
                decoded[i].rgba_float = to_rgba(std::get<Image>(image));
            }
        } catch (const Error& error) {
            faults[i] = error.what();
        }
    });

    std::vector<int32_t> renumbered(sources_.size(), kNoImage);
    for (std::size_t i = 0; i < sources_.size(); ++i) {
        for (const Message& message : said[i].all()) {
            if (message.is_warning) {
                messages_.warn(message.text);
            } else {
                messages_.note(message.text);
            }
        }
        if (!faults[i].empty()) {
            messages_.warn(fmt::format("{}; its factor alone is used", faults[i]));
            continue;
        }
        renumbered[i] = static_cast<int32_t>(scene.images.size());
        scene.images.push_back(std::move(decoded[i]));
    }
    for (Material& material : scene.materials) {
        for (TextureRef* ref : {&material.base_color_texture, &material.alpha_texture, &material.metallic_texture,
                                &material.roughness_texture, &material.emission_texture, &material.normal_texture}) {
            if (ref->has_image()) ref->image = renumbered.at(static_cast<std::size_t>(ref->image));
        }
    }
}

} // namespace pertev
