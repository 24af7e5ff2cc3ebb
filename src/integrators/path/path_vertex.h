#pragma once

// Shades a path's hit, or its miss: makes the vertex, adds emission, requests a shadow ray towards one light
// (next-event estimation) and scatters the path. It contains light transport only; everything else is done by
// listeners (path_listener.h). Both devices use the same functions.
//
// Source: Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997, chapter 9 (multiple importance
// sampling, power heuristic) and 10.4 (Russian roulette).

#include "device_scene/moved_surface.h"
#include "device_scene/nested_solids.h"
#include "device_scene/surface.h"
#include "device_scene/thin_walls.h"
#include "integrators/path/medium.h"
#include "integrators/path/path_listener.h"
#include "integrators/path/vertex_numbers.h"
#include "shading/follow_channel.h"
#include "shading/power_heuristic.h"
#include "shading/survival.h"

namespace pertev {

/// Returns whether light counts that was scattered `rough` times by other than delta lobes.
HD inline bool counts(PathLight light, uint32_t rough) {
    switch (light) {
    case PathLight::Path:
        return true;
    case PathLight::Direct:
        return rough <= 1;
    case PathLight::Indirect:
        return rough >= 2;
    }
    return false;
}

/// Contribution after the user's clamp, which excludes light that was scattered at most once. The limit applies
/// before the MIS weight: `contribution` has been weighted by `weight`, so the limit is as well.
HD inline Rgb clamp_contribution(const PathSettings& settings, uint32_t scatterings, float weight, Rgb contribution) {
    const float largest = max_component(contribution), limit = weight * settings.clamp;
    if (!(settings.clamp > 0) || scatterings <= 1 || !(largest > limit)) return contribution;
    return (limit / largest) * contribution;
}

/// Contribution of light that the path's own ray hit. `light_pdf` is the density with which next-event estimation at
/// the previous vertex would have sampled this direction, 1/sr; 0 for light that it cannot find.
HD inline Rgb emitted_light(const PathSettings& settings, const PathState& path, Rgb emission, float light_pdf) {
    if (!counts(settings.light, path.rough_depth)) return {0, 0, 0};
    float weight = 1;
    if (path.bsdf_pdf > 0 && light_pdf > 0) {
        if (settings.strategy == LightStrategy::NeeOnly) return {0, 0, 0};
        if (settings.strategy == LightStrategy::Mis) weight = power_heuristic(path.bsdf_pdf, light_pdf);
    }
    return clamp_contribution(settings, path.depth, weight, path.throughput * (weight * emission));
}

/// Returns the context with which next-event estimation selected a light where the ray begins, except for the offset
/// of the ray's origin.
template <Features kFeatures>
HD inline LightContext context_before(const PathState& path) {
    Vec3 position = path.origin;
    if constexpr ((kFeatures & kMedia) != 0) position = position - path.passed * path.direction;
    return {position, path.normal, false, path.time};
}

/// Adds light that the path's own ray hit.
template <class Listener>
HD inline void add_emitted(PathState& path, Rgb light, Listener& listener) {
    listener.emitted(path, light);
    path.radiance += light;
}

/// Adds the light of the environment for a ray that hit nothing.
template <Features kFeatures, class Listener>
HD INLINE_ON_DEVICE void add_background(const PathJob& job, PathState& path, Listener& listener) {
    const LightSetView& lights = scene_of<kFeatures>(job, path.pixel).lights;
    Rgb light = {0, 0, 0};
    if (lights.has_environment() && !(path.depth == 0 && job.picture.hides_background(path.origin))) {
        const EnvironmentHit seen = find_environment<LightChoice<kFeatures>>(lights, context_before<kFeatures>(path),
                                                                             path.direction, path.bsdf_pdf > 0);
        if (!listener.removes_emission(path, environment_point(path.direction), seen.pdf)) {
            light = emitted_light(job.settings, path, seen.radiance, seen.pdf);
        }
    }
    add_emitted(path, light, listener);
}

/// Adds the emission of the surface that the ray hit.
template <Features kFeatures, class Listener>
HD INLINE_ON_DEVICE void add_surface_emission(const PathJob& job, PathState& path, const Hit& hit,
                                              const Surface& surface, Listener& listener) {
    Rgb light = {0, 0, 0};
    if (!is_black(surface.emission)) {
        constexpr bool kMoves = (kFeatures & kMoving) != 0;
        const float light_pdf = path.bsdf_pdf > 0
                                    ? pdf_direct<LightChoice<kFeatures>>(scene_of<kFeatures>(job, path.pixel), kMoves,
                                                                         context_before<kFeatures>(path), surface)
                                    : 0.0f;
        if (!listener.removes_emission(path, {hit.instance, hit.primitive, hit.u, hit.v}, light_pdf)) {
            light = emitted_light(job.settings, path, surface.emission, light_pdf);
        }
    }
    add_emitted(path, light, listener);
}

/// Returns the nested solids that hold a ray from the path's vertex along `wi`.
template <class Vertex>
HD inline InteriorList interior_towards(const SceneView& scene, const PathState& path, const Vertex& vertex, Vec3 wi) {
    if (!scene.nesting.is_there() || vertex.stays(wi)) return path.interior;
    return solids_behind(scene, path.interior, vertex.triangle().instance);
}

/// Returns whether media absorb and scatter light. Code for them also serves scenes that have thin walls alone.
template <Features kFeatures>
HD inline bool has_medium(const SceneView& scene) {
    if constexpr (Medium<kFeatures>::kIsVacuum) {
        return false;
    } else {
        return Medium<kFeatures>::is_in(scene);
    }
}

/// Dims the light of a sample by the nested solid that holds the vertex, if media do not, or else by the layers and
/// coloured solids on the way.
template <Features kFeatures, class Vertex>
HD inline void dim_by_solids(const SceneView& scene, const PathState& path, const Vertex& vertex, LightSample& light) {
    bool is_within = false; // nested solids, by which light is then absorbed
    if constexpr ((kFeatures & kNested) != 0) {
        const InteriorList around = interior_towards(scene, path, vertex, light.wi);
        is_within = around.top() != 0;
        if (!has_medium<kFeatures>(scene) && is_within)
            light.radiance = light.radiance * transmittance_within(scene, around, light.distance);
    }
    if constexpr ((kFeatures & kStacked) != 0) {
        if (!is_within) {
            light.radiance = light.radiance *
                             transmittance_to_light<variant_of(kFeatures)>(scene, vertex.triangle(), light, path.time);
        }
    }
}

/// Samples one point of one light for the vertex, by its `context`. Returns whether `shadow` must be traced.
template <Features kFeatures, class Vertex, class Numbers, class Listener>
HD INLINE_ON_DEVICE bool sample_direct(const PathJob& job, const PathState& path, const Vertex& vertex,
                                       const LightContext& context, const Numbers& numbers, ShadowRay& shadow,
                                       Listener& listener) {
    const SceneView& scene = scene_of<kFeatures>(job, path.pixel);
    const PathSettings& settings = job.settings;
    if (settings.strategy == LightStrategy::BsdfOnly || vertex.scatters_by_delta_alone()) return false;
    if (!counts(settings.light, path.rough_depth + 1)) return false;
    LightSample light;
    constexpr bool kMoves = (kFeatures & kMoving) != 0;
    constexpr EmitterVariant kEmitters = emitter_variant(variant_of(kFeatures));
    const SampleBits u = numbers.light(settings, path);
    if (!draw_direct<kEmitters, LightChoice<kFeatures>>(scene, kMoves, context, u, light)) {
        return false;
    }
    const BsdfValue scattered = vertex.evaluate(light.wi);
    if (is_black(scattered.f)) return false;
    if ((kFeatures & kAlpha) != 0 && scene.any_alpha != 0) {
        const SampleKey of_sample = sample_key<kFeatures>(job, path.pixel, path.sample);
        if (is_hole(scene, light, coin_key(of_sample, path.depth, true))) return false;
    }
    float weight = 1;
    if (!light.is_delta && settings.strategy == LightStrategy::Mis) {
        weight = power_heuristic(light.pdf, scattered.pdf);
    }
    dim_by_solids<kFeatures>(scene, path, vertex, light);
    Rgb arriving = (weight / light.pdf) * light.radiance;
    const Ray ray = vertex.ray_to(light, kMoves ? emitter_error_at(scene, light, path.time) : 0.0f);
    uint32_t scatterings = path.depth + 1;
    if constexpr (!Medium<kFeatures>::kIsVacuum) {
        if (job.passes_thin_walls) {
            const PassedWalls walls = pass_thin_walls(scene, ray);
            scatterings += walls.count;
            // A path that meets the light by itself is scattered by each wall and must not become deeper than allowed.
            if (is_black(walls.transmittance) || scatterings > settings.max_depth) return false;
            arriving = walls.transmittance * arriving;
        }
        if (has_medium<kFeatures>(scene)) {
            const InteriorList around = interior_towards(scene, path, vertex, light.wi);
            const Rgb transmittance = Medium<kFeatures>(scene).transmittance(around, ray);
            if (is_black(transmittance)) return false;
            arriving = transmittance * arriving;
        }
    }
    shadow.contribution = clamp_contribution(settings, scatterings, weight, path.throughput * scattered.f * arriving);
    shadow.origin = ray.origin;
    shadow.direction = ray.direction;
    shadow.t_max = ray.t_max;
    shadow.start = vertex.triangle();
    shadow.target = {light.instance, light.primitive};
    listener.direct(path, vertex, light.wi, shadow);
    return true;
}

/// Returns the probability that Russian roulette lets a path go on, for the largest channel of its throughput.
template <class T>
HD inline T survival_probability(Roulette roulette, T throughput) {
    if (roulette == Roulette::Throughput) return throughput;
    const T fourth = sqrt(sqrt(throughput));
    return roulette == Roulette::FourthRoot ? fourth : fourth * sqrt(sqrt(fourth));
}

/// Samples the direction in which the path continues. Returns false if it ends here.
template <class Vertex, class Numbers, class Listener>
HD INLINE_ON_DEVICE bool sample_scattering(const PathSettings& settings, PathState& path, const Vertex& vertex,
                                           const Numbers& numbers, Listener& listener) {
    const float lobe = vertex.draws_lobe() ? listener.chosen_lobe(path, numbers.lobe(settings, path)) : 0.5f;
    const BsdfSample sample = vertex.sample(lobe, numbers.direction(settings, path));
    if (!(sample.pdf > 0)) return false;
    const Vec3 wi = sample.wi;
    path.throughput = path.throughput * sample.weight;
    path.bsdf_pdf = sample.is_delta() ? 0.0f : sample.pdf;
    path.origin = vertex.origin_towards(wi);
    path.direction = wi;
    path.start = vertex.triangle();
    path.rough_depth += sample.is_delta() ? 0 : 1;
    if (settings.light == PathLight::Direct && path.rough_depth > 1) return false; // nothing further would count
    const uint32_t depth = path.depth + 1;
    if (may_end_by_chance(settings, depth)) {
        float survival = survival_probability(settings.roulette, max_component(path.throughput));
        if (sample.is_delta()) survival = survival_after_delta(depth - path.rough_depth, survival);
        if (survival < 1) {
            if (!(numbers.roulette(settings, path) < survival)) return false;
            path.throughput = (1.0f / survival) * path.throughput;
        }
    }
    path.depth = depth;
    listener.scattered(path, vertex, sample);
    return listener.goes_on(path);
}

/// Returns whether next-event estimation has found all that the path's next ray could add.
HD inline bool has_found_all(const PathJob& job, const PathState& path) {
    return job.ends_by_nee && path.depth >= job.settings.max_depth && path.bsdf_pdf > 0;
}

/// Width in metres of what the path's ray stands for at the hit; 0 if textures are not filtered. A sampled direction
/// stands for the solid angle 1 / pdf, of which a part is taken, because neighbours in space and time share their
/// samples. A mirrored ray goes on with the cone that arrived.
///
/// Source: as for textured_factor.h; Boksansky et al., "Improved Shader and Texture Level of Detail Using Ray Cones",
/// JCGT 10(1), 2021, widen a cone by the roughness instead.
template <Features kFeatures>
HD inline float cone_width(const PathJob& job, const PathState& path, float distance) {
    if constexpr ((kFeatures & kMipMapped) == 0) return 0;
    if (job.settings.mip_maps != MipMaps::On) return 0;
    constexpr float kShare = 0.25f;
    const bool is_tall = (kFeatures & kBatched) != 0 && job.picture.batch.is_there();
    const float seen = is_tall ? job.picture.batch.camera_of(path.pixel).pixel_width(distance)
                               : job.picture.camera.pixel_width(distance);
    if (path.depth == 0) return seen;
    if (path.bsdf_pdf > 0) return max(seen, kShare * (path.passed + distance) / sqrt(path.bsdf_pdf));
    return seen - path.bsdf_pdf;
}

/// Returns the surface that the path's ray hit, at the time of the ray.
template <Features kFeatures>
HD INLINE_ON_DEVICE Surface make_vertex(const SceneView& scene, const PathState& path, const Hit& hit,
                                        float cone_width) {
    constexpr bool kMoves = (kFeatures & kMoving) != 0;
    const MovedHit moved(scene, hit, kMoves ? path.time : kAtRest);
    Surface surface = make_surface<variant_of(kFeatures)>(
        scene, hit, kMoves ? moved.back(path.direction) : path.direction, cone_width);
    if (kMoves) moved.move(surface);
    return surface;
}

/// Shades a vertex in a medium, which the path's ray reached before any surface.
template <Features kFeatures, class Vertex, class Numbers, class Listener>
HD INLINE_ON_DEVICE bool shade_in_medium(const PathJob& job, PathState& path, const Vertex& vertex,
                                         const Numbers& numbers, ShadowRay& shadow, bool& has_shadow_ray,
                                         Listener& listener) {
    if (path.depth == 0) listener.emitted(path, {0, 0, 0}); // the ray reaches no emitter
    if (path.depth >= job.settings.max_depth) return false;
    has_shadow_ray =
        sample_direct<kFeatures>(job, path, vertex, vertex.light_context(path.time), numbers, shadow, listener);
    path.normal = {0, 0, 0};
    path.passed = 0;
    return sample_scattering(job.settings, path, vertex, numbers, listener) && !has_found_all(job, path);
}

/// Follows the path to a surface among nested solids: which of them hold it there, what they absorb on the way, and
/// the surface's interface. Returns whether solids are nested. If `has_flown`, media have absorbed already, and with
/// them the solids that fill them, but none without a rank.
HD_CALL inline bool reach_nested_solid(const SceneView& scene, PathState& path, const Hit& hit, Surface& surface,
                                       bool has_flown) {
    if (!scene.nesting.is_there()) return false;
    const bool enters = dot(path.direction, surface.geometric_normal) < 0;
    path.interior = solids_before(scene, path.interior, hit.instance, enters);
    nest_surface(scene, path.interior, surface);
    if (has_flown && path.interior.top() != 0) return true;
    const Rgb passed = transmittance_to_surface(scene, path.interior, path.start, path.direction, hit, path.time);
    path.throughput = path.throughput * passed;
    return true;
}

/// State of a path before a vertex at which it may go straight through a thin wall.
struct StraightPass {
    Vec3 direction, normal;
    float bsdf_pdf, passed;

    /// Returns whether `path` has gone straight through `surface`.
    HD bool is_that_of(const PathState& path, const SceneView& scene, const Surface& surface) const {
        return scene.instances[surface.triangle.instance].is_thin_wall != 0 && !(path.bsdf_pdf > 0) &&
               !surface.same_side(-direction, path.direction);
    }
    /// Lets `path` go on as if there were no wall.
    HD void restore(PathState& path) const {
        path.direction = direction;
        path.normal = normal;
        path.bsdf_pdf = bsdf_pdf;
        path.passed = passed;
    }
};

/// Shades the result of the path's ray: `hit`, or a miss if hit.instance is kNoHit. Returns whether the path
/// continues; `has_shadow_ray` says whether `shadow` was written. `numbers` is DrawOnDemand or DrawnNumbers.
template <Features kFeatures, class Numbers, class Listener>
HD INLINE_ON_DEVICE bool shade_vertex(const PathJob& job, PathState& path, const Hit& hit, const Numbers& numbers,
                                      ShadowRay& shadow, bool& has_shadow_ray, Listener& listener) {
    const SceneView& scene = scene_of<kFeatures>(job, path.pixel);
    has_shadow_ray = false;
    constexpr bool kIsVacuum = Medium<kFeatures>::kIsVacuum;
    [[maybe_unused]] typename Medium<kFeatures>::Vertex in_medium;
    [[maybe_unused]] bool scatters = false;
    if constexpr (!kIsVacuum) {
        scatters = has_medium<kFeatures>(scene) && Medium<kFeatures>(scene).scatters(job, path, hit, in_medium);
        if (scatters && (path.depth > 0 || hit.instance == kNoHit)) {
            listener.missed(path);
            return shade_in_medium<kFeatures>(job, path, in_medium, numbers, shadow, has_shadow_ray, listener);
        }
    }
    if (hit.instance == kNoHit) {
        listener.missed(path);
        add_background<kFeatures>(job, path, listener);
        return false;
    }
    const float width = cone_width<kFeatures>(job, path, hit.t);
    Surface surface = make_vertex<kFeatures>(scene, path, hit, width);
    if constexpr (!kIsVacuum) {
        if (scatters) { // the camera's layers show the surface behind the medium
            listener.vertex(path, hit, surface);
            return shade_in_medium<kFeatures>(job, path, in_medium, numbers, shadow, has_shadow_ray, listener);
        }
    }
    bool is_within = false;
    if constexpr ((kFeatures & kNested) != 0) {
        is_within = reach_nested_solid(scene, path, hit, surface, has_medium<kFeatures>(scene));
    }
    if constexpr ((kFeatures & kStacked) != 0) {
        if (!is_within) {
            path.throughput = path.throughput * transmittance_to_hit<variant_of(kFeatures)>(
                                                    scene, path.start, path.direction, hit, path.time);
        }
    }
    if constexpr ((kFeatures & kStacked) != 0) follow_channel(path.throughput, surface.bsdf);
    listener.vertex(path, hit, surface);
    add_surface_emission<kFeatures>(job, path, hit, surface, listener);
    if (surface.is_unlit || path.depth >= job.settings.max_depth) return false;
    const SurfaceVertexOf<variant_of(kFeatures)> vertex = {{surface, -path.direction}};
    const LightContext context = vertex.light_context(path.time);
    has_shadow_ray = listener.samples_direct(path, hit, surface) &&
                     sample_direct<kFeatures>(job, path, vertex, context, numbers, shadow, listener);
    const StraightPass straight = {path.direction, path.normal, path.bsdf_pdf, path.passed + hit.t};
    if constexpr (LightChoice<kFeatures>::kReadsNormal) path.normal = context.normal;
    bool goes_on = sample_scattering(job.settings, path, vertex, numbers, listener);
    if constexpr (!kIsVacuum) {
        path.passed = 0;
        if (job.passes_thin_walls && straight.is_that_of(path, scene, surface)) straight.restore(path);
    }
    goes_on = goes_on && !has_found_all(job, path);
    if constexpr ((kFeatures & kNested) != 0) path.interior = interior_towards(scene, path, vertex, path.direction);
    if ((kFeatures & kMipMapped) != 0 && !(path.bsdf_pdf > 0)) path.bsdf_pdf = -width;
    return goes_on;
}

} // namespace pertev
