// Extensions of glTF materials that add layers to metallic-roughness or change its reflection, as parameters of OpenPBR
// (scene/material.h), and the material that a variant gives to a primitive.
//
// Source: KHR_materials_clearcoat, _sheen, _specular, _transmission, _volume, _dispersion, _anisotropy, _iridescence,
// _diffuse_transmission, _retroreflection (draft), _volume_scatter (draft) and _variants.

#include <algorithm>

#include <fmt/format.h>

#include "formats/gltf/material_pointers.h"
#include "formats/gltf/materials.h"
#include "math/portable_math.h"
#include "scene/scatter_albedo.h"

namespace pertev::gltf {
namespace {

constexpr float kLeastTransmitted = 0x1p-20f; // replaces a colour of 0, whose extinction would be infinite
constexpr std::string_view kAttenuationColor = "KHR_materials_volume/attenuationColor",
                           kAttenuationDistance = "KHR_materials_volume/attenuationDistance",
                           kDiffuseTransmission = "KHR_materials_diffuse_transmission/diffuseTransmissionFactor";

} // namespace

bool Materials::is_animated(const JsonValue& source, std::string_view factor) const {
    return animated_.contains(fmt::format("{}/extensions/{}", source.pointer(), factor));
}

bool Materials::changes_metal(const JsonValue& source) const {
    return animated_.contains(source.pointer() + "/pbrMetallicRoughness/metallicFactor");
}

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
    if (material.coat_weight == 0 && !is_animated(source, "KHR_materials_clearcoat/clearcoatFactor")) return;
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
    const bool changes = is_animated(source, "KHR_materials_sheen/sheenColorFactor");
    if (changes) { // the sheen may come later
        material.fuzz_weight = 1;
        material.fuzz_roughness = 0;
        material.fuzz_color = {0, 0, 0};
    }
    if (!extension) return;
    std::array<float, 3> color = {0, 0, 0};
    attempt_at(*extension, [&] { color = extension->floats_or<3>("sheenColorFactor", color); });
    material.fuzz_roughness = 0;
    attempt_at(*extension, [&] { material.fuzz_roughness = extension->float_or("sheenRoughnessFactor", 0); });
    material.fuzz_color = {color[0], color[1], color[2]};
    if (is_black(material.fuzz_color) && !changes) return;
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
    constexpr std::string_view kReflecting[] = {"KHR_materials_specular/specularFactor",
                                                "KHR_materials_transmission/transmissionFactor",
                                                "KHR_materials_iridescence/iridescenceFactor", kDiffuseTransmission};
    const bool has_more =
        material.transmits() || material.has_thin_film() || material.has_diffuse_transmission() ||
        changes_metal(source) ||
        std::ranges::any_of(kReflecting, [&](std::string_view factor) { return is_animated(source, factor); });
    if (material.specular_weight == 0 && material.metallic == 0 && !has_more) {
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
    const bool changes = is_animated(source, "KHR_materials_transmission/transmissionFactor");
    if (factor == 0 && !changes) return;
    TextureRef texture;
    if (transmission) texture = read_channel(*transmission, "transmissionTexture", 0);
    const std::optional<JsonValue> volume = source.extension("KHR_materials_volume");
    const bool is_solid = volume && volume->float_or("thicknessFactor", 0) > 0;
    if (is_solid) {
        const bool attenuation_changes =
            is_animated(source, kAttenuationColor) || is_animated(source, kAttenuationDistance);
        attempt_at(*volume, [&] { read_attenuation(*volume, attenuation_changes, material); });
    }
    const bool is_glass = factor == 1 && !texture.has_image() && material.metallic == 0;
    if (is_solid && is_glass && !changes && !changes_metal(source)) {
        material.kind = MaterialKind::Dielectric;
        return;
    }
    material.transmission_weight = factor;
    material.transmission_texture = texture;
    material.thin_walled = !is_solid;
}

void Materials::read_dispersion(const JsonValue& source, Material& material) {
    const std::optional<JsonValue> extension = source.extension("KHR_materials_dispersion");
    const bool changes = is_animated(source, "KHR_materials_dispersion/dispersion");
    if (changes) material.transmission_dispersion_abbe_number = 1; // the scale alone reaches all values
    if (!extension) return;
    const float dispersion = extension->float_or("dispersion", 0);
    if (!(dispersion >= 0)) throw extension->at("dispersion").error("expected a number of at least 0");
    constexpr float usual = kAbbeNumberOfDispersion;
    if (changes) {
        material.transmission_dispersion_scale = min(dispersion / usual, 1.0f);
        return;
    }
    material.transmission_dispersion_scale = min(dispersion, 1.0f);
    material.transmission_dispersion_abbe_number = max(usual / max(dispersion, 1.0f), 1.0f);
}

void Materials::read_attenuation(const JsonValue& volume, bool changes, Material& material) {
    const bool is_finite = volume.find("attenuationDistance").has_value();
    if (!is_finite && !changes) return;
    const float distance = volume.float_or("attenuationDistance", 0);
    if (is_finite && !(distance > 0)) throw volume.at("attenuationDistance").error("expected a number above 0");
    const std::array<float, 3> color = volume.floats_or<3>("attenuationColor", {1, 1, 1});
    if (color == std::array<float, 3>{1, 1, 1} && !changes) return;
    material.transmission_color = {color[0], color[1], color[2]};
    material.transmission_depth = distance;
}

void Materials::read_anisotropy(const JsonValue& source, Material& material) {
    const std::optional<JsonValue> extension = source.extension("KHR_materials_anisotropy");
    if (!extension) return;
    float& strength = material.specular_roughness_anisotropy;
    attempt_at(*extension, [&] { strength = extension->float_or("anisotropyStrength", 0); });
    if (strength == 0 && !is_animated(source, "KHR_materials_anisotropy/anisotropyStrength")) return;
    attempt_at(*extension, [&] { material.anisotropy_rotation = extension->float_or("anisotropyRotation", 0); });
    material.anisotropy_texture = read_texture(*extension, "anisotropyTexture", false);
}

void Materials::read_retroreflection(const JsonValue& source, Material& material) {
    const std::optional<JsonValue> extension = source.extension("KHR_materials_retroreflection");
    if (!extension) return;
    if (material.kind == MaterialKind::Dielectric) {
        sink_.leave_out({extension->location(), "KHR_materials_retroreflection is left out, because solid glass has no "
                                                "reflection but that of its index"});
        return;
    }
    material.specular_retroreflectivity = extension->float_or("retroreflectionFactor", 0);
    const bool changes = is_animated(source, "KHR_materials_retroreflection/retroreflectionFactor");
    if (material.specular_retroreflectivity == 0 && !changes) return;
    material.retroreflectivity_texture = read_channel(*extension, "retroreflectionTexture", 0);
}

void Materials::read_thin_film(const JsonValue& source, Material& material) {
    const std::optional<JsonValue> extension = source.extension("KHR_materials_iridescence");
    if (!extension) return;
    const auto read_number = [&](float& value, std::string_view key, float usual) {
        attempt_at(*extension, [&] { value = extension->float_or(key, usual); });
    };
    read_number(material.thin_film_weight, "iridescenceFactor", 0);
    const bool changes = is_animated(source, "KHR_materials_iridescence/iridescenceFactor");
    if (material.thin_film_weight == 0 && !changes) return;
    read_number(material.thin_film_ior, "iridescenceIor", 1.3f);
    read_number(material.thin_film_least_nm, "iridescenceThicknessMinimum", 100);
    read_number(material.thin_film_thickness_nm, "iridescenceThicknessMaximum", 400);
    material.thin_film_texture = read_channel(*extension, "iridescenceTexture", 0);
    material.thin_film_thickness_texture = read_channel(*extension, "iridescenceThicknessTexture", 1);
}

void Materials::read_diffuse_transmission(const JsonValue& source, Material& material) {
    const std::optional<JsonValue> extension = source.extension("KHR_materials_diffuse_transmission");
    if (!extension || material.kind != MaterialKind::MetallicRoughness) return;
    std::array<float, 3> color = {1, 1, 1};
    float& weight = material.diffuse_transmission_weight;
    attempt_at(*extension, [&] { weight = extension->float_or("diffuseTransmissionFactor", 0); });
    if (weight == 0 && !is_animated(source, kDiffuseTransmission)) return;
    attempt_at(*extension, [&] { color = extension->floats_or<3>("diffuseTransmissionColorFactor", color); });
    material.diffuse_transmission_color = {color[0], color[1], color[2]};
    material.diffuse_transmission_texture = read_channel(*extension, "diffuseTransmissionTexture", 3);
    material.diffuse_transmission_color_texture = read_texture(*extension, "diffuseTransmissionColorTexture", true);
}

void Materials::read_scatter(const JsonValue& source, Material& material) {
    const std::optional<JsonValue> extension = source.extension("KHR_materials_volume_scatter");
    if (!extension) return;
    const std::optional<JsonValue> volume = source.extension("KHR_materials_volume");
    const bool has_thickness =
        volume && (!volume->find("thicknessFactor") || volume->float_or("thicknessFactor", 0) > 0);
    const bool is_entered = material.encloses() || material.has_diffuse_transmission() ||
                            is_animated(source, "KHR_materials_transmission/transmissionFactor") ||
                            is_animated(source, kDiffuseTransmission);
    if (!has_thickness || !is_entered) {
        sink_.leave_out({extension->location(), "KHR_materials_volume_scatter is left out, because the material has no "
                                                "volume with a thickness that light enters"});
        return;
    }
    std::array<float, 3> color = {0, 0, 0};
    attempt_at(*extension, [&] { color = extension->floats_or<3>("multiscatterColor", color); });
    float g = 0;
    attempt_at(*extension, [&] { g = extension->float_or("scatterAnisotropy", 0); });
    Material attenuating;
    attempt_at(*volume, [&] { read_attenuation(*volume, false, attenuating); });
    if (color == std::array<float, 3>{0, 0, 0}) return;
    if (!(attenuating.transmission_depth > 0)) {
        if (!is_animated(source, kAttenuationColor) && !is_animated(source, kAttenuationDistance)) return;
        sink_.leave_out({extension->location(), "KHR_materials_volume_scatter is left out, because the volume "
                                                "attenuates only while it is animated, and its medium cannot change"});
        return;
    }
    const auto extinction = [&](float transmitted) {
        return -log(max(transmitted, kLeastTransmitted)) / attenuating.transmission_depth;
    };
    const Rgb passed = attenuating.transmission_color;
    const Rgb sigma_t = {extinction(passed.r), extinction(passed.g), extinction(passed.b)};
    material.medium.sigma_s = sigma_t * Rgb{single_scatter_albedo(color[0]), single_scatter_albedo(color[1]),
                                            single_scatter_albedo(color[2])};
    material.medium.sigma_a = sigma_t - material.medium.sigma_s;
    material.medium.g = clamp(g, -kMaxScatterAnisotropy, kMaxScatterAnisotropy);
    material.transmission_depth = 0; // the medium has the whole extinction
    material.transmission_color = {1, 1, 1};
}

} // namespace pertev::gltf
