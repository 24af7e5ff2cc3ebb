#pragma once

// How a particle leaves a light: the light by the draws of shading/light_set.h (power, and how much of it is near), the
// place on it evenly, the direction by the cosine (lamps), evenly over the sphere or the cone (point and spot lights),
// or from a disc as wide as the scene (directional lights, the environment). And the densities of that for a light
// found otherwise, for the weights.

#include <cstdint>

#include "device_scene/scene_view.h"
#include "device_scene/surface.h"
#include "integrators/subpaths/mis_walk.h"
#include "integrators/subpaths/subpath_settings.h"
#include "math/frame.h"

namespace pertev {

struct Particle {
    Ray ray;          // t_max: how far the light reaches
    TriangleId start; // that it leaves
    Rgb power;        // W, over the density of all that was drawn
    MisWalk mis;
    bool is_from_far; // its ray is one of many parallel ones: no distance counts on its first way
};

/// Of a lamp: density of the direction under `cosine` to its normal, 1/sr.
HD inline float pdf_emission(const EmissiveTriangle& triangle, float cosine) {
    return (triangle.is_two_sided != 0 ? 0.5f * kInvPi : kInvPi) * abs(cosine);
}
/// Density of a place on a triangle light, 1/m2, the choice of the light included.
HD inline float pdf_place(const EmissiveTriangle& triangle) {
    const float pdf = 2.0f * triangle.pmf / length(cross(triangle.ab, triangle.ac));
    return is_finite(pdf) ? pdf : 0.0f;
}
/// Of places that parallel rays come through, 1/m2.
HD inline float pdf_disc(const WorldSphere& world) { return kInvPi / square(world.radius); }
/// Of a direction of a point or spot light, 1/sr.
HD inline float pdf_direction(const PunctualLight& light) {
    return light.kind == LightKind::Spot ? pdf_uniform_cone(1.0f - light.cos_outer) : pdf_uniform_sphere();
}

/// Share of a point or spot light that is left at `distance` of one that reaches to `t_max`.
HD inline float left_at(float distance, float t_max) {
    PunctualLight reaching;
    reaching.range = t_max;
    return t_max < kInfinity ? punctual_falloff(reaching, {0, 0, 1}, distance) : 1.0f;
}

namespace emission {

HD inline bool from_triangle(const SceneView& scene, uint32_t light, Vec2 place, Vec2 u, uint32_t key,
                             Particle& particle) {
    const EmissiveTriangle& triangle = scene.lights.triangles[light];
    if (scene.any_alpha != 0 &&
        !AcceptHit{scene, {}, {}, key}.passes_alpha(triangle.instance, triangle.primitive, place.x, place.y)) {
        return false; // a hole in the light
    }
    const Vec2 uv = (1.0f - place.x - place.y) * triangle.uv0 + place.x * triangle.uv1 + place.y * triangle.uv2;
    const Rgb radiance = surface_emission<true>(scene.lights, triangle.material, uv);
    const float place_pdf = pdf_place(triangle);
    if (is_black(radiance) || !(place_pdf > 0)) return false;
    Vec3 normal = normalize(cross(triangle.ab, triangle.ac));
    if (triangle.is_two_sided != 0 && u.x < 0.5f) normal = -normal;
    if (triangle.is_two_sided != 0) u.x = u.x < 0.5f ? 2.0f * u.x : 2.0f * u.x - 1.0f;
    if (triangle.is_two_sided == 0 && triangle.is_mirrored != 0) normal = -normal;
    const Vec3 local = sample_cosine_hemisphere(u);
    const float pdf = pdf_emission(triangle, local.z);
    if (!(pdf > 0)) return false;
    const Vec3 direction = normalize(make_frame(normal).to_world(local));
    const Vec3 point = triangle.a + (place.x * triangle.ab + place.y * triangle.ac);
    particle.ray = {offset_ray_origin(point, light_point_error(point), normal, direction), 0, direction, kInfinity};
    particle.start = {triangle.instance, triangle.primitive};
    particle.power = (local.z / (place_pdf * pdf)) * radiance;
    particle.mis = {square(1.0f / pdf), min(square(local.z / (place_pdf * pdf)), kMostOdds)};
    return true;
}

HD inline bool from_punctual(const PunctualLight& light, float pmf, Vec2 u, const WorldSphere& world,
                             Particle& particle) {
    if (light.kind == LightKind::Directional) {
        const Vec2 disc = sample_uniform_disk_concentric(u);
        const Vec3 across = world.radius * make_frame(light.direction).to_world({disc.x, disc.y, -1});
        const float pdf = pdf_disc(world);
        particle.ray = {world.centre + across, 0, light.direction, kInfinity};
        particle.power = (1.0f / (pmf * pdf)) * light.intensity;
        particle.mis = {square(1.0f / pdf), 0};
        particle.is_from_far = true;
        return true;
    }
    const bool is_spot = light.kind == LightKind::Spot;
    const float pdf = pdf_direction(light);
    if (!(pdf > 0) || !is_finite(pdf)) return false;
    const Vec3 direction =
        is_spot ? normalize(make_frame(light.direction).to_world(sample_uniform_cone(u, 1.0f - light.cos_outer)))
                : sample_uniform_sphere(u);
    particle.ray = {light.position, 0, direction, light.range > 0 ? light.range : kInfinity};
    particle.power = (punctual_falloff(light, -direction, 0) / (pmf * pdf)) * light.intensity;
    particle.mis = {square(1.0f / pdf), 0};
    return true;
}

HD inline bool from_environment(const EnvironmentView& environment, float pmf, SampleBits place, Vec2 u,
                                const WorldSphere& world, Particle& particle) {
    EnvironmentSample sample;
    if (!sample_environment(environment, place, sample)) return false;
    const float pdf = pmf * sample.pdf, through_disc = pdf_disc(world);
    if (!(pdf > 0)) return false;
    const Vec2 disc = sample_uniform_disk_concentric(u);
    const Vec3 direction = -sample.wi;
    const Vec3 across = world.radius * make_frame(direction).to_world({disc.x, disc.y, -1});
    particle.ray = {world.centre + across, 0, direction, kInfinity};
    particle.power = (1.0f / (pdf * through_disc)) * sample.radiance;
    particle.mis = {square(1.0f / through_disc), min(square(1.0f / (pdf * through_disc)), kMostOdds)};
    particle.is_from_far = true;
    return true;
}

} // namespace emission

/// Draws a particle by `u_place`, as sample_light draws a light by it, and `u`. False: none, which counts as black.
/// `key`: the coin of a blended lamp.
HD inline bool emit_particle(const SceneView& scene, const WorldSphere& world, SampleBits u_place, Vec2 u, uint32_t key,
                             Particle& particle) {
    const LightSetView& lights = scene.lights;
    if (lights.choice.starts == nullptr || !(world.radius > 0)) return false;
    particle.start = {};
    particle.is_from_far = false;
    const uint32_t more = bits_behind(u_place);
    const OrderedDraw source = draw_ordered(lights.choice, u_place.x, more);
    if (source.index < lights.emitter_count) {
        const OrderedDraw triangle = draw_ordered(lights.triangles_of(source.index), u_place.y, more);
        const uint32_t first = lights.emitters[source.index].first_triangle;
        return emission::from_triangle(scene, first + lights.triangle_order[first + triangle.index],
                                       sample_uniform_triangle({rest_of(source), rest_of(triangle)}), u, key, particle);
    }
    const float pmf = ordered_pmf(source.owned);
    if (!(pmf > 0)) return false;
    if (source.index != lights.environment_source) {
        return emission::from_punctual(lights.punctual[source.index - lights.emitter_count], pmf, u, world, particle);
    }
    return emission::from_environment(lights.environment, pmf, {number_of_rest(source), u_place.y}, u, world, particle);
}

/// Densities of a light that a walk from the camera has met: of the place (1/m2; of far light the direction, 1/sr),
/// and of the direction from there (1/sr; of far light the place on the disc, 1/m2).
struct LightDensities {
    float place = 0, onwards = 0;

    /// Odds of all ways to find this light but the walk's own.
    HD float odds(const MisWalk& walk) const { return squared_density(place) * min(walk.others(onwards), kMostOdds); }
};

} // namespace pertev
