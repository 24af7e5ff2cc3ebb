#pragma once

// Materials as plain numbers and references to textures; shading/ makes BSDFs from them.

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "base/host_device.h"
#include "base/limits.h"
#include "math/rgb.h"
#include "scene/medium.h"
#include "scene/texture.h"

namespace pertev {

enum class MaterialKind : uint8_t {
    Diffuse,           // base_color is the albedo; rough by base_diffuse_roughness
    Conductor,         // metal with complex index of refraction eta + i k
    Dielectric,        // glass or water, reflection and refraction; base_color tints what is refracted
    MetallicRoughness, // glTF 2.0 appendix B: metal and (diffuse + dielectric coat) mixed by `metallic`
    Unlit,             // KHR_materials_unlit: base_color is emitted as it is, nothing is reflected
};

enum class AlphaMode : uint8_t { Opaque, Mask, Blend };
enum class MetalFresnel : uint8_t {
    Schlick, // glTF: base_color at normal incidence, 1 at grazing incidence
    F82,     // OpenPBR: the same, times specular_color at 82 degrees
};
enum class MicrofacetDistribution : uint8_t { Ggx, Beckmann };
enum class FuzzModel : uint8_t {
    Charlie, // glTF: KHR_materials_sheen
    Zeltner, // OpenPBR: fibres that scatter light many times
};
enum class MicrofacetEnergy : uint8_t {
    Compensated, // a second lobe returns what one bounce off rough microfacets loses
    Single,      // it stays lost, as in many other renderers
};

inline constexpr float kLeastIor = 0x1p-10f, kMostIor = 0x1p10f;

/// MaterialParameters is plain data that is copied to a device unchanged. A new parameter needs a member here, a row
/// in visit_parameters, its reading, and the code that uses it.
struct MaterialParameters {
    MaterialKind kind = MaterialKind::Diffuse;
    AlphaMode alpha_mode = AlphaMode::Opaque;
    MetalFresnel metal_fresnel = MetalFresnel::Schlick; // for MetallicRoughness
    MicrofacetDistribution microfacet_distribution = MicrofacetDistribution::Ggx;
    MicrofacetEnergy energy = MicrofacetEnergy::Compensated; // this and the one above: not of coats
    FuzzModel fuzz_model = FuzzModel::Charlie;

    // The front of a triangle is the side from which its corners run counter-clockwise in the mesh's own space,
    // whatever its vertex normals are. Thus a node that mirrors a mesh keeps its front.
    bool two_sided_emission = false; // otherwise only the front emits; unlit materials show both faces
    bool double_sided = true;        // otherwise camera rays pass through the back; all other rays hit it
    bool is_clear_boundary = false;  // no ray meets it (its alpha is 0); it only ends the medium that it encloses
    bool has_relative_ior = false;   // ior is over that of what surrounds the solid, which may be another solid; else
                                     // over that of a vacuum

    float alpha = 1;           // [0, 1]; multiplied by the alpha of the base colour texture, the vertex colour and
                               // alpha_texture
    float alpha_cutoff = 0.5f; // Mask: a hit counts if alpha >= cutoff

    Rgb base_color = {0.5f, 0.5f, 0.5f}; // [0, 1], linear; multiplied by the texture (whose .w is alpha)
    Rgb emission = {0, 0, 0};            // W/(sr m2); multiplied by the texture
    Rgb eta = {0.2f, 0.92f, 1.1f}, k = {3.9f, 2.45f, 2.14f}; // for Conductor; the default is gold

    float metallic = 0;  // [0, 1]; multiplied by metallic_texture's channel
    float roughness = 1; // [0, 1], perceptual: alpha_ggx = roughness^2; multiplied by roughness_texture's channel
    float ior = 1.5f;    // for Dielectric and MetallicRoughness: inside over outside, > 0; below 1 in a bubble
    float normal_scale = 1;
    float priority = 0; // the solid of the greatest one fills what several enclose (device_scene/nest_solids.h)

    TextureRef base_color_texture;
    TextureRef alpha_texture; // one channel, for OBJ map_d; not used by glTF
    TextureRef metallic_texture, roughness_texture, emission_texture;
    TextureRef normal_texture; // tangent space, x right, y up in texture space (OpenGL convention), linear

    // Parameters of OpenPBR Surface 1.1.1, in its names; those of a metal or dielectric are above. Weights and
    // roughnesses are in [0, 1] and multiplied by their texture's channel.
    bool thin_walled = true;       // for transmission_weight: otherwise the object is solid
    float transmission_weight = 0; // for MetallicRoughness: of what is not metal, goes through instead of into Lambert
    float base_diffuse_roughness = 0; // above 0 diffuse light is that of EON
    float specular_weight = 1;        // for MetallicRoughness, of the dielectric's reflection
    Rgb specular_color = {1, 1, 1};   // factor on that at normal incidence, >= 0; multiplied by the texture; with F82
                                      // also the metal's tint, at most 1
    float coat_weight = 0, coat_roughness = 0, coat_ior = 1.5f, coat_normal_scale = 1;
    Rgb coat_color = {1, 1, 1}; // [0, 1], what both ways through the coat leave at normal incidence; multiplied by the
                                // texture
    // In the same units as those of the reflection:
    float coat_roughness_anisotropy = 0, coat_anisotropy_rotation = 0;
    float fuzz_weight = 0, fuzz_roughness = 0.5f;
    Rgb fuzz_color = {1, 1, 1};         // [0, 1], multiplied by the texture
    Rgb transmission_color = {1, 1, 1}; // [0, 1], what a solid transmits over transmission_depth
    float transmission_depth = 0;       // metres; 0: a solid absorbs nothing
    // The indices of red and blue differ by (ior - 1) scale / number (KHR_materials_dispersion: 20 / its dispersion).
    float transmission_dispersion_scale = 0, transmission_dispersion_abbe_number = 20;
    float specular_roughness_anisotropy = 0; // [0, 1], multiplied by the third channel of anisotropy_texture
    float specular_retroreflectivity = 0;    // [0, 1], of the reflection, goes back where it came from
    float anisotropy_rotation = 0;           // radians, from the tangent towards the bitangent; the texture's first two
                                             // channels turn it further (KHR_materials_anisotropy)
    float thin_film_weight = 0, thin_film_ior = 1.3f;
    float thin_film_thickness_nm = 400, thin_film_least_nm = 100; // where the texture of the thickness is 1 and 0
    float diffuse_transmission_weight = 0;      // [0, 1], of the diffuse light, which leaves on the other side
    Rgb diffuse_transmission_color = {1, 1, 1}; // [0, 1], multiplied by the texture
    TextureRef transmission_texture, specular_texture, specular_color_texture;
    TextureRef coat_texture, coat_roughness_texture, coat_color_texture, coat_anisotropy_texture;
    TextureRef coat_normal_texture; // without it the coat is not bent
    TextureRef fuzz_color_texture, fuzz_roughness_texture;
    TextureRef anisotropy_texture, thin_film_texture, thin_film_thickness_texture;
    TextureRef diffuse_transmission_texture, diffuse_transmission_color_texture, retroreflectivity_texture;

    MediumParameters medium; // fills the object besides the absorption of transmission_depth, if light enters it

    HD bool has_coat() const { return coat_weight > 0; }
    HD bool has_fuzz() const { return fuzz_weight > 0 && max_component(fuzz_color) > 0; }
    HD bool transmits() const { return kind == MaterialKind::MetallicRoughness && transmission_weight > 0; }
    /// Returns whether the material is clear and the surface of a solid, which refracts light, not of a thin wall.
    HD bool is_solid() const { return kind == MaterialKind::Dielectric || (transmits() && !thin_walled); }
    HD bool is_unlit() const { return kind == MaterialKind::Unlit; }
    /// Returns whether the dielectric reflects otherwise than by its index.
    HD bool has_own_reflection() const {
        return kind == MaterialKind::MetallicRoughness &&
               (specular_weight != 1 || !(specular_color == Rgb{1, 1, 1}) || specular_texture.has_image() ||
                specular_color_texture.has_image());
    }
    /// Returns whether the material is that of a solid, which light enters, that absorbs by distance.
    HD bool absorbs() const { return transmission_depth > 0 && is_solid(); }
    /// Returns whether the material is the surface of a body that light enters and that a medium may fill.
    HD bool encloses() const {
        return is_solid() || is_clear_boundary || (medium.is_there() && has_diffuse_transmission());
    }
    HD bool has_microfacets() const { return kind != MaterialKind::Diffuse && !is_unlit(); }
    HD bool has_anisotropy() const { return has_microfacets() && specular_roughness_anisotropy > 0; }
    HD bool has_coat_anisotropy() const { return has_coat() && coat_roughness_anisotropy > 0; }
    /// Returns whether the material has other microfacets than most materials, for which there is faster code.
    HD bool has_other_microfacets() const {
        return has_microfacets() &&
               (microfacet_distribution != MicrofacetDistribution::Ggx || energy != MicrofacetEnergy::Compensated);
    }
    HD bool has_rough_diffuse() const {
        return (kind == MaterialKind::Diffuse || kind == MaterialKind::MetallicRoughness) && base_diffuse_roughness > 0;
    }
    /// Returns the reciprocal of Abbe's number of a solid.
    HD float dispersion() const {
        return is_solid() ? transmission_dispersion_scale / transmission_dispersion_abbe_number : 0.0f;
    }
    HD bool has_thin_film() const {
        return (kind == MaterialKind::MetallicRoughness || kind == MaterialKind::Dielectric) && thin_film_weight > 0;
    }
    HD bool has_diffuse_transmission() const {
        return kind == MaterialKind::MetallicRoughness && diffuse_transmission_weight > 0;
    }
    HD bool has_retroreflection() const {
        return kind == MaterialKind::MetallicRoughness && specular_retroreflectivity > 0;
    }
    /// Returns whether its BSDF needs more than one reflection on a base, or it absorbs by distance.
    HD bool is_stacked() const {
        return !is_unlit() &&
               (has_coat() || has_fuzz() || transmits() || has_own_reflection() || absorbs() || has_anisotropy() ||
                has_thin_film() || has_diffuse_transmission() || has_rough_diffuse() || has_other_microfacets() ||
                dispersion() > 0 || has_retroreflection());
    }
    bool is_emissive() const { return max_component(emission) > 0; }
    /// Returns whether the material is sampled as an emitter. An unlit one is not: rays from the camera or a surface
    /// that hit it return its colour.
    bool is_emitter() const { return is_emissive() && !is_unlit(); }
};

/// Sets the index of refraction that glTF writes as `ior`, 0 or at least kLeastIor: 0 is an infinite one, with which
/// everything is reflected. No substance has one below 1; a bubble has it over what is around it.
inline void set_gltf_ior(MaterialParameters& m, float ior) {
    m.ior = ior == 0 ? kMostIor : ior;
    m.has_relative_ior = m.ior < 1;
}

/// Calls choice(value, name, names) for each choice of a material; `names` lists its values in their order.
template <class Parameters, class Choice>
void visit_choices(Parameters& m, const Choice& choice) {
    using Names = std::initializer_list<const char*>;
    choice(m.kind, "kind", Names{"diffuse", "conductor", "dielectric", "metallic_roughness", "unlit"});
    choice(m.alpha_mode, "alpha_mode", Names{"opaque", "mask", "blend"});
    choice(m.metal_fresnel, "metal_fresnel", Names{"schlick", "f82"});
    choice(m.microfacet_distribution, "microfacet_distribution", Names{"ggx", "beckmann"});
    choice(m.energy, "energy", Names{"compensated", "single"});
    choice(m.fuzz_model, "fuzz_model", Names{"charlie", "zeltner"});
}

/// Calls number(value, name, least, most) for each number of a material and each channel of its colours, and
/// texture(reference, name) for each texture slot, with or without an image.
template <class Parameters, class Number, class Texture>
void visit_parameters(Parameters& m, const Number& number, const Texture& texture) {
    const auto color = [&](auto& value, const char* name, float least, float most) {
        for (auto* channel : {&value.r, &value.g, &value.b}) number(*channel, name, least, most);
    };
    color(m.base_color, "base_color", 0, 1);
    color(m.emission, "emission", 0, kMaxSampleValue);
    color(m.eta, "eta", 0x1p-10f, 0x1p10f);
    color(m.k, "k", 0, 0x1p10f);
    number(m.alpha, "alpha", 0, 1);
    number(m.alpha_cutoff, "alpha_cutoff", 0, 0x1p10f);
    number(m.metallic, "metallic", 0, 1);
    number(m.roughness, "roughness", 0, 1);
    number(m.ior, "ior", kLeastIor, kMostIor);
    number(m.normal_scale, "normal_scale", -0x1p10f, 0x1p10f);
    number(m.transmission_weight, "transmission_weight", 0, 1);
    number(m.base_diffuse_roughness, "base_diffuse_roughness", 0, 1);
    number(m.specular_weight, "specular_weight", 0, 1);
    color(m.specular_color, "specular_color", 0, 0x1p10f);
    number(m.coat_weight, "coat_weight", 0, 1);
    number(m.coat_roughness, "coat_roughness", 0, 1);
    number(m.coat_ior, "coat_ior", 1, 0x1p10f);
    color(m.coat_color, "coat_color", 0, 1);
    number(m.coat_normal_scale, "coat_normal_scale", -0x1p10f, 0x1p10f);
    number(m.coat_roughness_anisotropy, "coat_roughness_anisotropy", 0, 1);
    number(m.coat_anisotropy_rotation, "coat_anisotropy_rotation", -0x1p10f, 0x1p10f);
    number(m.fuzz_weight, "fuzz_weight", 0, 1);
    number(m.fuzz_roughness, "fuzz_roughness", 0, 1);
    color(m.fuzz_color, "fuzz_color", 0, 1);
    color(m.transmission_color, "transmission_color", 0, 1);
    number(m.transmission_depth, "transmission_depth", 0, 0x1p40f);
    number(m.transmission_dispersion_scale, "transmission_dispersion_scale", 0, 1);
    number(m.transmission_dispersion_abbe_number, "transmission_dispersion_abbe_number", 1, 0x1p10f);
    number(m.specular_roughness_anisotropy, "specular_roughness_anisotropy", 0, 1);
    number(m.anisotropy_rotation, "anisotropy_rotation", -0x1p10f, 0x1p10f);
    number(m.thin_film_weight, "thin_film_weight", 0, 1);
    number(m.thin_film_ior, "thin_film_ior", 1, 0x1p10f);
    number(m.thin_film_thickness_nm, "thin_film_thickness_nm", 0, 0x1p20f);
    number(m.thin_film_least_nm, "thin_film_least_nm", 0, 0x1p20f);
    number(m.diffuse_transmission_weight, "diffuse_transmission_weight", 0, 1);
    color(m.diffuse_transmission_color, "diffuse_transmission_color", 0, 1);
    number(m.specular_retroreflectivity, "specular_retroreflectivity", 0, 1);
    number(m.priority, "priority", -0x1p10f, 0x1p10f);
    color(m.medium.sigma_a, "medium_sigma_a", 0, 0x1p40f);
    color(m.medium.sigma_s, "medium_sigma_s", 0, 0x1p40f);
    number(m.medium.g, "medium_g", -kMaxScatterAnisotropy, kMaxScatterAnisotropy);
    texture(m.base_color_texture, "base_color_texture");
    texture(m.alpha_texture, "alpha_texture");
    texture(m.metallic_texture, "metallic_texture");
    texture(m.roughness_texture, "roughness_texture");
    texture(m.emission_texture, "emission_texture");
    texture(m.normal_texture, "normal_texture");
    texture(m.transmission_texture, "transmission_texture");
    texture(m.specular_texture, "specular_texture");
    texture(m.specular_color_texture, "specular_color_texture");
    texture(m.coat_texture, "coat_texture");
    texture(m.coat_roughness_texture, "coat_roughness_texture");
    texture(m.coat_color_texture, "coat_color_texture");
    texture(m.coat_anisotropy_texture, "coat_anisotropy_texture");
    texture(m.coat_normal_texture, "coat_normal_texture");
    texture(m.fuzz_color_texture, "fuzz_color_texture");
    texture(m.fuzz_roughness_texture, "fuzz_roughness_texture");
    texture(m.anisotropy_texture, "anisotropy_texture");
    texture(m.thin_film_texture, "thin_film_texture");
    texture(m.thin_film_thickness_texture, "thin_film_thickness_texture");
    texture(m.diffuse_transmission_texture, "diffuse_transmission_texture");
    texture(m.diffuse_transmission_color_texture, "diffuse_transmission_color_texture");
    texture(m.retroreflectivity_texture, "retroreflectivity_texture");
}

/// Returns the places of the numbers named `name` in the order of visit_parameters: one, or three of a colour.
inline std::vector<uint8_t> material_numbers(std::string_view name) {
    std::vector<uint8_t> found;
    uint8_t index = 0;
    MaterialParameters material;
    visit_parameters(
        material,
        [&](float&, const char* known, float, float) {
            if (name == known) found.push_back(index);
            ++index;
        },
        [](auto&&...) {});
    return found;
}

/// Calls texture(reference, name) for each texture slot, with or without an image.
template <class Parameters, class Texture>
void visit_textures(Parameters& m, const Texture& texture) {
    visit_parameters(
        m, [](auto&&...) {}, texture);
}

/// A material of a scene: its parameters and its name.
struct Material : MaterialParameters {
    std::string name, origin; // `origin` is its location in the file

    /// Makes the material the boundary of a medium that all light passes unchanged.
    void make_clear_boundary() {
        is_clear_boundary = true;
        alpha_mode = AlphaMode::Mask;
        alpha = 0;
        ior = 1;
    }

    /// Texture slots that have an image.
    std::vector<const TextureRef*> textures() const {
        std::vector<const TextureRef*> found;
        visit_textures(*this, [&](const TextureRef& texture, const char*) {
            if (texture.has_image()) found.push_back(&texture);
        });
        return found;
    }
};

} // namespace pertev
