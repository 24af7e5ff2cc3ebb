#include "formats/gltf_writer/texture_writer.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "image/srgb.h"
#include "image/write_png.h"
#include "math/portable_math.h"

namespace pertev::glb {
namespace {

constexpr uint32_t kNearest = 9728, kLinear = 9729;

uint32_t constant_of(Wrap wrap) {
    constexpr uint32_t kClampToEdge = 33071, kMirroredRepeat = 33648, kRepeat = 10497;
    switch (wrap) {
    case Wrap::ClampToEdge:
        return kClampToEdge;
    case Wrap::MirroredRepeat:
        return kMirroredRepeat;
    case Wrap::Repeat:
        break;
    }
    return kRepeat;
}

/// Returns whether both look up texels at the same points.
bool has_same_lookup(const TextureRef& a, const TextureRef& b) {
    return a.wrap_s == b.wrap_s && a.wrap_t == b.wrap_t && a.filter == b.filter && a.uv_set == b.uv_set &&
           a.m00 == b.m00 && a.m01 == b.m01 && a.m02 == b.m02 && a.m10 == b.m10 && a.m11 == b.m11 && a.m12 == b.m12;
}

std::pair<uint32_t, uint32_t> size_of(const TextureImage& image) {
    return image.rgba8.pixels.empty() ? std::pair(image.rgba_float.width, image.rgba_float.height)
                                      : std::pair(image.rgba8.width, image.rgba8.height);
}

/// Returns a channel of an image as a byte, of which the first three are encoded as `is_srgb` says.
uint8_t byte_at(const TextureImage& image, std::size_t pixel, uint8_t channel, bool from_srgb, bool is_srgb) {
    const std::size_t at = 4 * pixel + channel;
    const bool is_float = image.rgba8.pixels.empty();
    if (!is_float && from_srgb == is_srgb) return image.rgba8.pixels[at];
    float value = is_float ? image.rgba_float.pixels[at] : static_cast<float>(image.rgba8.pixels[at]) / 255.0f;
    if (!is_float && from_srgb) value = srgb_decode(value);
    return to_byte(is_srgb ? srgb_encode(value) : value);
}

} // namespace

std::string TextureWriter::info(const TextureRef& texture, bool is_srgb, const std::string& owner, JsonMembers more) {
    std::array<TextureChannel, 4> channels;
    for (uint8_t c = 0; c < 4; ++c) channels[c] = {&texture, c};
    return info(channels, is_srgb, owner, std::move(more));
}

std::string TextureWriter::channel(const TextureRef& texture, uint8_t to, const std::string& owner) {
    if (texture.has_image() && texture.channel == to) return info(texture, false, owner);
    std::array<TextureChannel, 4> channels;
    channels[to] = {&texture, texture.channel};
    return info(channels, false, owner);
}

std::string TextureWriter::info(const std::array<TextureChannel, 4>& channels, bool is_srgb, const std::string& owner,
                                JsonMembers more) {
    const TextureRef* first = nullptr;
    Recipe recipe = {{kNoImage, kNoImage, kNoImage, kNoImage}, {}, {}, is_srgb};
    auto& [images, source_channels, are_srgb, encoding] = recipe;
    for (std::size_t c = 0; c < 4; ++c) {
        const TextureRef* texture = channels[c].texture;
        if (texture == nullptr || !texture->has_image()) continue;
        const auto size = [&](const TextureRef& of) {
            return size_of(scene_.images[static_cast<std::size_t>(of.image)]);
        };
        if (first != nullptr && first != texture &&
            (!has_same_lookup(*first, *texture) || size(*first) != size(*texture))) {
            sink_.leave_out(fmt::format("{}: two of its textures would be one, and their sizes or coordinates differ; "
                                        "the second is lost",
                                        owner));
            continue;
        }
        first = first == nullptr ? texture : first;
        images[c] = texture->image, source_channels[c] = channels[c].channel;
        are_srgb[c] = texture->is_srgb && channels[c].channel < 3;
    }
    if (first == nullptr) return "";

    const uint32_t image = image_of(recipe, owner);
    JsonMembers texture, sampler;
    const uint32_t filter = first->filter == TextureFilter::Nearest ? kNearest : kLinear;
    sampler.add("magFilter", fmt::format("{}", filter)).add("minFilter", fmt::format("{}", filter));
    sampler.add("wrapS", fmt::format("{}", constant_of(first->wrap_s)));
    sampler.add("wrapT", fmt::format("{}", constant_of(first->wrap_t)));
    texture.add("sampler", fmt::format("{}", parts_.add_once("samplers", sampler.text())));
    texture.add("source", fmt::format("{}", image));
    JsonMembers info = std::move(more);
    info.add("index", fmt::format("{}", parts_.add_once("textures", texture.text())));
    info.add_number("texCoord", first->uv_set, 0);
    const std::string transform = transform_of(*first, owner);
    if (!transform.empty()) {
        parts_.use("KHR_texture_transform");
        info.add("extensions", fmt::format(R"({{"KHR_texture_transform":{}}})", transform));
    }
    return info.text();
}

uint32_t TextureWriter::image_of(const Recipe& recipe, const std::string& owner) {
    const auto [entry, is_new] = images_.try_emplace(recipe);
    if (!is_new) return entry->second;
    const Rgba8Image made = make_image(recipe, owner);
    bool is_opaque = true;
    for (std::size_t i = 3; i < made.pixels.size(); i += 4) is_opaque = is_opaque && made.pixels[i] == 255;
    const uint32_t view = parts_.add_view(encode_png(made, !is_opaque));
    JsonMembers image;
    image.add("bufferView", fmt::format("{}", view)).add("mimeType", R"("image/png")");
    return entry->second = parts_.add("images", image.text());
}

Rgba8Image TextureWriter::make_image(const Recipe& recipe, const std::string& owner) {
    const auto& [images, source_channels, are_srgb, is_srgb] = recipe;
    Rgba8Image made;
    bool is_rounded = false;
    for (std::size_t c = 0; c < 4; ++c) {
        if (images[c] == kNoImage) continue;
        const TextureImage& from = scene_.images[static_cast<std::size_t>(images[c])];
        std::tie(made.width, made.height) = size_of(from);
        const bool to_srgb = is_srgb && c < 3;
        is_rounded = is_rounded || from.rgba8.pixels.empty() || (are_srgb[c] != to_srgb && source_channels[c] != 3);
        made.pixels.resize(4 * std::size_t(made.width) * made.height, 255);
        for (std::size_t i = 0; i < made.pixels.size() / 4; ++i) {
            made.pixels[4 * i + c] = byte_at(from, i, source_channels[c], are_srgb[c], to_srgb);
        }
    }
    if (is_rounded) {
        sink_.leave_out(
            fmt::format("{}: a texture is rounded to the 8 bits, from 0 to 1, that its slot has in glTF", owner));
    }
    return made;
}

std::string TextureWriter::transform_of(const TextureRef& texture, const std::string& owner) {
    const bool is_turned = texture.m10 != 0 || texture.m01 != 0;
    const float angle = is_turned ? atan2(-texture.m10, texture.m00) : 0.0f;
    const float s = sin(angle), c = cos(angle);
    const float scale_x = is_turned ? sqrt(texture.m00 * texture.m00 + texture.m10 * texture.m10) : texture.m00;
    const float scale_y = is_turned ? texture.m01 * s + texture.m11 * c : texture.m11;
    const float size = abs(texture.m01) + abs(texture.m11) + abs(scale_x);
    if (abs(texture.m01 - s * scale_y) + abs(texture.m11 - c * scale_y) > 1e-4f * size) {
        sink_.leave_out(fmt::format("{}: the shear of a texture's coordinates is lost", owner));
    }
    JsonMembers members;
    if (texture.m02 != 0 || texture.m12 != 0) members.add("offset", json_floats(std::array{texture.m02, texture.m12}));
    members.add_number("rotation", angle, 0);
    if (scale_x != 1 || scale_y != 1) members.add("scale", json_floats(std::array{scale_x, scale_y}));
    return members.is_empty() ? "" : members.text();
}

} // namespace pertev::glb
