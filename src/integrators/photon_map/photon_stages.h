#pragma once

// Stages of a pass's photons: emission from the lights; then, round by round, storage at diffuse hits and scattering.
// The maps need two kinds of particles:
//   global   leave the lights as all particles do (emit_particle.h); stored after a scattering by other than delta
//            lobes: L (D|G|S)* (D|G) S* D
//   caustic  are aimed at surfaces that mirror or refract (photon_targets.h); stored after scatterings by delta lobes
//            only: L S+ D
// Direct light is in neither map, because shadow rays find it.
//
// Source: Jensen, "Global Illumination using Photon Maps", 1996, section 4.1.

#include "integrators/photon_map/gather_memory.h"
#include "integrators/photon_map/photon_map_view.h"
#include "integrators/photon_map/photon_targets.h"
#include "integrators/subpaths/subpath_vertex.h"
#include "render/film_view.h"

namespace pertev {

/// Power balance of photons, for tests: powers summed over the three colours, W.
struct PhotonEnergy {
    FixedSum emitted;
    FixedSum escaped;   // hit nothing
    FixedSum arrived;   // arrived at surfaces
    FixedSum left_none; // part of `arrived` that stored no photon; the maps contain the rest
    FixedSum went_on;   // part of `arrived` that was scattered; the rest was absorbed
};

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
        SubpathState state = {};
        state.throughput = (1.0f / static_cast<float>(pass.count)) * particle.power;
        if (!(max_component(state.throughput) > 0)) return;
        if (!(max_component(state.throughput) <= kMaxSampleValue)) {
            atomic_add(pass.invalid, 1);
            return;
        }
        state.pixel = path;
        subpaths.states[i] = state;
        gather.marks[i] = 0;
        gather.store_index(i, 1);
        pass.add_energy(&PhotonEnergy::emitted, state.throughput);
        subpaths.queue_ray(atomic_add(&subpaths.counts->next, 1u), i, particle.ray, particle.start, coin, 0);
    }
};

/// The stage that shades hits of photons.
template <ShadingVariant kVariant>
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
        if (hit.instance == kNoHit) return pass.add_energy(&PhotonEnergy::escaped, state.throughput);
        const Ray ray = load_ray(subpaths.rays[round % 2] + i);
        arrive_through_solids<kVariant>(scene, subpaths, i, round, ray, hit, state.throughput);
        const Rgb arrived = state.throughput;
        pass.add_energy(&PhotonEnergy::arrived, arrived);
        const Surface surface = make_surface<kVariant>(scene.picture.scene, hit, ray.direction);
        if (state.depth() == 0) state.throughput = left_at(hit.t, ray.t_max) * state.throughput;
        const bool is_caustic = pass.is_caustic(state.pixel);
        const bool is_kept = state.depth() > 0 && (is_caustic || gather.marks[subpath] != 0) && !surface.is_unlit &&
                             surface.bsdf.has(LobeClass::Diffuse);
        if (!is_kept) pass.add_energy(&PhotonEnergy::left_none, arrived);
        if (surface.is_unlit || is_black(state.throughput)) return;
        if (is_kept) keep(surface, subpath, state, -ray.direction, is_caustic);
        if (state.depth() + 1 < scene.settings.max_depth && !(is_caustic && !surface.bsdf.has_delta())) {
            continue_subpath(surface, subpath, state, -ray.direction, is_caustic);
        }
    }

private:
    HD void keep(const Surface& surface, uint32_t subpath, const SubpathState& state, Vec3 wi, bool is_caustic) const {
        // Camera subpaths carry radiance over the squared index (shading/lobes/bsdf_sample.h), photons carry power.
        const Rgb power = (1.0f / gather.index_squared(subpath)) * state.throughput;
        if (!(max_component(power) <= kMaxSampleValue)) {
            atomic_add(pass.invalid, 1);
            return;
        }
        const Vec3 normal = surface.geometric_normal;
        pass.stored.add(
            {surface.position, wi, dot(normal, wi) < 0 ? -normal : normal, power, state.pixel, state.depth()},
            is_caustic);
    }
    HD INLINE_ON_DEVICE void continue_subpath(const Surface& surface, uint32_t subpath, SubpathState& state, Vec3 wi,
                                              bool is_caustic) const {
        const SubpathSettings& settings = scene.settings;
        const SampleKey key = pass.key(state.pixel, settings.seed);
        const uint32_t choices = particle_group(state.depth(), kSubpathChoices);
        const ScatterDraw draw =
            draw_scatter(settings, key, surface.bsdf, particle_group(state.depth(), kSubpathScatter), choices);
        BsdfSample sample = sample_particle<kVariant>(surface, wi, draw.lobe, draw.u);
        if (!(sample.pdf > 0) || (is_caustic && !sample.is_delta())) return;
        // Photons of similar power give the smoothest maps, so fewer photons continue where only a part is scattered
        // (Jensen 1996, section 4.1).
        const float chance = max_component(sample.weight);
        if (!(chance > 0)) return;
        if (chance < 1) {
            if (!(sample_1d(settings.sampler, key, choices, kNumberOfRoulette) < chance)) return;
            sample.weight = (1.0f / chance) * sample.weight;
        }
        if (!sample.is_delta()) gather.marks[subpath] = 1;
        if (sample.is_transmission) {
            gather.store_index(subpath, squared_index_beyond(surface, wi, gather.index_squared(subpath)));
        }
        state.throughput = state.throughput * sample.weight;
        ++state.scatterings;
        subpaths.states[subpath] = state;
        pass.add_energy(&PhotonEnergy::went_on, state.throughput);
        const Vec3 wo = sample.wi;
        const Ray ray = {offset_ray_origin(surface.position, surface.error, surface.geometric_normal, wo), 0, wo,
                         kInfinity};
        subpaths.queue_ray(atomic_add(&subpaths.counts->next, 1u), subpath, ray, surface.triangle,
                           coin_key(key, state.depth(), false), round + 1);
    }
};

} // namespace pertev
