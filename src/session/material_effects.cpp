#include "session/material_effects.h"

#include <algorithm>
#include <iterator>
#include <vector>

namespace pertev {
namespace {

constexpr std::string_view kOfReflection[] = {
    "metallic", "roughness", "ior", "specular_weight", "specular_color", "transmission_weight", "metal_fresnel"};
/// Parameters that ask for nothing with their defaults.
constexpr std::string_view kOfReflectionUnlessDefault[] = {
    "microfacet_distribution",    "energy",           "specular_roughness_anisotropy",
    "specular_retroreflectivity", "thin_film_weight", "diffuse_transmission_weight"};

constexpr unsigned bit(MaterialKind kind) { return 1u << static_cast<unsigned>(kind); }
constexpr unsigned kUnlit = bit(MaterialKind::Unlit), kDiffuse = bit(MaterialKind::Diffuse),
                   kConductor = bit(MaterialKind::Conductor), kDielectric = bit(MaterialKind::Dielectric),
                   kMixed = bit(MaterialKind::MetallicRoughness);
constexpr unsigned kLit = kDiffuse | kConductor | kDielectric | kMixed,
                   kMicrofacets = kConductor | kDielectric | kMixed, kClear = kDielectric | kMixed;

struct Effect {
    std::string_view key;
    unsigned kinds; // that use it
};
constexpr Effect kEffects[] = {{"metal", kConductor},
                               {"eta", kConductor},
                               {"k", kConductor},
                               {"base_color", kDiffuse | kDielectric | kMixed | kUnlit},
                               {"base_diffuse_roughness", kDiffuse | kMixed},
                               {"emission", kLit},
                               {"two_sided_emission", kLit},
                               {"normal_scale", kLit},
                               {"metallic", kMixed},
                               {"metal_fresnel", kMixed},
                               {"roughness", kMicrofacets},
                               {"microfacet_distribution", kMicrofacets},
                               {"energy", kMicrofacets},
                               {"specular_roughness_anisotropy", kMicrofacets},
                               {"anisotropy_rotation", kMicrofacets},
                               {"specular_weight", kConductor | kMixed},
                               {"specular_color", kMixed},
                               {"specular_retroreflectivity", kMixed},
                               {"ior", kClear},
                               {"has_relative_ior", kClear},
                               {"priority", kClear},
                               {"thin_film_weight", kClear},
                               {"thin_film_ior", kClear},
                               {"thin_film_thickness_nm", kClear},
                               {"thin_film_least_nm", kClear},
                               {"thin_walled", kMixed},
                               {"transmission_weight", kMixed},
                               {"transmission_color", kClear},
                               {"transmission_depth", kClear},
                               {"transmission_dispersion_scale", kClear},
                               {"transmission_dispersion_abbe_number", kClear},
                               {"diffuse_transmission_weight", kMixed},
                               {"diffuse_transmission_color", kMixed},
                               {"coat_weight", kLit},
                               {"coat_roughness", kLit},
                               {"coat_ior", kLit},
                               {"coat_color", kLit},
                               {"coat_normal_scale", kLit},
                               {"coat_roughness_anisotropy", kLit},
                               {"coat_anisotropy_rotation", kLit},
                               {"fuzz_weight", kLit},
                               {"fuzz_roughness", kLit},
                               {"fuzz_color", kLit},
                               {"fuzz_model", kLit}};

template <std::size_t kCount>
bool is_one_of(const std::string_view (&names)[kCount], std::string_view name) {
    return std::ranges::find(names, name) != std::end(names);
}

/// Returns the values of a parameter as numbers; none for a texture.
std::vector<float> values_of(const MaterialParameters& material, std::string_view key) {
    std::vector<float> values;
    const auto add = [&](auto value, std::string_view name) {
        if (name == key) values.push_back(static_cast<float>(value));
    };
    visit_choices(material, [&](auto choice, const char* name, auto&&) { add(choice, name); });
    visit_flags(material, add);
    visit_parameters(
        material, [&](float value, const char* name, float, float) { add(value, name); }, [](auto&&...) {});
    return values;
}

/// Returns a material whose parameters say what materials of this kind always are, as far as they do not use them.
MaterialParameters always(MaterialKind kind) {
    MaterialParameters material;
    material.metallic = kind == MaterialKind::Conductor ? 1.0f : 0.0f;
    material.transmission_weight = kind == MaterialKind::Dielectric ? 1.0f : 0.0f;
    material.thin_walled = kind != MaterialKind::Dielectric;
    return material;
}

} // namespace

bool makes_reflective(std::string_view key, bool has_default) {
    return is_one_of(kOfReflection, key) || (!has_default && is_one_of(kOfReflectionUnlessDefault, key));
}

bool has_default(const MaterialParameters& material, std::string_view key) {
    return values_of(material, key) == values_of({}, key);
}

bool is_judged(std::string_view key) { return std::ranges::find(kEffects, key, &Effect::key) != std::end(kEffects); }

bool is_heeded(const MaterialParameters& material, std::string_view key) {
    const auto* const effect = std::ranges::find(kEffects, key, &Effect::key);
    if (effect == std::end(kEffects) || material.is_clear_boundary) return true;
    // Only metals whose BSDF is made from layers have a weight (device_scene/make_bsdf.h).
    const bool lacks_weight =
        key == "specular_weight" && material.kind == MaterialKind::Conductor && !material.is_stacked();
    if ((effect->kinds & bit(material.kind)) != 0 && !lacks_weight) return true;
    const std::vector<float> values = values_of(material, key);
    return !values.empty() && values == values_of(always(material.kind), key);
}

} // namespace pertev
