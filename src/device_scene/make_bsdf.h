#pragma once

// Makes the BSDF at a point of a mesh from a material, with textures and vertex colours.

#include <type_traits>

#include "device_scene/textured_factor.h"
#include "shading/make_reflection.h"

namespace pertev {

/// Base colour of the material at a point of a triangle, [0, 1] per channel.
template <ShadingVariant kVariant = ShadingVariant::General>
HD inline Rgb base_color_at(const SceneView& scene, const MaterialParameters& material, const MeshView& mesh,
                            TriangleIndices i, float u, float v) {
    Rgb color = material.base_color;
    if (const TextureRef& ref = material.base_color_texture; has_texture<kVariant>(ref)) {
        const Vec4 texel = texel_at(scene, mesh, ref, i, u, v);
        color = color * Rgb{texel.x, texel.y, texel.z};
    }
    if (mesh.colors != nullptr) {
        const Vec4 vertex = interpolate(mesh.colors, i, u, v);
        color = color * Rgb{vertex.x, vertex.y, vertex.z};
    }
    return {clamp(color.r, 0.0f, 1.0f), clamp(color.g, 0.0f, 1.0f), clamp(color.b, 0.0f, 1.0f)};
}

HD_CALL inline Rgb color_of_texture(const SceneView& scene, const MeshView& mesh, const TextureRef& ref,
                                    TriangleIndices i, float u, float v) {
    const Vec4 texel = texel_at(scene, mesh, ref, i, u, v);
    return {texel.x, texel.y, texel.z};
}
HD_CALL inline float share_of_texture(const SceneView& scene, const MeshView& mesh, float factor, const TextureRef& ref,
                                      TriangleIndices i, float u, float v) {
    return clamp(textured_factor(scene, mesh, factor, ref, i, u, v), 0.0f, 1.0f);
}

/// Returns `factor` times the texture's colour at a point of a triangle. Only a texture needs a call.
HD inline Rgb textured_color(const SceneView& scene, const MeshView& mesh, Rgb factor, const TextureRef& ref,
                             TriangleIndices i, float u, float v) {
    return ref.has_image() ? factor * color_of_texture(scene, mesh, ref, i, u, v) : factor;
}

/// Returns `factor` times the channel of `ref` in [0, 1], at a point of a triangle.
HD inline float textured_share(const SceneView& scene, const MeshView& mesh, float factor, const TextureRef& ref,
                               TriangleIndices i, float u, float v) {
    return ref.has_image() ? share_of_texture(scene, mesh, factor, ref, i, u, v) : clamp(factor, 0.0f, 1.0f);
}

/// Directions of a material at a point, in the shading frame.
struct MaterialAxes {
    Vec3 coat_normal = {0, 0, 1}; // unit
    Stretch stretch, coat_stretch;
};
struct NoMaterialAxes {}; // materials without stacks have none
template <ShadingVariant kVariant>
using MaterialAxesOf = std::conditional_t<kVariant == ShadingVariant::General, MaterialAxes, NoMaterialAxes>;

/// Makes the BSDF of a material that is not stacked.
template <ShadingVariant kVariant>
HD inline Bsdf make_unstacked_bsdf(const SceneView& scene, const MaterialParameters& material, const MeshView& mesh,
                                   TriangleIndices i, float u, float v, Rgb base_color) {
    if (!has_lobes(kVariant) || material.kind == MaterialKind::Diffuse || material.is_unlit()) {
        return make_diffuse(base_color);
    }
    const float roughness =
        clamp(textured_factor(scene, mesh, material.roughness, material.roughness_texture, i, u, v), 0.0f, 1.0f);
    switch (material.kind) {
    case MaterialKind::Diffuse:
    case MaterialKind::Unlit:
        break; // handled above
    case MaterialKind::Conductor:
        return make_conductor(material.eta, material.k, roughness);
    case MaterialKind::Dielectric:
        return make_dielectric(material.ior, roughness, base_color);
    case MaterialKind::MetallicRoughness: {
        const float metallic =
            clamp(textured_factor(scene, mesh, material.metallic, material.metallic_texture, i, u, v), 0.0f, 1.0f);
        return make_metallic_roughness(base_color, metallic, roughness, material.ior);
    }
    }
    return make_diffuse(base_color);
}

/// Fills an empty `bsdf` in place with the lobes of any material (build_reflection).
HD_CALL inline void build_any_bsdf(Bsdf& bsdf, const SceneView& scene, const MaterialParameters& material,
                                   const MeshView& mesh, TriangleIndices i, float u, float v, Rgb base_color,
                                   const MaterialAxes& axes) {
    if (!material.is_stacked()) {
        bsdf = make_unstacked_bsdf<ShadingVariant::Unstacked>(scene, material, mesh, i, u, v, base_color);
        return;
    }
    const auto number = [&](float factor, const TextureRef& ref) {
        return textured_share(scene, mesh, factor, ref, i, u, v);
    };
    const float roughness = number(material.roughness, material.roughness_texture);
    ReflectionParameters reflection = {.base_color = base_color,
                                       .roughness = roughness,
                                       .ior = material.ior,
                                       .anisotropy = axes.stretch.anisotropy,
                                       .along = axes.stretch.along,
                                       .diffuse_roughness = material.base_diffuse_roughness,
                                       .dispersion = material.dispersion()};
    reflection.is_beckmann = material.microfacet_distribution == MicrofacetDistribution::Beckmann;
    reflection.is_single = material.energy == MicrofacetEnergy::Single;
    if (material.has_thin_film()) {
        const float full = number(1, material.thin_film_thickness_texture);
        reflection.film = {number(material.thin_film_weight, material.thin_film_texture), material.thin_film_ior,
                           1e-3f * lerp(material.thin_film_least_nm, material.thin_film_thickness_nm, full)};
    }
    switch (material.kind) {
    case MaterialKind::Diffuse:
    case MaterialKind::Unlit:
        bsdf = make_rough_diffuse(base_color, material.base_diffuse_roughness);
        break;
    case MaterialKind::Conductor: // only here has it a weight: of the materials that are not stacked none has
        reflection.weight = number(material.specular_weight, material.specular_texture);
        bsdf = make_metal(material.eta, material.k, reflection);
        break;
    case MaterialKind::Dielectric:
        reflection.solid = 1;
        build_reflection(bsdf, reflection);
        break;
    case MaterialKind::MetallicRoughness: {
        const float through = number(material.transmission_weight, material.transmission_texture);
        (material.thin_walled ? reflection.through : reflection.solid) = through;
        reflection.metallic = number(material.metallic, material.metallic_texture);
        reflection.weight = number(material.specular_weight, material.specular_texture);
        reflection.color =
            textured_color(scene, mesh, material.specular_color, material.specular_color_texture, i, u, v);
        if (material.has_retroreflection()) {
            reflection.retroreflectivity =
                number(material.specular_retroreflectivity, material.retroreflectivity_texture);
        }
        if (material.metal_fresnel == MetalFresnel::F82) {
            const Rgb tint = reflection.color;
            reflection.metal_tint = {min(tint.r, 1.0f), min(tint.g, 1.0f), min(tint.b, 1.0f)};
        }
        if (material.has_diffuse_transmission()) {
            const TextureRef& colors = material.diffuse_transmission_color_texture;
            reflection.translucent =
                number(material.diffuse_transmission_weight, material.diffuse_transmission_texture);
            reflection.translucent_color =
                textured_color(scene, mesh, material.diffuse_transmission_color, colors, i, u, v);
        }
        build_reflection(bsdf, reflection);
        break;
    }
    }
    if (material.fuzz_weight > 0) {
        const Rgb color = textured_color(scene, mesh, material.fuzz_color, material.fuzz_color_texture, i, u, v);
        const float fuzz_roughness = number(material.fuzz_roughness, material.fuzz_roughness_texture);
        if (!is_black(color)) {
            const Rgb strength = material.fuzz_weight * color;
            if (material.fuzz_model == FuzzModel::Zeltner) {
                add_fuzz(bsdf, strength, fuzz_roughness);
            } else {
                add_sheen(bsdf, strength, fuzz_roughness);
            }
        }
    }
    if (material.coat_weight > 0) {
        const float weight = number(material.coat_weight, material.coat_texture);
        const float coat_roughness = number(material.coat_roughness, material.coat_roughness_texture);
        if (weight > 0) {
            const Rgb color = textured_color(scene, mesh, material.coat_color, material.coat_color_texture, i, u, v);
            add_coat(bsdf, weight, coat_roughness, material.coat_ior, axes.coat_normal, color, axes.coat_stretch);
        }
    }
}

/// Returns the BSDF of a material at a point of a triangle.
template <ShadingVariant kVariant = ShadingVariant::General>
HD inline Bsdf make_bsdf(const SceneView& scene, const MaterialParameters& material, const MeshView& mesh,
                         TriangleIndices i, float u, float v, Rgb base_color,
                         [[maybe_unused]] const MaterialAxesOf<kVariant>& axes = {}) {
    if constexpr (kVariant != ShadingVariant::General) {
        return make_unstacked_bsdf<kVariant>(scene, material, mesh, i, u, v, base_color);
    } else {
        const bool is_diffuse = material.kind == MaterialKind::Diffuse && !material.is_stacked();
        Bsdf bsdf;
        if (is_diffuse) {
            bsdf.base = DiffuseLobe{base_color, 1};
        } else {
            build_any_bsdf(bsdf, scene, material, mesh, i, u, v, base_color, axes);
        }
        bsdf.is_called = true;
        return bsdf;
    }
}

} // namespace pertev
