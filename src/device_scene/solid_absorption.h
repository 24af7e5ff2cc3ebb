#pragma once

// Light that solids absorb along a straight segment (KHR_materials_volume). Unless solids lie in each other
// (nested_solids.h), no path knows in which solid it is. A segment is in the solid that it leaves inwards or reaches
// from inside, by the fronts of the triangles at its two ends. The rule is equal from both ends, so all integrators
// agree. Where both are solids, it is the one that comes first in the scene. A segment that ends nowhere, and one
// between two surfaces that are no solids, is in a vacuum.

#include "device_scene/moved_surface.h"
#include "math/portable_pow.h"

namespace pertev {

/// Returns whether a ray along `direction` is behind the front of a triangle, the side of its solid.
HD inline bool points_inwards(const SceneView& scene, TriangleId triangle, Vec3 direction, float time) {
    const Hit at = {0, 0.25f, 0.25f, triangle.instance, triangle.primitive};
    const InstanceView& instance = scene.instances[triangle.instance];
    const MeshView& mesh = scene.meshes[instance.mesh];
    const Vec3 normal = front_normal(instance, mesh, world_triangle(instance, mesh, at));
    return dot(normal, MovedHit(scene, at, time).back(direction)) < 0;
}

/// Returns the transmittance of `distance` metres in a solid that absorbs; 1 if they do not end.
HD inline Rgb transmittance_of_depth(const MaterialParameters& solid, float distance) {
    if (!(distance < kInfinity)) return {1, 1, 1};
    const float depths = distance / solid.transmission_depth;
    const Rgb color = solid.transmission_color;
    return {pow(color.r, depths), pow(color.g, depths), pow(color.b, depths)};
}

/// Returns the transmittance of `distance` metres along `direction` from the triangle `start` to `end`; either may have
/// kNoHit as its instance.
HD_CALL inline Rgb transmittance_of_solid(const SceneView& scene, TriangleId start, TriangleId end, Vec3 direction,
                                          float distance, float time) {
    const MaterialParameters* solid = nullptr;
    const auto look_at = [&](TriangleId triangle, Vec3 inwards) {
        if (triangle.instance == kNoHit) return;
        const MaterialParameters& material = scene.materials[scene.instances[triangle.instance].material];
        if (material.absorbs() && points_inwards(scene, triangle, inwards, time)) solid = &material;
    };
    const bool starts_first = start.instance <= end.instance;
    look_at(starts_first ? end : start, starts_first ? -direction : direction);
    look_at(starts_first ? start : end, starts_first ? direction : -direction);
    return solid != nullptr ? transmittance_of_depth(*solid, distance) : Rgb{1, 1, 1};
}

/// Returns the transmittance of the ray that found `hit`, with a unit direction. Only scenes of the general variant
/// have solids that absorb.
template <ShadingVariant kVariant>
HD inline Rgb transmittance_to_hit(const SceneView& scene, TriangleId start, Vec3 direction, const Hit& hit,
                                   float time = kAtRest) {
    if constexpr (kVariant == ShadingVariant::General) {
        return transmittance_of_solid(scene, start, {hit.instance, hit.primitive}, direction, hit.t, time);
    }
    return {1, 1, 1};
}

/// Transmittance from a surface to a sample point on a light.
template <ShadingVariant kVariant>
HD inline Rgb transmittance_to_light(const SceneView& scene, TriangleId start, const LightSample& light,
                                     float time = kAtRest) {
    if constexpr (kVariant == ShadingVariant::General) {
        return transmittance_of_solid(scene, start, triangle_of(light), light.wi, light.distance, time);
    }
    return {1, 1, 1};
}

} // namespace pertev
