#pragma once

// Stages of camera subpaths. A subpath continues at mirrors, smooth glass and glossy lobes as in path tracing. At a
// diffuse surface the light
//   L D            is sampled by a shadow ray,
//   L S+ D         is looked up in the caustic map,
//   all other      is looked up in the global map too; or, with final gathering, found by continuing once to the next
//                  diffuse surface, where all of it is looked up. If that is nearer than the radius, the subpath
//                  continues once more, because a map blurs nearby detail.
// In a medium, L M is sampled by a shadow ray, L S+ M of lights without size is looked up (medium_photons.h), and all
// other light is found by continuing as in path tracing. Maps of surfaces are thus all that blurs: flights in
// homogeneous media are cheap, and a map of all photons in them would need many to be as smooth.
// Each light path is found in exactly one of these ways. Where a subpath ends, an extra ray looks for emitters,
// because a shadow ray finds the strong light of a close emitter with a low density, which would give bright spots
// (Veach 1997, section 9.2). It is seldom traced if the emitter of the shadow ray is far. If the subpath continues by
// glossy lobes only, the next ray does that: emitters and sky count for all lobes there, and light behind them for
// the glossy ones.
//
// Source: Jensen, "Global Illumination using Photon Maps", 1996, section 5.

#include <type_traits>

#include "integrators/photon_map/estimate_radiance.h"
#include "integrators/photon_map/medium_photons.h"
#include "integrators/subpaths/particle_stages.h"
#include "shading/power_heuristic.h"

namespace pertev {

inline constexpr uint32_t kSearchesEmitters = 2;  // mark in GatherView::marks of a subpath that only looks for
                                                  // emitters
inline constexpr uint32_t kSeesEmittersWhole = 4; // mark, combined with others: except for emitters and sky that
                                                  // the ray hits, the throughput is GatherState::past_mirrors
inline constexpr uint32_t kNumberOfSearch = 2;    // index among a vertex's choices: whether a ray looks for
                                                  // emitters
inline constexpr float kMinSearchChance = 0.125f; // minimum probability of that ray
inline constexpr float kSearchWithin = 4.0f;      // the ray's probability is 1 if an emitter's area exceeds 1/4 of the
                                                  // squared distance

/// The stage that starts camera subpaths 0, 1, ... of a pass.
struct BeginGather {
    BeginCameraSubpaths begin;
    GatherView gather;

    HD void operator()(uint32_t i) const {
        begin(i);
        gather.store_gather_state(i, {{1, 1, 1}, 0});
        gather.marks[i] = 0;
    }
};

/// The part of the stage for media.
struct GatherInMedia {
    PhotonMapView in_media; // medium_photons.h
};
struct GatherInVacuum {};

/// Returns the part `of` of a throughput after a flight that has changed the throughput from `before` to `after`.
HD inline Rgb part_after_flight(Rgb of, Rgb before, Rgb after) {
    const auto part = [](float x, float whole, float left) { return whole > 0 ? x / whole * left : 0.0f; };
    return {part(of.r, before.r, after.r), part(of.g, before.g, after.g), part(of.b, before.b, after.b)};
}

/// The stage that shades hits of camera subpaths and, with kInMedia in a scene with media, their scatterings there.
/// `Choice` selects lights (shading/light_set.h).
template <ShadingVariant kVariant, bool kInMedia = false, class Choice = ChosenByPower>
struct ShadeGather : std::conditional_t<kInMedia, GatherInMedia, GatherInVacuum> {
    SubpathScene scene;
    SubpathsView subpaths;
    GatherView gather;
    FilmView film;
    PhotonGather how;
    float near; // metres; a surface so near to the previous one is not used for a lookup
    uint32_t round;

    HD INLINE_ON_DEVICE void operator()(uint32_t i) const {
        const PictureView& picture = scene.picture;
        const uint32_t subpath = subpaths.owners[round % 2][i];
        const Ray ray = load_ray(subpaths.rays[round % 2] + i);
        const Hit hit = subpaths.hits().load(i);
        SubpathState state = subpaths.states[subpath];
        GatherState gather_state = gather.gather_state_of(subpath);
        const bool searches_emitters = gather.marks[subpath] == kSearchesEmitters;
        const bool sees_emitters_whole = (gather.marks[subpath] & kSeesEmittersWhole) != 0;
        InteriorList list;
        if constexpr (kInMedia) {
            list = state.depth() == 0 ? picture.camera.interior : subpaths.load_interior(subpath);
            const SampleKey key = {state.pixel, state.sample, scene.settings.seed};
            const Rgb before = state.throughput;
            const SubpathFlight flight = fly(scene, key, state.depth(), ray, hit, false, list, state.throughput);
            gather_state.past_mirrors = part_after_flight(gather_state.past_mirrors, before, state.throughput);
            if (flight.is_scattered) {
                if (state.depth() == 0) add_behind_medium<kVariant>(picture, film, state, ray, hit);
                if (searches_emitters) return; // photons have that light
                if (sees_emitters_whole) state.throughput = gather_state.past_mirrors;
                return shade_in_medium({flight.point, ray.direction, flight.share}, subpath, state, key, list);
            }
        }
        if (hit.instance == kNoHit) {
            if (!searches_emitters) add_background(state, gather_state, ray);
            return;
        }
        if (searches_emitters && light_of(picture.scene.lights, hit.instance, hit.primitive) == kNoLight) return;
        Surface surface = make_surface<kVariant>(picture.scene, hit, ray.direction);
        if constexpr (kInMedia) {
            const Rgb passed =
                reach_surface(picture.scene, list, subpaths.start_of(i, round), ray.direction, hit, surface);
            state.throughput = passed * state.throughput;
            gather_state.past_mirrors = passed * gather_state.past_mirrors;
        } else {
            arrive_through_solids<kVariant>(scene, subpaths, i, round, ray, hit, state.throughput,
                                            gather_state.past_mirrors);
        }
        if (state.depth() == 0) {
            add_seen(picture, film, state, ray, hit, surface, kInMedia ? state.throughput : Rgb{1, 1, 1});
        } else if (!is_black(surface.emission)) {
            const uint32_t light = light_of(picture.scene.lights, hit.instance, hit.primitive);
            const bool may_be_drawn = gather_state.pdf > 0 && light != kNoLight;
            if (sees_emitters_whole && !may_be_drawn) state.throughput = gather_state.past_mirrors;
            add_light(state, gather_state, surface.emission,
                      may_be_drawn ? pdf_of_hit(light, subpath, ray.origin, surface.position) : 0.0f);
        }
        const uint32_t depth = state.depth(), max_depth = scene.settings.max_depth;
        if (searches_emitters || surface.is_unlit || depth >= max_depth) return;
        if (sees_emitters_whole) {
            if (is_black(gather_state.past_mirrors)) return;
            state.throughput = gather_state.past_mirrors;
            gather.marks[subpath] &= ~kSeesEmittersWhole;
        }

        const bool is_diffuse = surface.bsdf.has(LobeClass::Diffuse), is_glossy = surface.bsdf.has(LobeClass::Glossy);
        const bool is_near = gather_state.pdf > 0 && hit.t < near;
        const bool turns = is_diffuse && how == PhotonGather::Final && (gather.marks[subpath] == 0 || is_near);
        const bool may_search = is_diffuse && !is_glossy && !turns;
        const Vertex vertex = {-ray.direction, is_diffuse, is_glossy,
                               turns,          may_search, {state.pixel, state.sample, scene.settings.seed}};
        const SurfaceEnd<kVariant> end = {surface};
        const float nearness = is_diffuse || is_glossy ? sample_direct_light(end, vertex, state, list) : 0.0f;
        if (is_diffuse && depth + 2 <= max_depth) {
            gather.store(atomic_add(&subpaths.counts->vertices, 1u),
                         {hit, ray.direction, state.throughput, state.pixel, depth, !turns});
        }
        continue_subpath(end, vertex, subpath, state, gather_state, nearness, list);
    }

private:
    struct Vertex {
        Vec3 wo;
        bool is_diffuse, is_glossy;
        bool turns;      // the subpath continues by diffuse lobes too
        bool may_search; // a ray may look for emitters only, by diffuse lobes
        SampleKey key;
    };

    /// Returns the density with which a shadow ray would have been sampled to the point of a light that the subpath
    /// hit.
    HD float pdf_of_hit(uint32_t light, uint32_t subpath, Vec3 from, Vec3 point) const {
        const LightContext before = light_context_before<Choice>(subpaths, subpath, from);
        return pdf_light_hit<Choice>(scene.picture.scene.lights, light, before, point);
    }
    /// Adds light that the subpath hit. `light_pdf` is the density with which a shadow ray would have been sampled
    /// there.
    HD void add_light(const SubpathState& state, const GatherState& gather_state, Rgb emission, float light_pdf) const {
        const float weight = light_pdf > 0 ? power_heuristic(gather_state.pdf, light_pdf) : 1.0f;
        add_radiance(film, state.pixel,
                     (gather_state.pdf > 0 ? weight * state.throughput : gather_state.past_mirrors) * emission);
    }
    HD void add_background(const SubpathState& state, const GatherState& gather_state, const Ray& ray) const {
        if (state.depth() == 0) {
            return add_seen_background(scene.picture, film, state, ray, kInMedia ? state.throughput : Rgb{1, 1, 1});
        }
        const LightSetView& lights = scene.picture.scene.lights;
        if (!lights.has_environment()) return;
        add_light(state, gather_state, environment_radiance(lights.environment, ray.direction),
                  gather_state.pdf > 0 ? pdf_environment(lights, ray.origin, ray.direction) : 0.0f);
    }

    /// Samples one point of one light, as path tracing does. Returns its nearness_of(), or 0.
    template <class End>
    HD INLINE_ON_DEVICE float sample_direct_light(const End& end, const Vertex& vertex, const SubpathState& state,
                                                  InteriorList list) const {
        const SceneView& view = scene.picture.scene;
        LightSample light;
        const SampleBits bits = sample_bits(scene.settings.sampler, vertex.key, light_group(state.depth()), Pair::Last);
        const LightContext context = end.light_context(vertex.wo);
        if (!sample_light<emitter_variant(kVariant), Choice>(view.lights, context, bits, light)) return 0;
        const float nearness = nearness_of(light);
        const BsdfValue all = end.scatter_camera(vertex.wo, light.wi);
        if (is_black(all.f)) return nearness;
        const uint32_t coin = coin_key(vertex.key, state.depth(), true);
        if (is_hole(view, light, coin)) return nearness;
        Connection connection;
        connection.ray = end.ray_to(light);
        connection.start = end.triangle();
        connection.target = triangle_of(light);
        connection.key = coin;
        if constexpr (kInMedia) {
            const Vec3 from = end.origin_towards(light.wi);
            const MediumTransmittance through_media =
                transmittance_of_connection(view, interior_towards(view, list, end, vertex.wo, light.wi), from,
                                            light.wi, light.distance, end.triangle(), connection.target);
            if (is_black(through_media.transmittance)) return nearness;
            light.radiance = light.radiance * through_media.transmittance;
        } else if constexpr (kVariant == ShadingVariant::General) {
            light.radiance = light.radiance * transmittance_to_light<kVariant>(view, end.triangle(), light);
        }
        connection.light = (1.0f / light.pdf) * (state.throughput * drawn_share(vertex, light, all) * light.radiance);
        subpaths.queue_connection(atomic_add(&subpaths.counts->connections, 1u), connection, state.pixel);
        return nearness;
    }
    /// Area of an emitter over the probability to sample it, relative to the squared distance; 0 for lights without
    /// position or size.
    HD static float nearness_of(const LightSample& light) {
        switch (light.kind()) {
        case SourceKind::Triangle:
            return 1.0f / (light.pdf * abs(dot(light.light_normal, light.wi)));
        case SourceKind::Punctual:
        case SourceKind::Environment:
            break;
        }
        return 0;
    }
    /// Part of the scattered light of a sampled light that the subpath's own ray does not find.
    HD Rgb drawn_share(const Vertex& vertex, const LightSample& light, const BsdfValue& all) const {
        switch (light.kind()) {
        case SourceKind::Punctual:
            return all.f;
        case SourceKind::Environment:
            if (vertex.may_search) return all.f;
            break;
        case SourceKind::Triangle:
            break;
        }
        return power_heuristic(light.pdf, all.pdf) * all.f;
    }

    /// Shades a scattering in a medium. Behind it the subpath finds all light, as behind a diffuse surface that turns.
    HD INLINE_ON_DEVICE void shade_in_medium(const MediumEnd& end, uint32_t subpath, SubpathState& state, SampleKey key,
                                             InteriorList list) const {
        const SubpathSettings& settings = scene.settings;
        if (is_black(state.throughput) || state.depth() >= settings.max_depth) return;
        const Vertex vertex = {-end.along, false, false, true, false, key};
        sample_direct_light(end, vertex, state, list);
        if constexpr (kInMedia) add_caustics(end, vertex.wo, state);
        const uint32_t choices = camera_group(state.depth(), kSubpathChoices);
        const ScatterDraw draw = end.draw(settings, key, camera_group(state.depth(), kSubpathScatter), choices);
        BsdfSample sample = end.sample_camera(vertex.wo, draw);
        if (!(sample.pdf > 0) || !end.survives(settings, key, choices, state.depth() + 1, sample)) return;
        gather.marks[subpath] = 1;
        state.throughput = state.throughput * sample.weight;
        store_light_normal<Choice>(subpaths, subpath, end, vertex.wo);
        if constexpr (kInMedia) subpaths.store_interior(subpath, list);
        queue_next(end, subpath, state, {state.throughput, sample.pdf}, sample.wi, key);
    }
    HD void add_caustics(const MediumEnd& end, Vec3 wo, const SubpathState& state) const {
        const uint32_t others = state.depth() + 1;
        if (others >= scene.settings.max_depth) return;
        const Rgb light = radiance_of_photons(this->in_media, end, wo, scene.settings.max_depth - others, film.invalid);
        if (!is_black(light)) add_radiance(film, state.pixel, state.throughput * light);
    }
    /// Continues or ends the subpath at a surface. `nearness` is the result of sample_direct_light.
    HD INLINE_ON_DEVICE void continue_subpath(const SurfaceEnd<kVariant>& end, const Vertex& vertex, uint32_t subpath,
                                              SubpathState& state, GatherState gather_state, float nearness,
                                              InteriorList list) const {
        const Surface& surface = end.surface;
        const SubpathSettings& settings = scene.settings;
        const uint32_t choices = camera_group(state.depth(), kSubpathChoices);
        const ScatterDraw draw =
            draw_scatter(settings, vertex.key, surface.bsdf, camera_group(state.depth(), kSubpathScatter), choices);
        BsdfSample sample = sample_surface<kVariant>(surface, vertex.wo, draw.lobe, draw.u);
        if (!(sample.pdf > 0)) return;
        Rgb past_mirrors = sample.weight; // factor for light beyond delta lobes from here on
        if (!sample.is_delta() && vertex.is_diffuse) {
            past_mirrors = {};
            if (vertex.is_glossy) {
                const Rgb glossy = evaluate_surface<kVariant>(surface, vertex.wo, sample.wi, only(LobeClass::Glossy)).f;
                past_mirrors = (1.0f / sample.pdf) * glossy;
            }
            if (vertex.may_search) {
                sample.weight = search_share(vertex, nearness, choices) * sample.weight;
                gather.marks[subpath] = kSearchesEmitters;
            } else if (!vertex.turns) {
                gather.marks[subpath] |= kSeesEmittersWhole;
            }
        }
        if (is_black(sample.weight)) return;
        const Rgb before = sample.weight;
        if (!survives(settings, vertex.key, choices, state.depth() + 1, sample)) return;
        const float made_up = max_component(sample.weight) / max_component(before);
        const Vec3 wi = sample.wi;
        gather_state = {sample.is_delta() ? made_up * (gather_state.past_mirrors * past_mirrors)
                                          : made_up * (state.throughput * past_mirrors),
                        sample.is_delta() ? 0.0f : sample.pdf};
        if (!sample.is_delta() && vertex.turns) gather.marks[subpath] = 1;
        state.throughput = state.throughput * sample.weight;
        store_light_normal<Choice>(subpaths, subpath, end, vertex.wo);
        if constexpr (kInMedia) {
            subpaths.store_interior(subpath, interior_towards(scene.picture.scene, list, end, vertex.wo, wi));
        }
        queue_next(end, subpath, state, gather_state, wi, vertex.key);
    }
    template <class End>
    HD INLINE_ON_DEVICE void queue_next(const End& end, uint32_t subpath, SubpathState& state,
                                        const GatherState& gather_state, Vec3 wi, SampleKey key) const {
        ++state.scatterings;
        subpaths.states[subpath] = state;
        gather.store_gather_state(subpath, gather_state);
        const Ray ray = {end.origin_towards(wi), 0, wi, kInfinity};
        subpaths.queue_ray(atomic_add(&subpaths.counts->next, 1u), subpath, ray, end.triangle(),
                           coin_key(key, state.depth(), false), round + 1);
    }

    /// Returns 0 if no ray looks for emitters; otherwise the factor that compensates for those that do not.
    HD float search_share(const Vertex& vertex, float nearness, uint32_t choices) const {
        if (scene.picture.scene.lights.triangle_count == 0) return 0;
        const float chance = clamp(kSearchWithin * nearness, kMinSearchChance, 1.0f);
        const float u = sample_1d(scene.settings.sampler, vertex.key, choices, kNumberOfSearch);
        return u < chance ? 1.0f / chance : 0.0f;
    }
};

} // namespace pertev
