// Extensions of glTF materials that add layers to metallic-roughness or change its reflection, as parameters of OpenPBR
// (scene/material.h), and the material that a variant gives to a primitive.
//
// Source: KHR_materials_clearcoat, _sheen, _specular, _transmission, _volume and _variants.

#include <algorithm>

#include "formats/gltf/materials.h"

namespace pertev::gltf {

std::optional<JsonValue> Materials::material_in_variant(const JsonValue& primitive) const {
    std::optional<JsonValue> reference = primitive.find("material");
    if (!scene_.variant) return reference;
    const std::optional<JsonValue> extension = primitive.extension("KHR_materials_variants");
    if (!extension) return reference;
    read_or_leave_out(*extension, sink_, [&] {
        for (const JsonValue& mapping : extension->elements_of("mappings")) {
            const std::vector<JsonValue> variants = mapping.elements_of("variants");
            const auto is_shown = [&](const JsonValue& variant) { return variant.to_unsigned() == *scene_.variant; };
            if (std::ranges::any_of(variants, is_shown)) reference = mapping.at("material");
        }
    });
    return reference;
}

TextureRef Materials::read_channel(const JsonValue& parent, std::string_view key, uint8_t channel) {
    TextureRef texture = read_texture(parent, key, false);
    texture.channel = channel;
    return texture;
}

void Materials::read_coat(const JsonValue& source, Material& material) {
    const std::optional<JsonValue> extension = source.extension("KHR_materials_clearcoat");
    if (!extension) return;
    attempt_at(*extension, [&] { material.coat_weight = extension->float_or("clearcoatFactor", 0); });
    attempt_at(*extension, [&] { material.coat_roughness = extension->float_or("clearcoatRoughnessFactor", 0); });
    if (material.coat_weight == 0) return;
    material.coat_texture = read_channel(*extension, "clearcoatTexture", 0);
    material.coat_roughness_texture = read_channel(*extension, "clearcoatRoughnessTexture", 1);
    material.coat_normal_texture = read_texture(*extension, "clearcoatNormalTexture", false);
    attempt_at(*extension, [&] {
        if (const std::optional<JsonValue> normal = extension->find("clearcoatNormalTexture")) {
            material.coat_normal_scale = normal->float_or("scale", 1);
        }
    });
}

void Materials::read_fuzz(const JsonValue& source, Material& material) {
    const std::optional<JsonValue> extension = source.extension("KHR_materials_sheen");
    if (!extension) return;
    std::array<float, 3> color = {0, 0, 0};
    attempt_at(*extension, [&] { color = extension->floats_or<3>("sheenColorFactor", color); });
    material.fuzz_roughness = 0;
    attempt_at(*extension, [&] { material.fuzz_roughness = extension->float_or("sheenRoughnessFactor", 0); });
    material.fuzz_color = {color[0], color[1], color[2]};
    if (is_black(material.fuzz_color)) return;
    material.fuzz_weight = 1;
    material.fuzz_color_texture = read_texture(*extension, "sheenColorTexture", true);
    material.fuzz_roughness_texture = read_channel(*extension, "sheenRoughnessTexture", 3);
}

void Materials::read_specular(const JsonValue& source, Material& material) {
    const std::optional<JsonValue> extension = source.extension("KHR_materials_specular");
    if (!extension) return;
    if (material.kind == MaterialKind::Dielectric) {
        sink_.leave_out({extension->location(), "KHR_materials_specular is left out, because solid glass reflects by "
                                                "its index"});
        return;
    }
    std::array<float, 3> color = {1, 1, 1};
    attempt_at(*extension, [&] { material.specular_weight = extension->float_or("specularFactor", 1); });
    attempt_at(*extension, [&] { color = extension->floats_or<3>("specularColorFactor", color); });
    if (material.specular_weight == 0 && material.metallic == 0 && !material.transmits()) {
        material.specular_weight = 1;
        material.kind = MaterialKind::Diffuse; // without any reflection at the surface it is Lambert's law
        return;
    }
    material.specular_color = {color[0], color[1], color[2]};
    material.specular_texture = read_channel(*extension, "specularTexture", 3);
    material.specular_color_texture = read_texture(*extension, "specularColorTexture", true);
}

void Materials::read_transmission(const JsonValue& source, Material& material) {
    const std::optional<JsonValue> transmission = source.extension("KHR_materials_transmission");
    const float factor = transmission ? transmission->float_or("transmissionFactor", 0) : 0;
    if (factor == 0) return;
    const TextureRef texture = read_channel(*transmission, "transmissionTexture", 0);
    const std::optional<JsonValue> volume = source.extension("KHR_materials_volume");
    const bool is_solid = volume && volume->float_or("thicknessFactor", 0) > 0;
    if (is_solid && volume->find("attenuationDistance")) {
        sink_.leave_out({volume->location(), "the attenuation of KHR_materials_volume is not supported and left out"});
    }
    if (is_solid && factor == 1 && !texture.has_image() && material.metallic == 0) {
        material.kind = MaterialKind::Dielectric;
        return;
    }
    material.transmission_weight = factor;
    material.transmission_texture = texture;
    material.thin_walled = !is_solid;
    if (is_solid && (factor != 1 || texture.has_image())) {
        sink_.leave_out({transmission->location(),
                         "partial transmission of a solid is left out: it is glass where at least half of its light is "
                         "transmitted, and else opaque"});
    }
}

} // namespace pertev::gltf
