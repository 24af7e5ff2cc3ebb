#pragma once

// Third step of a path: what happens where its ray has hit (or left the scene). Adds emission, asks for a shadow ray
// towards one light (next-event estimation), and scatters the path onwards. The same function on both devices.
//
// Source: Veach, "Robust Monte Carlo Methods for Light Transport Simulation", 1997, chapter 9 (multiple importance
// sampling, power heuristic) and 10.4 (Russian roulette).

#include "device_scene/moved_surface.h"
#include "device_scene/ray_origin.h"
#include "device_scene/surface.h"
#include "integrators/path/path_settings.h"
#include "integrators/path/path_state.h"
#include "integrators/path/vertex_events.h"
#include "integrators/path/vertex_numbers.h"
#include "render/film_view.h"
#include "render/first_hit.h"
#include "render/picture_view.h"
#include "shading/power_heuristic.h"

namespace pertev {

/// Whether light that was scattered `rough` times by other than delta lobes is asked for.
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

/// Contribution after the user's clamp, which spares light that was scattered at most once. It is for what a technique
/// found before its weight: `contribution` has been weighted by `weight`, so the limit is as well.
HD inline Rgb clamp_contribution(const PathSettings& settings, uint32_t scatterings, float weight, Rgb contribution) {
    const float largest = max_component(contribution), limit = weight * settings.clamp;
    if (!(settings.clamp > 0) || scatterings <= 1 || !(largest > limit)) return contribution;
    return (limit / largest) * contribution;
}

/// Adds light that the path's own ray ran into. `light_pdf`: density with which next-event estimation at the previous
/// vertex would have drawn this direction, 1/sr; 0 for light that it cannot find.
HD inline void add_emission(const PathSettings& settings, PathState& path, Rgb emission, float light_pdf) {
    if (!counts(settings.light, path.rough_depth)) return;
    float weight = 1;
    if (path.bsdf_pdf > 0 && light_pdf > 0) {
        if (settings.strategy == LightStrategy::NeeOnly) return;
        if (settings.strategy == LightStrategy::Mis) weight = power_heuristic(path.bsdf_pdf, light_pdf);
    }
    path.radiance += clamp_contribution(settings, path.depth, weight, path.throughput * (weight * emission));
}

/// Draws one point of one light. True when `shadow` is to be traced. `splits_light`: shadow.diffuse is wanted;
/// `tells_bounce`: shadow.sent is, of a second vertex.
template <MaterialsKnown kKnown, MotionKnown kMotion, class Numbers, class Events>
HD INLINE_ON_DEVICE bool ask_for_light(const SceneView& scene, const PathSettings& settings, const PathState& path,
                                       const Surface& surface, Vec3 wo, const Numbers& numbers, bool splits_light,
                                       bool tells_bounce, ShadowRay& shadow, Events& events) {
    if (settings.strategy == LightStrategy::BsdfOnly || surface.bsdf.has_delta_only()) return false;
    if (!counts(settings.light, path.rough_depth + 1)) return false;
    LightSample light;
    const SampleBits u = numbers.light(settings, path);
    const bool moves = is_moving<kMotion>(scene);
    if (!draw_direct<has_textures(kKnown)>(scene, moves, surface.light_context(path.time), u, light)) return false;
    const BsdfValue scattered = surface.evaluate(wo, light.wi);
    if (is_black(scattered.f)) return false;
    if (kKnown != MaterialsKnown::PlainDiffuse && light.instance != kNoLight && scene.any_alpha != 0 &&
        !AcceptHit{scene, {}, {}, path_key(path, settings.seed, true)}.passes_alpha(light.instance, light.primitive,
                                                                                    light.b1, light.b2)) {
        return false; // a hole in the light
    }
    float weight = 1;
    if (!light.is_delta && settings.strategy == LightStrategy::Mis) {
        weight = power_heuristic(light.pdf, scattered.pdf);
    }
    shadow.contribution = clamp_contribution(settings, path.depth + 1, weight,
                                             path.throughput * scattered.f * ((weight / light.pdf) * light.radiance));
    if (splits_light) {
        shadow.diffuse =
            (path.depth == 0 ? surface.diffuse_share(wo, light.wi) : path.first_diffuse) * shadow.contribution;
    }
    if (tells_bounce) shadow.sent = surface.diffuse_share(wo, light.wi) * shadow.contribution;
    events.asks_for_light(surface, wo, light.wi);
    const float lamp_error = moves ? lamp_error_at(scene, light, path.time) : 0.0f;
    const Ray ray = ray_to_light(light, surface.position, surface.error, surface.geometric_normal, lamp_error);
    shadow.origin = ray.origin;
    shadow.direction = ray.direction;
    shadow.t_max = ray.t_max;
    shadow.target = {light.instance, light.primitive};
    return true;
}

HD inline float survival_probability(Roulette roulette, float throughput) {
    if (roulette == Roulette::Throughput) return throughput;
    const float fourth = sqrt(sqrt(throughput));
    return roulette == Roulette::FourthRoot ? fourth : fourth * sqrt(sqrt(fourth));
}

/// Draws where the path goes on. False when it ends here.
template <class Numbers, class Events>
HD INLINE_ON_DEVICE bool scatter(const PathSettings& settings, PathState& path, const Surface& surface, Vec3 wo,
                                 const Numbers& numbers, Events& events) {
    const float lobe = surface.bsdf.draws_lobe() ? numbers.lobe(settings, path) : 0.5f;
    const BsdfSample sample = surface.sample(wo, lobe, numbers.direction(settings, path));
    if (!(sample.pdf > 0)) return false;
    const Vec3 wi = sample.wi;
    events.goes_on(surface, wo, sample);

    path.throughput = path.throughput * sample.weight;
    path.bsdf_pdf = sample.is_delta() ? 0.0f : sample.pdf;
    path.origin = offset_ray_origin(surface.position, surface.error, surface.geometric_normal, wi);
    path.direction = wi;
    path.start = surface.triangle;
    path.rough_depth += sample.is_delta() ? 0 : 1;
    if (settings.light == PathLight::Direct && path.rough_depth > 1) return false; // nothing of it would count
    const uint32_t vertex = path.depth + 1;
    if (may_end_by_chance(settings, vertex)) {
        const float survival = survival_probability(settings.roulette, max_component(path.throughput));
        if (survival < 1) {
            if (!(numbers.roulette(settings, path) < survival)) return false;
            path.throughput = (1.0f / survival) * path.throughput;
        }
    }
    path.depth = vertex;
    return true;
}

/// The surface that a camera ray met, for a frame. Emission follows by itself, with what is returned: Gloss::passage.
HD inline float store_first_hit(const NoisyFrameView& frame, const PathState& path, const Hit& hit,
                                const Surface& surface, Vec3 camera_axis) {
    const Vec3 normal = surface.frame.normal;
    const float cosine = dot(normal, path.direction);
    const Vec3 seen = cosine > 0 ? -normal : normal;
    const Gloss gloss = surface.bsdf.gloss(abs(cosine));
    frame.place[path.pixel] = {float_of(hit.instance), float_of(hit.primitive), hit.u, hit.v};
    frame.normal[path.pixel] = {seen.x, seen.y, seen.z, dot(surface.position - path.origin, camera_axis)};
    frame.albedo[path.pixel] = {surface.albedo.r, surface.albedo.g, surface.albedo.b, gloss.alpha};
    frame.gloss[path.pixel] = {gloss.reflectance.r, gloss.reflectance.g, gloss.reflectance.b, kFarAway};
    return gloss.passage;
}

/// What a path's first bounce has met, before anything is added there. A place that nobody can share is none.
HD inline void begin_bounce(const FirstBounceView& left, const PathState& path, const Hit& hit, bool is_shared) {
    left.place[path.pixel] = {float_of(is_shared ? hit.instance : kNoHit), float_of(hit.primitive), hit.u, hit.v};
    left.way[path.pixel] = {path.throughput.r, path.throughput.g, path.throughput.b, path.bsdf_pdf};
    left.sent[path.pixel] = left.onwards[path.pixel] = {0, 0, 0, 0};
}
HD inline Rgb share_onwards(const FirstBounceView& left, uint32_t pixel) {
    const Float4 share = left.onwards[pixel];
    return {share.x, share.y, share.z};
}

HD inline void store_emission(const NoisyFrameView& frame, const PathState& path, float passage) {
    frame.emission[path.pixel] = {path.radiance.r, path.radiance.g, path.radiance.b, passage};
}

/// A camera ray that met nothing.
HD inline void store_no_hit(const NoisyFrameView& frame, uint32_t pixel) {
    frame.place[pixel] = {float_of(kNoHit), float_of(kNoHit), 0, 0};
    frame.normal[pixel] = {0, 0, 0, kFarAway};
    frame.albedo[pixel] = {0, 0, 0, 1};
    frame.gloss[pixel] = {0, 0, 0, kFarAway};
}

/// What the ray of `path` met: `hit`, or nothing when hit.instance is kNoHit. Returns whether the path goes on;
/// `wants_shadow` says whether `shadow` was written. Auxiliary channels of the first vertex go to `film`.
/// Where `kMayBeFrame` is false `film` is none of a noisy frame, and where `kMayLeave` is, none that leaves light to
/// ReSTIR: code for these would cost others registers, and so would code for a motion that is not there (`kMotion`).
/// `numbers`: DrawWhenAsked or DrawnNumbers. `events`: what is to be told of the vertex (vertex_events.h).
template <MaterialsKnown kKnown = MaterialsKnown::Nothing, bool kMayBeFrame = true, bool kMayLeave = true,
          MotionKnown kMotion = MotionKnown::Perhaps, class Numbers, class Events = NoEvents>
HD INLINE_ON_DEVICE bool shade_hit(const PictureView& picture, const PathSettings& settings, const FilmView& film,
                                   PathState& path, const Hit& hit, const Numbers& numbers, ShadowRay& shadow,
                                   bool& wants_shadow, Events&& events = Events()) {
    const SceneView& scene = picture.scene;
    const bool is_frame = kMayBeFrame && film.frame.is_there();
    const bool splits_light = kKnown == MaterialsKnown::Nothing && is_frame && film.frame.splits_light();
    const FirstBounceView& left = film.frame.first_bounce;
    const bool leaves_light = kMayLeave && is_frame && left.leaves_direct_light();
    const bool tells_bounce = leaves_light && left.tells_bounce();
    if (leaves_light && path.depth == 0) left.light[path.pixel] = {};
    if (tells_bounce && path.depth == 0) begin_bounce(left, path, {}, false);
    const Rgb radiance_before = path.radiance;
    wants_shadow = false;
    if (hit.instance == kNoHit) {
        if (path.depth == 0) add_no_first_hit(film, path.pixel, path.sample);
        if (is_frame && path.depth == 0) store_no_hit(film.frame, path.pixel);
        const bool is_hidden = picture.hide_background && path.depth == 0;
        if (scene.lights.has_environment() && !is_hidden) {
            const EnvironmentHit seen = find_environment(scene.lights, path.origin, path.direction, path.bsdf_pdf > 0);
            if (leaves_light && path.depth == 1 && seen.pdf > 0) {
                left.light[path.pixel] = place_in_environment(path.direction);
            } else {
                add_emission(settings, path, seen.radiance, seen.pdf);
            }
        }
        if (tells_bounce && path.depth > 1) {
            left.add_sent(path.pixel, share_onwards(left, path.pixel) * (path.radiance - radiance_before));
        }
        if (is_frame && path.depth == 0) store_emission(film.frame, path, 1);
        return false;
    }
    constexpr bool kMayMove = kMotion != MotionKnown::None;
    const bool moves = is_moving<kMotion>(scene);
    const MovedHit moved(scene, hit, kMayMove ? path.time : kAtRest);
    Surface surface = make_surface<kKnown>(scene, hit, kMayMove ? moved.back(path.direction) : path.direction);
    if (kMayMove) moved.move(surface);
    events.meets(surface, path.depth);
    float passage = 1;
    if (is_frame) {
        if (path.depth == 0) passage = store_first_hit(film.frame, path, hit, surface, picture.camera.axis);
        if (path.depth == 1) film.frame.gloss[path.pixel].w = hit.t;
    } else if (path.depth == 0) {
        add_first_hit(film, path.pixel, path.sample, {path.origin, path.direction}, hit, surface, picture, path.time);
    }
    if (!is_black(surface.emission)) {
        const float light_pdf = path.bsdf_pdf > 0 ? pdf_direct(scene, moves, {path.origin, path.time}, surface) : 0.0f;
        if (leaves_light && path.depth == 1 && light_pdf > 0) {
            left.light[path.pixel] = {hit.instance, hit.primitive, hit.u, hit.v};
        } else {
            add_emission(settings, path, surface.emission, light_pdf);
        }
    }
    if (is_frame && path.depth == 0) store_emission(film.frame, path, passage);
    if (tells_bounce && path.depth > 1) {
        left.add_sent(path.pixel, share_onwards(left, path.pixel) * (path.radiance - radiance_before));
    }
    if (surface.is_unlit || path.depth >= settings.max_depth) return false;
    const Vec3 wo = -path.direction;
    // With coat or sheen on top, what leaves it in one direction says little of another.
    const bool is_bounce = tells_bounce && path.depth == 1 && path.bsdf_pdf > 0 && !surface.bsdf.is_stacked;
    if (is_bounce) begin_bounce(left, path, hit, true);
    wants_shadow = !(leaves_light && path.depth == 0) &&
                   ask_for_light<kKnown, kMotion>(scene, settings, path, surface, wo, numbers, splits_light, is_bounce,
                                                  shadow, events);
    if (tells_bounce && wants_shadow && !is_bounce) {
        shadow.sent = share_onwards(left, path.pixel) * shadow.contribution;
    }
    const bool goes_on = scatter(settings, path, surface, wo, numbers, events);
    // Not by the lobe that was drawn: others send light that way, too, and light of glossy ones changes with the view.
    if (splits_light && goes_on && path.depth == 1) {
        path.first_diffuse = path.bsdf_pdf > 0 ? surface.diffuse_share(wo, path.direction) : Rgb{0, 0, 0};
    }
    if (is_bounce && goes_on && path.bsdf_pdf > 0) { // by a delta lobe nothing can be shared
        const Rgb share = surface.diffuse_share(wo, path.direction);
        left.onwards[path.pixel] = {share.r, share.g, share.b, 0};
    }
    return goes_on;
}

} // namespace pertev
