#include "formats/files/load_textures.h"

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
#include "image/decode_webp.h"
#include "image/image_format.h"
#include "image/picture_primaries.h"
#include "image/shrink_image.h"
#include "image/srgb.h"

namespace fs = std::filesystem;

namespace pertev {
namespace {

constexpr std::size_t kMissingNamed = 20;

/// Converts an image to the 4 linear channels of a TextureImage.
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

/// The uses of an image: values as stored, or colours that are still sRGB-encoded. Colours are converted to Rec. 709.
struct Uses {
    bool as_srgb = false, as_data = false, as_color = false;
};

std::vector<Uses> uses_of(const Scene& scene, std::size_t images) {
    std::vector<Uses> uses(images);
    for (const Material& material : scene.materials) {
        for (const TextureRef* ref : material.textures()) {
            Uses& use = uses.at(static_cast<std::size_t>(ref->image));
            (ref->is_srgb ? use.as_srgb : use.as_data) = true;
            use.as_color |= ref == &material.base_color_texture || ref == &material.emission_texture;
        }
    }
    return uses;
}

TextureImage texture_of(std::variant<Rgba8Image, Image> image, bool is_encoded, const std::string& name) {
    TextureImage to;
    to.name = name;
    if (auto* rgba8 = std::get_if<Rgba8Image>(&image)) {
        to.rgba8 = std::move(*rgba8);
        return to;
    }
    to.rgba_float = to_rgba(std::get<Image>(image));
    if (!is_encoded) return to;
    std::vector<float>& values = to.rgba_float.pixels;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (i % 4 != 3) values[i] = srgb_decode(values[i]);
    }
    return to;
}

/// Returns the glTF extension of a picture's format if this program does not decode it; empty for any other.
std::string_view extension_of(std::span<const std::byte> picture) {
    const std::string_view bytes(reinterpret_cast<const char*>(picture.data()),
                                 std::min<std::size_t>(picture.size(), 12));
    if (is_webp(picture)) return has_webp() ? "" : "EXT_texture_webp";
    if (bytes.starts_with("\xabKTX 20")) return "KHR_texture_basisu";
    return bytes.ends_with("ftypavif") ? "EXT_texture_avif" : "";
}

} // namespace

int32_t TextureLoader::add_file(const FileLocation& from, const std::string& reference) {
    const std::optional<fs::path> path = access_.find(from, reference, *sink_);
    if (!path) {
        if (missing_++ < kMissingNamed) {
            sink_->leave_out(
                {from, fmt::format("there is no texture {}; only its factor is used", shortened(reference))});
        }
        return kNoImage;
    }
    const auto [known, is_new] = by_path_.try_emplace(*path, static_cast<int32_t>(sources_.size()));
    if (is_new) sources_.push_back({.name = reference, .path = *path, .bytes = {}});
    return known->second;
}

int32_t TextureLoader::add_bytes(std::string name, std::span<const std::byte> bytes) {
    sources_.push_back({.name = std::move(name), .path = {}, .bytes = bytes});
    return static_cast<int32_t>(sources_.size() - 1);
}

/// Returns the number of bytes of a picture as a TextureImage.
uint64_t TextureLoader::texture_bytes(const ImageHeader& header) const {
    const auto [width, height] =
        shrunk_size(header.width, header.height, longest_ > 0 ? longest_ : std::max(header.width, header.height));
    return uint64_t(width) * height * 4 * (header.is_float ? sizeof(float) : 1);
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

void TextureLoader::check_budget(uint64_t limit) const {
    uint64_t sum = 0;
    for (const Source& source : sources_) {
        sum += source.texture_bytes;
        if (sum <= limit) continue;
        throw Error(ErrorCode::OverLimit, FileLocation{source.path.empty() ? source.name : source.path.string()},
                    fmt::format("with this picture the scene's images take {} MiB of memory; the limit for files of "
                                "this size is {} MiB; share one image instead of copies, or set `max_texture_size`",
                                sum >> 20, limit >> 20));
    }
}

/// Decodes a picture, unless it and all pictures before it, which take `all_bytes`, would take more than `limit` bytes.
void TextureLoader::read(Source& source, uint64_t limit, std::atomic<uint64_t>& all_bytes) const {
    const bool is_embedded = source.path.empty();
    std::vector<std::byte> file;
    try {
        if (!is_embedded) file = read_file(source.path);
        const std::span<const std::byte> bytes = is_embedded ? source.bytes : file;
        const std::string name = is_embedded ? source.name : source.path.string();
        source.texture_bytes = texture_bytes(read_image_header(bytes, name));
        if ((all_bytes += source.texture_bytes) > limit) return;
        source.is_png = recognise_image(bytes) == ImageFormat::Png;
        source.color_matrix = color_matrix_of(bytes, name, source.messages);
        source.image = decode_image(bytes, name, source.messages);
        if (longest_ == 0) return;
        // HDR and EXR hold linear colours.
        const bool is_srgb = source.is_encoded && (source.is_png || std::holds_alternative<Rgba8Image>(*source.image));
        std::visit([&](auto& image) { image = shrink_image(image, longest_, is_srgb); }, *source.image);
    } catch (const Error& error) {
        const std::string_view extension = extension_of(is_embedded ? source.bytes : file);
        source.fault = error.remark();
        if (advice_ && !extension.empty()) source.fault = source.fault->and_then(advice_(extension));
    }
}

void TextureLoader::decode() {
    if (longest_ == 0) decode_within(budget(0)); // otherwise the means depend on how materials use the pictures
}

void TextureLoader::decode_within(uint64_t limit) {
    const auto is_done = [](const Source& source) { return source.image || source.fault; };
    std::atomic<uint64_t> all_bytes = 0;
    for (const Source& source : sources_) {
        if (is_done(source)) all_bytes += source.texture_bytes;
    }
    parallel_for(sources_.size(), 1, [&](uint64_t i) {
        sink_->check();
        if (!is_done(sources_[i])) read(sources_[i], limit, all_bytes);
    });
}

bool TextureLoader::is_png16(const Source& source) {
    return source.image && source.is_png && std::holds_alternative<Image>(*source.image);
}

void TextureLoader::load_into(Scene& scene, uint64_t scene_bytes) {
    if (missing_ > kMissingNamed) {
        sink_->leave_out(fmt::format("missing: {}", counted(missing_ - kMissingNamed, "further texture")));
    }
    const std::vector<Uses> uses = uses_of(scene, sources_.size());
    for (std::size_t i = 0; i < sources_.size(); ++i) sources_[i].is_encoded = uses[i].as_srgb && !uses[i].as_data;
    const uint64_t limit = budget(scene_bytes);
    decode_within(limit);
    // Floats are linear, so a PNG of 16 bits that is used both as stored and as colours needs an image for each.
    const auto needs_two = [&](std::size_t i) { return is_png16(sources_[i]) && uses[i].as_srgb && uses[i].as_data; };
    for (std::size_t i = 0; i < sources_.size(); ++i) {
        if (needs_two(i)) sources_[i].texture_bytes *= 2;
    }
    check_budget(limit);

    std::vector<TextureImage> textures(sources_.size()), decoded(sources_.size());
    parallel_for(sources_.size(), 1, [&](uint64_t i) {
        Source& source = sources_[i];
        if (!source.image) return;
        const bool has_two = needs_two(i), is_encoded = is_png16(source) && uses[i].as_srgb;
        if (has_two) decoded[i] = texture_of(*source.image, true, source.name);
        textures[i] = texture_of(*std::move(source.image), is_encoded && !has_two, source.name);
        if (source.color_matrix && uses[i].as_color) convert_colors(*source.color_matrix, textures[i].rgba_float);
    });
    struct Numbers {
        int32_t as_srgb = kNoImage, as_data = kNoImage;
    };
    std::vector<Numbers> renumbered(sources_.size());
    for (std::size_t i = 0; i < sources_.size(); ++i) {
        sink_->add_all(sources_[i].messages);
        if (sources_[i].fault) {
            sink_->leave_out(sources_[i].fault->and_then("; only its factor is used"));
            continue;
        }
        PERTEV_CHECK(sources_[i].image);
        const auto add = [&](TextureImage& texture) {
            scene.images.push_back(std::move(texture));
            return static_cast<int32_t>(scene.images.size() - 1);
        };
        renumbered[i].as_data = renumbered[i].as_srgb = add(textures[i]);
        if (needs_two(i)) renumbered[i].as_srgb = add(decoded[i]);
    }
    for (Material& material : scene.materials) {
        visit_textures(material, [&](TextureRef& ref, const char*) {
            if (!ref.has_image()) return;
            const Numbers& numbers = renumbered.at(static_cast<std::size_t>(ref.image));
            ref.image = ref.is_srgb ? numbers.as_srgb : numbers.as_data;
        });
    }
}

} // namespace pertev
