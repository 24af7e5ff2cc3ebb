#pragma once

// Stages of a pass's photons: emission from the lights; then, round by round, storage at diffuse hits and scattering.
// The maps need two kinds of particles:
//   global   leave the lights as all particles do (emit_particle.h); stored after a scattering by other than delta
//            lobes: L (D|G|S)* (D|G) S* D
//   caustic  are aimed at surfaces that mirror or refract (photon_targets.h); stored after scatterings by delta lobes
//            only: L S+ D
// Direct light is in neither map, because shadow rays find it. A scattering in a medium is one by other than delta
// lobes; there a caustic photon ends, and is stored if medium_photons.h needs it.
//
// Source: Jensen, "Global Illumination using Photon Maps", 1996, section 4.1.

#include "integrators/photon_map/gather_memory.h"
#include "integrators/photon_map/medium_photons.h"
#include "integrators/photon_map/photon_map_view.h"
#include "integrators/photon_map/photon_targets.h"
#include "render/film_view.h"

namespace pertev {

/// Power balance of photons in scenes without media, for tests: powers summed over the three colours, W.
struct PhotonEnergy {
    FixedSum emitted;
    FixedSum escaped;   // hit nothing
    FixedSum arrived;   // arrived at surfaces
    FixedSum left_none; // part of `arrived` that stored no photon; the maps contain the rest, over the chance to meet
                        // the surface
    FixedSum went_on;   // part of `arrived` that was scattered; the rest was absorbed
};

/// Mark in GatherView::marks of a caustic photon whose light no camera subpath can hit.
inline constexpr uint32_t kOfLightWithoutSize = 2;

/// Photons of a pass: paths [0, count) are global ones, [count, 2 count) caustic ones.
struct PhotonPass {
    uint32_t pass, count;
    PhotonTargetsView targets;
    StoredPhotonsView stored;
    uint64_t* invalid;    // number of photons that were dropped because their power was not finite
    PhotonEnergy* energy; // may be null

    HD bool is_caustic(uint32_t path) const { return path >= count; }
    /// A single sequence covers the photons of all passes.
    HD SampleKey key(uint32_t path, uint32_t seed) const {
        const uint64_t number = uint64_t(pass) * count + (is_caustic(path) ? path - count : path);
        return {static_cast<uint32_t>(number >> 32), static_cast<uint32_t>(number),
                seed ^ (is_caustic(path) ? 0x51ed270bu : 0x2545f491u)};
    }
    HD void add_energy(FixedSum PhotonEnergy::*of, Rgb power) const {
        if (energy != nullptr) atomic_add(&(energy->*of), to_fixed(power.r + power.g + power.b));
    }
};

/// The stage that starts photons `first`, first + 1, ... as subpaths 0, 1, ...
struct BeginPhotons {
    SubpathScene scene;
    SubpathsView subpaths;
    GatherView gather;
    PhotonPass pass;
    uint32_t first;

    HD void operator()(uint32_t i) const {
        const SubpathSettings& settings = scene.settings;
        const uint32_t path = first + i;
        const SampleKey key = pass.key(path, settings.seed);
        const SampleBits bits = sample_bits(settings.sampler, key, kGroupLight);
        const Vec2 direction = sample_2d(settings.sampler, key, kGroupLight, Pair::Last);
        const uint32_t coin = coin_key(key, 0, false);
        Particle particle;
        const bool leaves =
            pass.is_caustic(path)
                ? aim_particle(scene.picture.scene, pass.targets, scene.world, bits, direction, coin, particle)
                : emit_particle(scene.picture.scene, scene.world, bits, direction, coin, particle);
        if (!leaves) return;
        const bool has_media = scene.picture.scene.has_media != 0;
        if (has_media) begin_in_media(scene.picture.scene, subpaths, i, particle);
        SubpathState state = {};
        state.throughput = (1.0f / static_cast<float>(pass.count)) * particle.power;
        if (!(max_component(state.throughput) > 0)) return;
        if (!(max_component(state.throughput) <= kMaxSampleValue)) {
            atomic_add(pass.invalid, 1);
            return;
        }
        state.pixel = path;
        subpaths.states[i] = state;
        gather.marks[i] = has_media && pass.is_caustic(path) && particle.is_punctual ? kOfLightWithoutSize : 0;
        gather.store_index(i, 1);
        pass.add_energy(&PhotonEnergy::emitted, state.throughput);
        subpaths.queue_ray(atomic_add(&subpaths.counts->next, 1u), i, particle.ray, particle.start, coin, 0);
    }
};

/// The stage that shades hits of photons and, with kInMedia in a scene with media, their scatterings there.
template <ShadingVariant kVariant, bool kInMedia = false>
struct ShadePhotons {
    SubpathScene scene;
    SubpathsView subpaths;
    GatherView gather;
    PhotonPass pass;
    uint32_t round;

    HD INLINE_ON_DEVICE void operator()(uint32_t i) const {
        const Hit hit = subpaths.hits().load(i);
        const uint32_t subpath = subpaths.owners[round % 2][i];
        SubpathState state = subpaths.states[subpath];
        if constexpr (kInMedia) {
            shade_in_media(i, hit, subpath, state);
        } else {
            if (hit.instance == kNoHit) return pass.add_energy(&PhotonEnergy::escaped, state.throughput);
            const Ray ray = load_ray(subpaths.rays[round % 2] + i);
            arrive_through_solids<kVariant>(scene, subpaths, i, round, ray, hit, state.throughput);
            const Rgb arrived = state.throughput;
            pass.add_energy(&PhotonEnergy::arrived, arrived);
            const Surface surface = make_surface<kVariant>(scene.picture.scene, hit, ray.direction);
            if (state.depth() == 0) state.throughput = left_at(hit.t, ray.t_max) * state.throughput;
            shade_surface(surface, hit, ray.direction, subpath, state, arrived, {});
        }
    }

private:
    HD INLINE_ON_DEVICE void shade_in_media(uint32_t i, const Hit& hit, uint32_t subpath, SubpathState& state) const {
        const SceneView& view = scene.picture.scene;
        const Ray ray = load_ray(subpaths.rays[round % 2] + i);
        InteriorList list = subpaths.load_interior(subpath);
        const SampleKey key = pass.key(state.pixel, scene.settings.seed);
        const SubpathFlight flight =
            fly(scene, key, kGroupLight + state.depth(), ray, hit, false, list, state.throughput);
        const float left = state.depth() == 0 ? left_at(flight.distance, ray.t_max) : 1.0f;
        if (flight.is_scattered) {
            state.throughput = left * state.throughput;
            return scatter_in_medium({flight.point, ray.direction, flight.share}, subpath, state, key, list);
        }
        if (hit.instance == kNoHit) return pass.add_energy(&PhotonEnergy::escaped, state.throughput);
        Surface surface = make_surface<kVariant>(view, hit, ray.direction);
        const Rgb passed = reach_surface(view, list, subpaths.start_of(i, round), ray.direction, hit, surface);
        state.throughput = passed * state.throughput;
        const Rgb arrived = state.throughput;
        pass.add_energy(&PhotonEnergy::arrived, arrived);
        state.throughput = left * state.throughput;
        shade_surface(surface, hit, ray.direction, subpath, state, arrived, list);
    }
    /// Shades a surface at which the photon arrives along `direction`, with the power `arrived` before the end of a
    /// light's range; `list` has the solids that hold it there.
    HD INLINE_ON_DEVICE void shade_surface(const Surface& surface, const Hit& hit, Vec3 direction, uint32_t subpath,
                                           SubpathState& state, Rgb arrived, InteriorList list) const {
        const bool is_caustic = pass.is_caustic(state.pixel);
        const bool is_kept = state.depth() > 0 && (is_caustic || gather.marks[subpath] != 0) && !surface.is_unlit &&
                             surface.bsdf.has(LobeClass::Diffuse);
        if (!is_kept) pass.add_energy(&PhotonEnergy::left_none, arrived);
        if (surface.is_unlit || is_black(state.throughput)) return;
        if (is_kept) keep(surface, hit, subpath, state, -direction, is_caustic);
        if (state.depth() + 1 < scene.settings.max_depth && !(is_caustic && !surface.bsdf.has_delta())) {
            continue_subpath(surface, subpath, state, -direction, is_caustic, list);
        }
    }
    HD void keep(const Surface& surface, const Hit& hit, uint32_t subpath, const SubpathState& state, Vec3 wi,
                 bool is_caustic) const {
        // Camera subpaths carry radiance over the squared index (shading/lobes/bsdf_sample.h), photons carry power.
        Rgb power = (1.0f / gather.index_squared(subpath)) * state.throughput;
        const SceneView& view = scene.picture.scene;
        const uint32_t owner = owner_of(view, hit.instance);
        if (owner != 0) power = (1.0f / hit_probability(view, hit.instance, hit.primitive, hit.u, hit.v)) * power;
        if (!(max_component(power) <= kMaxSampleValue)) {
            atomic_add(pass.invalid, 1);
            return;
        }
        const Vec3 normal = surface.geometric_normal;
        pass.stored.add(
            {surface.position, wi, dot(normal, wi) < 0 ? -normal : normal, power, state.pixel, state.depth(), owner},
            is_caustic);
    }
    HD INLINE_ON_DEVICE void continue_subpath(const Surface& surface, uint32_t subpath, SubpathState& state, Vec3 wi,
                                              bool is_caustic, InteriorList list) const {
        const SubpathSettings& settings = scene.settings;
        const SampleKey key = pass.key(state.pixel, settings.seed);
        const uint32_t choices = particle_group(state.depth(), kSubpathChoices);
        const ScatterDraw draw =
            draw_scatter(settings, key, surface.bsdf, particle_group(state.depth(), kSubpathScatter), choices);
        BsdfSample sample = sample_particle<kVariant>(surface, wi, draw.lobe, draw.u);
        if (!(sample.pdf > 0) || (is_caustic && !sample.is_delta())) return;
        // Photons of similar power give the smoothest maps, so fewer photons continue where only a part is scattered
        // (Jensen 1996, section 4.1).
        if (!goes_on(max_component(sample.weight), key, choices, sample.weight)) return;
        if (!sample.is_delta()) gather.marks[subpath] = 1;
        if (sample.is_transmission) {
            gather.store_index(subpath, squared_index_beyond(surface, wi, gather.index_squared(subpath)));
        }
        const SurfaceEnd<kVariant> end = {surface};
        if constexpr (kInMedia) {
            subpaths.store_interior(subpath, interior_towards(scene.picture.scene, list, end, wi, sample.wi));
        }
        queue_next(end, subpath, state, sample.wi, sample.weight, key);
    }
    /// Stores the caustic photons that medium_photons.h needs.
    HD void keep_in_medium(const MediumEnd& end, uint32_t subpath, const SubpathState& state) const {
        if (state.depth() == 0 || gather.marks[subpath] != kOfLightWithoutSize) return;
        const uint32_t medium = end.point.instance;
        const Rgb power = (1.0f / gather.index_squared(subpath)) *
                          over_scattering(state.throughput, medium_of(scene.picture.scene, medium).sigma_s);
        if (!(max_component(power) <= kMaxSampleValue)) {
            atomic_add(pass.invalid, 1);
            return;
        }
        pass.stored.add_in_medium({end.position(), -end.along, {}, power, state.pixel, state.depth(), 0}, medium);
    }
    /// Scatters a global photon in a medium; a caustic one ends there.
    HD INLINE_ON_DEVICE void scatter_in_medium(const MediumEnd& end, uint32_t subpath, SubpathState& state,
                                               SampleKey key, InteriorList list) const {
        if (is_black(state.throughput)) return;
        if (pass.is_caustic(state.pixel)) return keep_in_medium(end, subpath, state);
        if (state.depth() + 1 >= scene.settings.max_depth) return;
        const uint32_t choices = particle_group(state.depth(), kSubpathChoices);
        const ScatterDraw draw = end.draw(scene.settings, key, particle_group(state.depth(), kSubpathScatter), choices);
        BsdfSample sample = end.sample_particle(-end.along, draw);
        if (!(sample.pdf > 0) || !goes_on(end.share, key, choices, sample.weight)) return;
        gather.marks[subpath] = 1;
        subpaths.store_interior(subpath, list);
        queue_next(end, subpath, state, sample.wi, sample.weight, key);
    }
    /// Russian roulette with the survival probability `chance`, for which `weight` compensates.
    HD bool goes_on(float chance, SampleKey key, uint32_t choices, Rgb& weight) const {
        if (!(chance > 0)) return false;
        if (!(chance < 1)) return true;
        if (!(sample_1d(scene.settings.sampler, key, choices, kNumberOfRoulette) < chance)) return false;
        weight = (1.0f / chance) * weight;
        return true;
    }
    template <class End>
    HD INLINE_ON_DEVICE void queue_next(const End& end, uint32_t subpath, SubpathState& state, Vec3 wo, Rgb weight,
                                        SampleKey key) const {
        state.throughput = state.throughput * weight;
        ++state.scatterings;
        subpaths.states[subpath] = state;
        pass.add_energy(&PhotonEnergy::went_on, state.throughput);
        const Ray ray = {end.origin_towards(wo), 0, wo, kInfinity};
        subpaths.queue_ray(atomic_add(&subpaths.counts->next, 1u), subpath, ray, end.triangle(),
                           coin_key(key, state.depth(), false), round + 1);
    }
};

} // namespace pertev
