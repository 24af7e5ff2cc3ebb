#pragma once

// Emission of particles: samples the light as in shading/light_set.h (by power and the share of near lights), a
// uniform point on it, and the direction by the cosine (emitters), uniformly over the sphere or the cone (point and
// spot lights), or from a disc as wide as the scene (directional lights, the environment). It also has the densities
// of these samples for lights found otherwise, for MIS weights.

#include <cstdint>

#include "device_scene/scene_view.h"
#include "device_scene/surface.h"
#include "integrators/subpaths/subpath_memory.h"
#include "integrators/subpaths/subpath_settings.h"
#include "math/frame.h"

namespace pertev {

struct Particle {
    Ray ray;          // t_max: range of the light
    TriangleId start; // triangle that it leaves
    Rgb power;        // W, divided by the density of everything that was sampled
    MisSums mis;
    bool is_from_far; // the ray is one of many parallel ones, so the first segment has no distance
    uint32_t light;   // number of a light with a position, as in NestingView::of_lights; kNoLight: it is from far
    bool is_punctual; // the light has no size
};

/// Density of an emitter's direction with `cosine` to its normal, 1/sr.
HD inline float pdf_emission(const EmissiveTriangle& triangle, float cosine) {
    return (triangle.is_two_sided != 0 ? 0.5f * kInvPi : kInvPi) * abs(cosine);
}
/// Density of a point on a triangle light, 1/m2, including the selection of the light.
HD inline float pdf_position(const EmissiveTriangle& triangle) {
    const float pdf = 2.0f * triangle.pmf / length(cross(triangle.ab, triangle.ac));
    return is_finite(pdf) ? pdf : 0.0f;
}

/// Attenuation, [0, 1], of a point or spot light at `distance` metres if its range is `t_max`.
HD inline float left_at(float distance, float t_max) {
    return t_max < kInfinity ? range_falloff(t_max, distance) : 1.0f;
}

/// A point on an emitter that light leaves.
struct EmissionPoint {
    Vec3 point, normal; // `normal` is unit, by the winding
    Rgb radiance;       // beneath any coat
    Vec2 uv;
    float pdf; // 1/m2, including the selection of the emitter

    /// Radiance that leaves along the unit `direction` of cosine `cosine` to the normal.
    HD Rgb radiance_along(const SceneView& scene, const EmissiveTriangle& triangle, float cosine) const {
        const SurfaceEmission& surface = scene.lights.emissions[triangle.material];
        return surface.coat_weight > 0 ? coat_transmittance(scene.lights, surface, uv, abs(cosine)) * radiance
                                       : radiance;
    }
};

/// Finds the point with the weights `at` of a triangle light's second and third vertex. Returns false if it emits
/// nothing. `key` is the key of a blended emitter.
HD inline bool find_emission_point(const SceneView& scene, uint32_t light, Vec2 at, uint32_t key,
                                   EmissionPoint& emission) {
    const EmissiveTriangle& triangle = scene.lights.triangles[light];
    if (scene.any_alpha != 0 &&
        !AcceptHit{scene, {}, {}, key}.passes_alpha(triangle.instance, triangle.primitive, at.x, at.y)) {
        return false; // transparent part of the light
    }
    emission.uv = (1.0f - at.x - at.y) * triangle.uv0 + at.x * triangle.uv1 + at.y * triangle.uv2;
    emission.radiance = surface_emission(scene.lights, triangle.material, emission.uv);
    emission.pdf = pdf_position(triangle);
    if (is_black(emission.radiance) || !(emission.pdf > 0)) return false;
    emission.point = triangle.a + (at.x * triangle.ab + at.y * triangle.ac);
    emission.normal = normalize(cross(triangle.ab, triangle.ac));
    return true;
}

/// Makes the ray from a point on an emitter, on the side of `normal`.
HD inline void start_particle(const EmissiveTriangle& triangle, const EmissionPoint& emission, Vec3 normal,
                              Vec3 direction, Particle& particle) {
    particle.ray = {offset_ray_origin(emission.point, light_point_error(emission.point), normal, direction), 0,
                    direction, kInfinity};
    particle.start = {triangle.instance, triangle.primitive};
}

/// Emits a particle from each kind of light that draw_light has selected, by `u`.
struct EmitFromKind {
    const SceneView& scene;
    const WorldSphere& world;
    Vec2 u;
    uint32_t key; // the key that find_emission_point takes
    Particle& particle;

    HD bool triangle(uint32_t light, Vec2 at, float) const {
        EmissionPoint emission;
        return find_emission_point(scene, light, at, key, emission) && triangle(light, emission);
    }
    HD bool triangle(uint32_t light, const EmissionPoint& emission) const {
        const EmissiveTriangle& triangle = scene.lights.triangles[light];
        Vec3 normal = emission.normal;
        Vec2 about = u;
        if (triangle.is_two_sided != 0 && u.x < 0.5f) normal = -normal;
        if (triangle.is_two_sided != 0) about.x = u.x < 0.5f ? 2.0f * u.x : 2.0f * u.x - 1.0f;
        if (triangle.is_two_sided == 0 && triangle.is_mirrored != 0) normal = -normal;
        const Vec3 local = sample_cosine_hemisphere(about);
        const float pdf = pdf_emission(triangle, local.z);
        if (!(pdf > 0)) return false;
        start_particle(triangle, emission, normal, normalize(make_frame(normal).to_world(local)), particle);
        particle.light = light;
        particle.power = (local.z / (emission.pdf * pdf)) * emission.radiance_along(scene, triangle, local.z);
        particle.mis = {square(1.0f / pdf), min(square(local.z / (emission.pdf * pdf)), kMaxWeightSum)};
        return true;
    }
    HD bool punctual(uint32_t number, float pmf) const {
        if (!(pmf > 0)) return false;
        const PunctualLight& light = scene.lights.punctual[number];
        const PunctualEmission emission = emit_from(light, world, u, scene.lights.goniometric);
        if (!(emission.pdf > 0) || !is_finite(emission.pdf)) return false;
        particle.is_from_far = !(depth_of_beam(light) > 0);
        if (!particle.is_from_far) particle.light = scene.lights.triangle_count + number;
        particle.mis = {square(1.0f / emission.pdf), 0};
        return punctual(light, emission, pmf);
    }
    HD bool punctual(const PunctualLight& light, const PunctualEmission& emission, float pmf) const {
        particle.ray = {emission.from, 0, emission.direction, emission.reach};
        particle.power = emitted_power(light, emission, pmf, scene.lights.goniometric);
        particle.is_punctual = true;
        return true;
    }
    HD bool environment(float pmf, SampleBits bits) const {
        EnvironmentSample sample;
        if (!(pmf > 0) || !sample_environment(scene.lights.environment, bits, sample)) return false;
        const float pdf = pmf * sample.pdf, through_disc = pdf_disc(world);
        if (!(pdf > 0)) return false;
        particle.ray = {sample_disc(world, -sample.wi, u), 0, -sample.wi, kInfinity};
        particle.is_from_far = true;
        particle.power = (1.0f / (pdf * through_disc)) * sample.radiance;
        particle.mis = {square(1.0f / through_disc), min(square(1.0f / (pdf * through_disc)), kMaxWeightSum)};
        return true;
    }
};

/// Samples a particle; `u_position` is used as in sample_light, and `u` for the rest. Returns false if there is none,
/// which counts as black. `key` is the key of a blended emitter.
HD inline bool emit_particle(const SceneView& scene, const WorldSphere& world, SampleBits u_position, Vec2 u,
                             uint32_t key, Particle& particle) {
    if (!(world.radius > 0)) return false;
    particle.start = {};
    particle.is_from_far = false;
    particle.light = kNoLight;
    particle.is_punctual = false;
    return draw_light(scene.lights, u_position, EmitFromKind{scene, world, u, key, particle});
}

/// Densities of a light that a camera subpath has hit: of the point (1/m2; for distant light of the direction, 1/sr),
/// and of the direction from there (1/sr; for distant light of the point on the disc, 1/m2).
struct LightDensities {
    float position = 0, direction = 0;
    float selection = 1; // density with which next-event estimation samples the point, over `position`

    /// MIS weight sum of all techniques that find the light, except the subpath's own.
    HD float weight_sum(const MisSums& subpath) const {
        return squared_density(position) * min(subpath.weight_sum(direction), kMaxWeightSum);
    }
    /// MIS weight sum where next-event estimation and emission select the light with different probabilities.
    HD float weight_sum_by_tree(const MisSums& subpath) const {
        const MisSums emitted = {0, subpath.earlier};
        return squared_density(selection * position) * subpath.last +
               squared_density(position) * emitted.weight_sum(direction);
    }
};

} // namespace pertev
