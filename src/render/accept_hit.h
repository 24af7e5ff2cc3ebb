#pragma once

// Which candidates of a walk count: not the triangle that the ray starts on, not the one that it is aimed at, and of
// surfaces with alpha those that the texture (cut-out) or a coin (blend) lets through. A function of the ray, the
// instance, the primitive and the place on it; never of the walk.

#include <cstdint>

#include "math/random.h"
#include "math/sampler.h"
#include "render/make_bsdf.h"
#include "render/scene_view.h"

namespace pertev {

/// A triangle of the scene, or none.
struct TriangleId {
    uint32_t instance = kNoHit, primitive = 0;
    bool operator==(const TriangleId&) const = default;
};

/// Alpha of the material there: its factor, the textures' and the vertex colour's.
HD inline float alpha_at(const SceneView& scene, const MaterialView& material, const MeshView& mesh, uint32_t primitive,
                         float u, float v) {
    const TriangleIndices i = triangle_indices(mesh, primitive);
    TextureRef color = material.base_color_texture;
    color.channel = 3;
    float alpha = textured_factor(scene, mesh, material.alpha, color, i, u, v);
    alpha = textured_factor(scene, mesh, alpha, material.alpha_texture, i, u, v);
    if (mesh.colors != nullptr) alpha *= interpolate(mesh.colors, i, u, v).w;
    return alpha;
}

struct AcceptHit {
    const SceneView& scene;
    TriangleId start, target; // not hit by this ray
    uint32_t key;             // of the path and depth: the coin of blended surfaces

    HD bool operator()(uint32_t instance, uint32_t primitive, float u, float v) const {
        if (instance == start.instance && primitive == start.primitive) return false;
        if (instance == target.instance && primitive == target.primitive) return false;
        if (scene.any_alpha == 0) return true;
        return passes_alpha(instance, primitive, u, v);
    }

    HD bool passes_alpha(uint32_t instance, uint32_t primitive, float u, float v) const {
        const InstanceView& placed = scene.instances[instance];
        if (placed.has_alpha == 0) return true;
        const MaterialView& material = scene.materials[placed.material];
        const float alpha = alpha_at(scene, material, scene.meshes[placed.mesh], primitive, u, v);
        if (material.alpha_mode == AlphaMode::Mask) return alpha >= material.alpha_cutoff;
        return unit_interval(hash_words(key, instance, primitive).x) < alpha;
    }
};

} // namespace pertev
