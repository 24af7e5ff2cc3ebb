#pragma once

// Acceptance rules for candidate hits: not the triangle where the ray starts, not the one at which it is aimed; on
// surfaces with alpha only what the texture (cut-out) or a coin (blend) lets count; and for camera rays not the backs
// of single-sided surfaces. The result depends on the ray, the instance, the primitive and the position on it, never
// on the traversal.

#include <cstdint>

#include "device_scene/scene_view.h"
#include "device_scene/textured_factor.h"
#include "math/random.h"
#include "math/sampler.h"
#include "trace/scene_trees.h"

namespace pertev {

/// A triangle of the scene, or none.
struct TriangleId {
    uint32_t instance = kNoHit, primitive = 0;
    bool operator==(const TriangleId&) const = default;
};

/// Alpha of the material at a point of a triangle: its factor times that of the texture and of the vertex colour.
HD inline float alpha_at(const SceneView& scene, const MaterialParameters& material, const MeshView& mesh,
                         uint32_t primitive, float u, float v) {
    const TriangleIndices i = triangle_indices(mesh, primitive);
    TextureRef color = material.base_color_texture;
    color.channel = 3;
    float alpha = textured_factor(scene, mesh, material.alpha, color, i, u, v);
    alpha = textured_factor(scene, mesh, alpha, material.alpha_texture, i, u, v);
    if (mesh.colors != nullptr) {
        // In this form equal values are interpolated exactly.
        const float a = mesh.colors[i.a].w;
        alpha *= a + (u * (mesh.colors[i.b].w - a) + v * (mesh.colors[i.c].w - a));
    }
    return alpha;
}

/// Key of the random decision of a blended surface: the triangle, but on its border the edge or the corner at the hit,
/// identified by the positions of its ends. A ray exactly through an edge hits the triangles on both sides of it
/// (trace/intersect/intersect_triangle.h), and with one decision they count as one surface.
HD inline uint32_t coin_owner(const MeshView& mesh, uint32_t primitive, float u, float v) {
    constexpr float kMinWeight = 0x1p-20f; // rounding of weights is at most a quarter of this
    const float w = 1.0f - u - v;
    if (min(u, min(v, w)) >= kMinWeight) return primitive;
    const auto hash_of = [&](uint32_t vertex) {
        const Vec3 p = mesh.positions[vertex];
        return hash_words(bits_of(p.x + 0.0f), bits_of(p.y + 0.0f), bits_of(p.z + 0.0f)).x; // -0 as 0
    };
    const TriangleIndices i = triangle_indices(mesh, primitive);
    uint32_t sum = 0; // symmetric, because the neighbour may have the ends in reverse order
    if (w >= kMinWeight) sum += hash_of(i.a);
    if (u >= kMinWeight) sum += hash_of(i.b);
    if (v >= kMinWeight) sum += hash_of(i.c);
    return sum;
}

/// Key of the random decisions of blended surfaces for a ray of a sample's path after `depth` scatterings.
HD inline uint32_t coin_key(SampleKey sample, uint32_t depth, bool is_shadow) {
    return hash_words(sample.stream, sample.sample, sample.seed, depth * 2 + (is_shadow ? 1u : 0u)).x;
}

struct AcceptHit {
    const SceneView& scene;
    TriangleId start, target;       // never hit by this ray
    uint32_t key;                   // key of the path and depth, for the coin of blended surfaces
    float time = kAtRest;           // time of the ray while the shutter is open, [0, 1]
    bool passes_thin_walls = false; // for shadow rays whose light is dimmed by them (thin_walls.h)

    HD bool operator()(uint32_t instance, uint32_t primitive, float u, float v) const {
        if (instance == start.instance && primitive == start.primitive) return false;
        if (instance == target.instance && primitive == target.primitive) return false;
        if (passes_thin_walls && scene.instances[instance].is_thin_wall != 0) return false;
        if (scene.any_alpha == 0) return true;
        return passes_alpha(instance, primitive, u, v);
    }

    HD Ray move_back(uint32_t motion, const Ray& ray) const {
        return pertev::move_back(scene.motions.at(motion, time), ray);
    }

    /// Returns whether the candidate counts by its alpha.
    HD bool passes_alpha(uint32_t instance, uint32_t primitive, float u, float v) const {
        const Opacity known = known_opacity(scene.micromaps, instance, primitive, u, v);
        if (known != Opacity::Unknown) return known == Opacity::Opaque;
        const InstanceView& placed = scene.instances[instance];
        if (placed.has_alpha == 0) return true;
        const MaterialParameters& material = scene.materials[placed.material];
        const MeshView& mesh = scene.meshes[placed.mesh];
        const float alpha = alpha_at(scene, material, mesh, primitive, u, v);
        if (material.alpha_mode == AlphaMode::Mask) return alpha >= material.alpha_cutoff;
        return unit_interval(hash_words(key, instance, coin_owner(mesh, primitive, u, v)).x) < alpha;
    }
};

/// Returns the triangle on which a light was sampled; none for lights of other kinds.
HD inline TriangleId triangle_of(const LightSample& light) {
    switch (light.kind()) {
    case SourceKind::Triangle:
        return {light.instance, light.primitive};
    case SourceKind::Punctual:
    case SourceKind::Environment:
        break;
    }
    return {};
}

/// Returns whether the sampled point lies in a transparent part of an emitter. `key` is that of AcceptHit.
HD inline bool is_hole(const SceneView& scene, const LightSample& light, uint32_t key) {
    return scene.any_alpha != 0 && light.kind() == SourceKind::Triangle &&
           !AcceptHit{scene, {}, {}, key}.passes_alpha(light.instance, light.primitive, light.b1, light.b2);
}

/// Returns whether rays that lead to a surface of the instance may pass it by chance. Blended surfaces whose alpha is 1
/// everywhere count as opaque.
HD inline bool has_stochastic_hits(const SceneView& scene, uint32_t instance) {
    if (scene.any_alpha == 0) return false;
    const InstanceView& placed = scene.instances[instance];
    if (placed.layers_above > 0) return true;
    const MaterialParameters& material = scene.materials[placed.material];
    return material.alpha_mode == AlphaMode::Blend &&
           (material.alpha < 1 || material.base_color_texture.has_image() || material.alpha_texture.has_image() ||
            scene.meshes[placed.mesh].colors != nullptr);
}
/// Probability that a ray meets a point of a surface to which it leads: the alpha of a blended surface, times what the
/// layers above it let pass. It is 1 where has_stochastic_hits() is false.
HD inline float hit_probability(const SceneView& scene, uint32_t instance, uint32_t primitive, float u, float v) {
    const auto alpha_of = [&](uint32_t layer) {
        const InstanceView& placed = scene.instances[layer];
        const MaterialParameters& material = scene.materials[placed.material];
        return clamp(alpha_at(scene, material, scene.meshes[placed.mesh], primitive, u, v), 0.0f, 1.0f);
    };
    const auto is_blended = [&](uint32_t layer) {
        return scene.materials[scene.instances[layer].material].alpha_mode == AlphaMode::Blend;
    };
    float chance = is_blended(instance) ? alpha_of(instance) : 1.0f;
    for (uint32_t k = scene.instances[instance].layers_above; k > 0; --k) {
        if (is_blended(instance - k)) chance *= 1.0f - alpha_of(instance - k);
    }
    return chance;
}

/// Returns whether the instance, at its position at rest, culls the side that a camera ray of this direction (world
/// space) reaches. It is tested in the mesh's own space, where the winding defines the front, mirrored or not.
HD inline bool hides_side(const SceneView& scene, Vec3 direction, uint32_t instance, uint32_t primitive) {
    const InstanceView& placed = scene.instances[instance];
    if (placed.hides_back == 0) return false;
    const MeshView& mesh = scene.meshes[placed.mesh];
    const TriangleIndices i = triangle_indices(mesh, primitive);
    const Vec3 a = mesh.positions[i.a], ab = mesh.positions[i.b] - a, ac = mesh.positions[i.c] - a;
    const float size = max(max_component(abs(ab)), max_component(abs(ac)));
    const Vec3 normal = cross((1.0f / size) * ab, ac); // scaled, because the product of two tiny edges would
                                                       // underflow
    return dot(normal, transform_vector(placed.local_from_world, direction)) > 0;
}

/// Acceptance of camera rays in a scene with culled backs. It is a separate type, because the traversal of other rays
/// has no registers to spare.
struct AcceptCameraHit {
    AcceptHit accept;
    Vec3 direction; // direction of the ray, world space

    HD Ray move_back(uint32_t motion, const Ray& ray) const { return accept.move_back(motion, ray); }
    HD bool operator()(uint32_t instance, uint32_t primitive, float u, float v) const {
        return !hits_hidden_back(instance, primitive) && accept(instance, primitive, u, v);
    }

    HD bool hits_hidden_back(uint32_t instance, uint32_t primitive) const {
        if (accept.scene.instances[instance].hides_back == 0) return false;
        const uint32_t motion = accept.scene.motions.of(instance);
        const Vec3 at_rest =
            motion == kNoMotion ? direction : accept.scene.motions.at(motion, accept.time).rotate_back(direction);
        return hides_side(accept.scene, at_rest, instance, primitive);
    }
};

} // namespace pertev
