#pragma once

// Makes the BSDF at a point of a mesh from a material, with textures and vertex colours.

#include "device_scene/textured_factor.h"
#include "shading/bsdf.h"

namespace pertev {

/// Base colour of the material at a point of a triangle, [0, 1] per channel.
template <ShadingVariant kVariant = ShadingVariant::General>
HD inline Rgb base_color_at(const SceneView& scene, const MaterialParameters& material, const MeshView& mesh,
                            TriangleIndices i, float u, float v) {
    Rgb color = material.base_color;
    if (const TextureRef& ref = material.base_color_texture; has_texture<kVariant>(ref)) {
        const Vec4 texel =
            lookup_texture(scene.images, ref, texture_coordinate(mesh, ref, i, u, v), scene.linear_from_srgb);
        color = color * Rgb{texel.x, texel.y, texel.z};
    }
    if (mesh.colors != nullptr) {
        const Vec4 vertex = interpolate(mesh.colors, i, u, v);
        color = color * Rgb{vertex.x, vertex.y, vertex.z};
    }
    return {clamp(color.r, 0.0f, 1.0f), clamp(color.g, 0.0f, 1.0f), clamp(color.b, 0.0f, 1.0f)};
}

template <ShadingVariant kVariant = ShadingVariant::General>
HD inline Bsdf make_bsdf(const SceneView& scene, const MaterialParameters& material, const MeshView& mesh,
                         TriangleIndices i, float u, float v, Rgb base_color) {
    if (kVariant != ShadingVariant::General || material.kind == MaterialKind::Diffuse ||
        material.kind == MaterialKind::Unlit) {
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

} // namespace pertev
