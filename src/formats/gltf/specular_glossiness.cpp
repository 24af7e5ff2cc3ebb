#include "formats/gltf/specular_glossiness.h"

#include <algorithm>
#include <map>
#include <utility>

#include "image/srgb.h"

namespace pertev::gltf {
namespace {

constexpr float kMaxIndexed = 0.16f; // reflectance of an index of refraction of 2.33
constexpr float kGrey = 0.02f;       // channels that differ by no more count as equal

Rgb within_0_and_1(Rgb c) { return {clamp(c.r, 0.0f, 1.0f), clamp(c.g, 0.0f, 1.0f), clamp(c.b, 0.0f, 1.0f)}; }

/// Returns a picture of the roughness 1 - glossiness alpha in all channels.
TextureImage roughness_of(const TextureImage& image, float glossiness) {
    TextureImage to;
    to.name = image.name + " (roughness)";
    const std::vector<uint8_t>& bytes = image.rgba8.pixels;
    const std::vector<float>& floats = image.rgba_float.pixels;
    if (!bytes.empty()) {
        to.rgba8 = {image.rgba8.width, image.rgba8.height, std::vector<uint8_t>(bytes.size())};
        for (std::size_t i = 0; i < bytes.size(); ++i) {
            to.rgba8.pixels[i] = to_byte(1 - glossiness * static_cast<float>(bytes[i | 3]) / 255);
        }
    } else {
        to.rgba_float = {image.rgba_float.width, image.rgba_float.height, 4, std::vector<float>(floats.size())};
        for (std::size_t i = 0; i < floats.size(); ++i) {
            to.rgba_float.pixels[i] = 1 - glossiness * clamp(floats[i | 3], 0.0f, 1.0f);
        }
    }
    return to;
}

} // namespace

void set_specular_glossiness(const SpecularGlossiness& from, bool has_texture, Material& material) {
    const Rgb specular = within_0_and_1(from.specular);
    const float most = max_component(specular), least = min(specular.r, min(specular.g, specular.b));
    material.base_color = within_0_and_1(from.diffuse);
    material.metallic = 0;
    material.roughness = 1 - clamp(from.glossiness, 0.0f, 1.0f);
    material.kind = MaterialKind::MetallicRoughness;
    material.ior = 1.5f;
    material.specular_weight = 1;
    material.specular_color = {1, 1, 1};
    if (most == 0) { // without any reflection at the surface it is Lambert's law
        material.kind = MaterialKind::Diffuse;
    } else if (!has_texture && most <= kMaxIndexed && most - least <= kGrey) {
        material.ior = (1 + sqrt(most)) / (1 - sqrt(most));
    } else {
        constexpr float of_index = 0.2f * 0.2f; // reflectance of 1.5
        material.specular_color = (1 / of_index) * specular;
    }
}

void convert_gloss(const std::vector<PendingGloss>& pending, uint64_t limit, Scene& scene, Sink& sink) {
    std::map<std::pair<int32_t, float>, int32_t> known;
    uint64_t bytes = 0;
    for (const auto& [index, glossiness, location] : pending) {
        Material& material = scene.materials[index];
        TextureRef& texture = material.roughness_texture;
        if (!texture.has_image()) continue; // the loader has reported why
        const auto [entry, is_new] = known.try_emplace({texture.image, glossiness}, kNoImage);
        if (is_new) {
            const TextureImage& image = scene.images[static_cast<std::size_t>(texture.image)];
            bytes += image.rgba8.pixels.size() + sizeof(float) * image.rgba_float.pixels.size();
            if (bytes <= limit) {
                entry->second = static_cast<int32_t>(scene.images.size());
                scene.images.push_back(roughness_of(image, glossiness));
            }
        }
        if (entry->second == kNoImage) {
            sink.leave_out({location, "the texture of glossiness would take too much memory and is left out"});
            texture = {};
            continue;
        }
        texture.image = entry->second;
        texture.is_srgb = false;
        texture.channel = 0;
        material.roughness = 1;
    }
}

} // namespace pertev::gltf
