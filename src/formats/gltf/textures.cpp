#include "formats/gltf/textures.h"

#include <fmt/format.h>

#include "base/message_text.h"
#include "formats/gltf/extensions.h"
#include "formats/gltf/leave_out.h"
#include "formats/gltf/texture_sets.h"
#include "formats/gltf/uri.h"
#include "math/portable_math.h"

namespace pertev::gltf {
namespace {

// OpenGL's constants, which glTF uses for samplers.
constexpr uint64_t kNearest = 9728, kLinear = 9729, kNearestMipmapNearest = 9984, kLinearMipmapLinear = 9987;
constexpr uint64_t kClampToEdge = 33071, kMirroredRepeat = 33648, kRepeat = 10497;

Wrap read_wrap(const JsonValue& sampler, std::string_view key) {
    const uint64_t wrap = sampler.unsigned_or(key, kRepeat);
    switch (wrap) {
    case kRepeat:
        return Wrap::Repeat;
    case kMirroredRepeat:
        return Wrap::MirroredRepeat;
    case kClampToEdge:
        return Wrap::ClampToEdge;
    default:
        throw sampler.at(key).error(fmt::format("{}; expected 10497, 33071 or 33648", wrap));
    }
}

// Pictures of a kind that this reader does not decode.
constexpr std::string_view kOtherImages[] = {"KHR_texture_basisu", "EXT_texture_avif", "MSFT_texture_dds"};

constexpr float kMaxTransform = 0x1p39f;

} // namespace

TextureTransform read_texture_transform(const JsonValue& transform) {
    const std::array<float, 2> offset = transform.floats_or<2>("offset", {0, 0});
    const std::array<float, 2> scale = transform.floats_or<2>("scale", {1, 1});
    for (const float number : {offset[0], offset[1], scale[0], scale[1]}) {
        if (abs(number) > kMaxTransform) throw transform.error(fmt::format("{}; expected at most 2^39", number));
    }
    return {{offset[0], offset[1]}, {scale[0], scale[1]}, transform.float_or("rotation", 0)};
}

Textures::Textures(const Document& document, Buffers& buffers, TextureLoader& loader, Sink& sink)
    : document_(document), buffers_(buffers), loader_(loader), sink_(sink), images_(document.table("images").size()) {
    loader.advise_by(
        [path = document.path()](std::string_view extension) { return conversion_advice(extension, path); });
}

TextureRef Textures::read(const JsonValue& info) {
    const JsonValue& source = document_.item("textures", info.at("index"));
    TextureRef texture;
    uint64_t uv_set = info.unsigned_or("texCoord", 0);
    if (const std::optional<JsonValue> transform = info.extension("KHR_texture_transform")) {
        read_or_leave_out(*transform, sink_, [&] {
            uv_set = transform->unsigned_or("texCoord", uv_set);
            set_transform(texture, read_texture_transform(*transform));
        });
    }
    read_member(source, "sampler", sink_,
                [&](const JsonValue& sampler) { read_sampler(document_.item("samplers", sampler), texture); });
    if (uv_set > kMaxTextureSet) {
        sink_.leave_out({info.location(), fmt::format("set {} of texture coordinates; at most {} is supported; the "
                                                      "texture is left out",
                                                      uv_set, kMaxTextureSet)});
        return {};
    }
    texture.uv_set = static_cast<uint8_t>(uv_set);
    std::optional<JsonValue> reference = source.find("source");
    if (const auto webp = source.extension("EXT_texture_webp"); !reference && webp) reference = webp->find("source");
    if (!reference) {
        leave_out_without_image(source);
        return {};
    }
    texture.image = image(*reference);
    return texture;
}

void Textures::leave_out_without_image(const JsonValue& texture) {
    for (const std::string_view extension : kOtherImages) {
        if (!texture.extension(extension)) continue;
        sink_.leave_out(
            {texture.location(),
             fmt::format("the texture's image is given only by {}, which is not supported; it is left out{}", extension,
                         conversion_advice(extension, document_.path()))});
        return;
    }
    sink_.leave_out({texture.location(), "the texture has no supported image and is left out"});
}

void Textures::read_sampler(const JsonValue& sampler, TextureRef& texture) const {
    texture.wrap_s = read_wrap(sampler, "wrapS");
    texture.wrap_t = read_wrap(sampler, "wrapT");
    const uint64_t minify = sampler.unsigned_or("minFilter", kLinear);
    if (minify != kNearest && minify != kLinear && (minify < kNearestMipmapNearest || minify > kLinearMipmapLinear)) {
        throw sampler.at("minFilter").error(fmt::format("{}; expected 9728, 9729 or 9984 to 9987", minify));
    }
    // A path tracer averages many samples where a texture is minified; only magnification is left to choose.
    const uint64_t magnify = sampler.unsigned_or("magFilter", minify == kNearest ? kNearest : kLinear);
    if (magnify != kNearest && magnify != kLinear) {
        throw sampler.at("magFilter").error(fmt::format("{}; expected 9728 or 9729", magnify));
    }
    texture.filter = magnify == kNearest ? TextureFilter::Nearest : TextureFilter::Linear;
}

int32_t Textures::image(const JsonValue& reference) {
    const uint32_t index = document_.index_into("images", reference);
    if (!images_[index]) images_[index] = add_image(document_.table("images")[index]);
    return *images_[index];
}

int32_t Textures::add_image(const JsonValue& image) {
    const std::string name =
        fmt::format("{}{}{}", text_of(image.location()), image.find("name") ? " " : "", image.string_or("name", ""));
    if (const std::optional<JsonValue> view = image.find("bufferView")) {
        const std::span<const std::byte> bytes = buffers_.view(*view).bytes;
        const auto [entry, is_new] = by_bytes_.try_emplace({bytes.data(), bytes.size()}, kNoImage);
        if (is_new) entry->second = loader_.add_bytes(name, bytes);
        return entry->second;
    }
    const std::optional<JsonValue> uri = image.find("uri");
    if (!uri) throw image.error("an image without data; expected \"uri\" or \"bufferView\"");
    const std::string_view text = uri->to_string();
    if (!is_data_uri(text)) {
        const std::optional<std::string> path = file_name_of_uri(text, document_.path());
        if (!path) throw uri->error(fmt::format("\"{}\"; expected a relative path or a data URI", shortened(text)));
        return loader_.add_file(uri->location(), *path);
    }
    std::optional<std::vector<std::byte>> bytes = decode_data_uri(text);
    if (!bytes) {
        sink_.leave_out({uri->location(), "the data URI cannot be decoded; the texture is left out"});
        return kNoImage;
    }
    return loader_.add_bytes(name, embedded_.emplace_back(*std::move(bytes)));
}

} // namespace pertev::gltf
