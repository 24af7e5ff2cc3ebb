#pragma once

// A pixel's GI reservoir: one surface point that the pixel's surface sees, and the light that diffuse lobes there
// send; 48 bytes.
//
// Diffuse lobes beneath a reflecting layer send A(wo) B: the transmittance on the way out, times the light that has
// entered, which does not depend on the direction (shading/lobes/layer_transmittance.h). B is stored, so that a point
// sends the right light to any receiver. Thus reuse is exact; light of other lobes at the point stays with the path
// that found it. If a normal map's normal is bent towards the viewer at grazing angles (shading_frame.h), the two
// differ slightly.
//
// Densities of points are measured in barycentric weights of their triangle. The ratio of solid angles between two
// pixels (the Jacobian of Ouyang et al., "ReSTIR GI: Path Resampling for Real-Time Path Tracing", HPG 2021, equation
// 11) is then part of the target functions.

#include "restir/light_reservoir.h"

namespace pertev {

struct alignas(16) BounceReservoir {
    uint32_t instance = kNoHit, primitive = 0;
    float u = 0, v = 0; // weights of the triangle's second and third vertex
    Rgb radiance;       // B, W/(sr m2)
    float weight = 0;   // contribution weight, as in LightReservoir
    float count = 0;
    float seen = 0;
    uint32_t source = 0;
    float side = 0; // 1 if `radiance` leaves on the front of the triangle (corners counter-clockwise), else -1

    HD Hit hit() const { return {0, u, v, instance, primitive}; }
};
static_assert(sizeof(BounceReservoir) == 48);

/// A reservoir's point relative to a surface that reuses it.
struct Reconnection {
    Vec3 wi;       // unit, towards it
    float measure; // solid angle per barycentric measure
    float side;    // visible side, in the sense of BounceReservoir::side
    bool is_there;
};

/// `normal` is the cross product of the triangle's edges.
HD inline Reconnection reconnect(Vec3 position, Vec3 normal, Vec3 from) {
    const Vec3 offset = position - from;
    const float distance_squared = length_squared(offset);
    const Vec3 wi = offset / sqrt(distance_squared);
    const float facing = dot(normal, wi), measure = abs(facing) / distance_squared;
    return {wi, measure, facing < 0 ? 1.0f : -1.0f, measure > 0 && is_finite(measure)};
}
HD inline Reconnection reconnect(const WorldTriangle& triangle, Vec3 from) {
    return reconnect(triangle.position, cross(triangle.ab, triangle.ac), from);
}

HD inline WorldTriangle world_triangle(const SceneView& scene, const BounceReservoir& reservoir) {
    const InstanceView& instance = scene.instances[reservoir.instance];
    return world_triangle(instance, scene.meshes[instance.mesh], reservoir.hit());
}

/// Returns A(wo) of the surface at `hit`, seen along `direction`, times its colours' luminance. It is 0 if the surface
/// has no diffuse lobes.
template <ShadingVariant kVariant>
HD inline float diffuse_transmittance(const SceneView& scene, const Hit& hit, Vec3 direction) {
    if constexpr (kVariant == ShadingVariant::Diffuse) { // it does not depend on the direction
        const InstanceView& instance = scene.instances[hit.instance];
        const MeshView& mesh = scene.meshes[instance.mesh];
        const TriangleIndices corners = triangle_indices(mesh, hit.primitive);
        const MaterialParameters& material = scene.materials[instance.material];
        const Rgb albedo = base_color_at<kVariant>(scene, material, mesh, corners, hit.u, hit.v);
        const Vec3 up = {0, 0, 1};
        return luminance(DiffuseLobe{albedo, 1}.evaluate(up, up, {}).f);
    } else {
        const Surface surface = make_surface<kVariant>(scene, hit, direction);
        const Vec3 wo = surface.frame.to_local(-direction);
        return luminance(surface.bsdf.evaluate(wo, {0, 0, copysign(1.0f, wo.z)}, only(LobeClass::Diffuse)).f);
    }
}

/// Holds what is the same for all receivers: a reservoir's point in the world, and the light that the point sends.
struct PreparedBounce {
    Vec3 position, normal; // normal: cross product of its triangle's edges
    Rgb radiance;
    float side;
};
HD inline PreparedBounce prepare_light(const SceneView& scene, const BounceReservoir& reservoir) {
    const WorldTriangle triangle = world_triangle(scene, reservoir);
    return {triangle.position, cross(triangle.ab, triangle.ac), reservoir.radiance, reservoir.side};
}

/// Returns the integrand of indirect light that only diffuse lobes of the receiver scatter, without A, which the target
/// does not need.
template <ShadingVariant kVariant>
HD inline Rgb light_scattered(const SceneView&, const Receiver<kVariant>& receiver, const PreparedBounce& from) {
    const Reconnection seen = reconnect(from.position, from.normal, receiver.position());
    if (!seen.is_there || seen.side != from.side) return {};
    return seen.measure * (receiver.evaluate(seen.wi, only(LobeClass::Diffuse)).f * from.radiance);
}

HD inline bool make_visibility_ray(const SceneView& scene, const BounceReservoir& reservoir, const WorldTriangle& from,
                                   uint32_t coin, Ray& ray, TriangleId& target) {
    const WorldTriangle triangle = world_triangle(scene, reservoir);
    const Reconnection seen = reconnect(triangle, from.position);
    if (!seen.is_there || seen.side != reservoir.side) return false;
    ray.origin = offset_ray_origin(from.position, from.error, from.normal, seen.wi);
    ray.direction = offset_ray_origin(triangle.position, triangle.error, triangle.normal, -seen.wi) - ray.origin;
    ray.t_max = 1;
    target = {reservoir.instance, reservoir.primitive};
    return scene.any_alpha == 0 || AcceptHit{scene, {}, {}, coin}.passes_alpha(reservoir.instance, reservoir.primitive,
                                                                               reservoir.u, reservoir.v);
}

} // namespace pertev
