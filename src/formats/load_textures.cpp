#include "formats/load_textures.h"

#include <atomic>
#include <optional>
#include <system_error>
#include <variant>

#include <fmt/format.h>

#include "base/error.h"
#include "base/limits.h"
#include "base/message_text.h"
#include "base/parallel_for.h"
#include "base/read_file.h"
#include "image/decode_image.h"
#include "image/image_format.h"
#include "image/srgb.h"

namespace fs = std::filesystem;

namespace pertev {
namespace {

constexpr std::size_t kMissingNamed = 20;

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

/// What an image is read as: values as stored, or colours that are still sRGB-encoded.
struct Uses {
    bool as_srgb = false, as_data = false;
};

std::vector<Uses> uses_of(const Scene& scene, std::size_t images) {
    std::vector<Uses> uses(images);
    for (const Material& material : scene.materials) {
        for (const TextureRef* ref : material.textures()) {
            if (!ref->has_image()) continue;
            Uses& use = uses.at(static_cast<std::size_t>(ref->image));
            (ref->is_srgb ? use.as_srgb : use.as_data) = true;
        }
    }
    return uses;
}

/// A picture of 16 bits a channel: TextureImage has it in float, decoded to linear; one that is read both ways is kept
/// as stored, in 8 bits.
void put_png16(const Image& image, Uses use, TextureImage& to) {
    Image rgba = to_rgba(image);
    const std::size_t count = rgba.pixels.size();
    if (use.as_srgb && use.as_data) {
        to.rgba8 = {.width = rgba.width, .height = rgba.height, .pixels = std::vector<uint8_t>(count)};
        for (std::size_t i = 0; i < count; ++i) to.rgba8.pixels[i] = to_byte(rgba.pixels[i]);
        return;
    }
    if (use.as_srgb) {
        for (std::size_t i = 0; i < count; ++i) {
            if (i % 4 != 3) rgba.pixels[i] = srgb_decode(rgba.pixels[i]);
        }
    }
    to.rgba_float = std::move(rgba);
}

/// What the picture takes as a TextureImage.
uint64_t texture_bytes(const ImageHeader& header) {
    return uint64_t(header.width) * header.height * 4 * (header.is_float ? sizeof(float) : 1);
}

void decode(std::span<const std::byte> bytes, const std::string& name, Uses use, TextureImage& to, Messages& said) {
    auto image = decode_image(bytes, name, &said);
    if (auto* rgba8 = std::get_if<Rgba8Image>(&image)) {
        to.rgba8 = std::move(*rgba8);
    } else if (recognise_image(bytes) == ImageFormat::Png) {
        put_png16(std::get<Image>(image), use, to);
    } else {
        to.rgba_float = to_rgba(std::get<Image>(image));
    }
}

} // namespace

int32_t TextureLoader::add_file(const fs::path& from, const std::string& reference) {
    const std::optional<fs::path> path = access_.find(from, reference, messages_);
    if (!path) {
        if (missing_++ < kMissingNamed) {
            messages_.warn_of_missing(fmt::format("{}: there is no texture {}; its factor alone is used", from.string(),
                                                  shortened(reference)));
        }
        return kNoImage;
    }
    const auto [known, is_new] = by_path_.try_emplace(*path, static_cast<int32_t>(sources_.size()));
    if (is_new) sources_.push_back({reference, *path, {}});
    return known->second;
}

int32_t TextureLoader::add_bytes(std::string name, std::span<const std::byte> bytes) {
    sources_.push_back({std::move(name), {}, bytes});
    return static_cast<int32_t>(sources_.size() - 1);
}

uint64_t TextureLoader::budget(uint64_t scene_bytes) const {
    uint64_t bytes = scene_bytes;
    for (const Source& source : sources_) {
        std::error_code ec;
        const uint64_t size = source.path.empty() ? 0 : fs::file_size(source.path, ec);
        if (!ec) bytes += size;
    }
    return justified_bytes(kFreeImageBytes, bytes);
}

void TextureLoader::check_budget(const std::vector<uint64_t>& bytes, uint64_t limit) const {
    uint64_t sum = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        sum += bytes[i];
        if (sum <= limit) continue;
        const Source& source = sources_[i];
        throw Error(
            ErrorCode::OverLimit,
            fmt::format("{}: with this picture the scene's images take {} MiB in memory; the limit for files of "
                        "this size is {} MiB; use one image many times instead of copies, or smaller ones",
                        source.path.empty() ? source.name : source.path.string(), sum >> 20, limit >> 20));
    }
}

void TextureLoader::load_into(Scene& scene, uint64_t scene_bytes) {
    if (missing_ > kMissingNamed) {
        messages_.warn_of_missing(fmt::format("not there: {}", counted(missing_ - kMissingNamed, "further texture")));
    }
    std::vector<TextureImage> decoded(sources_.size());
    const std::vector<Uses> uses = uses_of(scene, sources_.size());
    std::vector<std::string> faults(sources_.size());
    std::vector<Messages> said(sources_.size());
    std::vector<uint64_t> bytes_needed(sources_.size());
    std::atomic<uint64_t> total_needed = 0;
    const uint64_t limit = budget(scene_bytes);
    parallel_for(sources_.size(), 1, [&](uint64_t i) {
        const Source& source = sources_[i];
        decoded[i].name = source.name;
        try {
            const bool is_embedded = source.path.empty();
            const std::vector<std::byte> file = is_embedded ? std::vector<std::byte>() : read_file(source.path);
            const std::span<const std::byte> bytes = is_embedded ? source.bytes : file;
            const std::string name = is_embedded ? source.name : source.path.string();
            bytes_needed[i] = texture_bytes(read_image_header(bytes, name));
            const uint64_t needed = total_needed += bytes_needed[i];
            if (needed <= limit) decode(bytes, name, uses[i], decoded[i], said[i]);
        } catch (const Error& error) {
            faults[i] = error.what();
        }
    });
    check_budget(bytes_needed, limit);

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
            messages_.warn_of_missing(fmt::format("{}; its factor alone is used", faults[i]));
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
