#pragma once

// The overture: records are made in rounds before a picture has samples. A round traces a path from each pixel of a
// grid, which gets finer in each round. Where paths find too little, the points become the next records, in grid
// order. Points of one round are at least a grid step apart, so few of their records cover each other's points.
//
// Source: Ward, Rubinstein, Clear 1988, section 3, has the pass before the picture. Rounds replace the creation of
// one record at a time, so that many are made at once, in an order that does not depend on the device.

#include <cstdint>

#include "integrators/irradiance_cache/cache_memory.h"
#include "integrators/irradiance_cache/lookup_stages.h"
#include "integrators/subpaths/particle_stages.h"

namespace pertev {

inline constexpr uint32_t kOvertureSteps[] = {64, 32, 16, 8, 4, 2, 1, 1, 1}; // pixels, per round
inline constexpr uint32_t kOvertureRounds = sizeof(kOvertureSteps) / sizeof(kOvertureSteps[0]);
inline constexpr uint32_t kOvertureSeed = 0x6a09e667u,
                          kHemisphereSeed = 0xbb67ae85u; // seeds, combined with the picture's own

struct OvertureGrid {
    uint32_t step, columns, rows, width;

    HD uint32_t count() const { return columns * rows; }
    HD uint32_t pixel(uint32_t number) const {
        const uint32_t x = number % columns * step + step / 2, y = number / columns * step + step / 2;
        return y * width + x;
    }
};
inline OvertureGrid make_overture_grid(uint32_t round, uint32_t width, uint32_t height) {
    const uint32_t step = kOvertureSteps[round], half = step / 2;
    const auto along = [&](uint32_t pixels) { return pixels > half ? (pixels - half + step - 1) / step : 0; };
    return {step, along(width), along(height), width};
}

/// The stage that starts paths 0, 1, ... at the grid's indices `first`, first + 1, ...; no record is requested yet.
struct BeginSeekers {
    SubpathScene scene;
    SubpathsView subpaths;
    CacheSubpathsView cache;
    OvertureGrid grid;
    RecordSite* sites;
    uint32_t round, first;

    HD void operator()(uint32_t i) const {
        SubpathState state = {};
        state.pixel = grid.pixel(first + i);
        state.sample = round;
        state.throughput = {1, 1, 1};
        const SampleKey key = {state.pixel, state.sample, scene.settings.seed};
        const Ray ray = scene.picture.camera.ray(state.pixel, scene.settings.sampler, key);
        subpaths.states[i] = state;
        subpaths.queue_ray(i, i, ray, {}, coin_key(key, 0, false), 0);
        cache.store_cache_state(i, {{1, 1, 1}, 0});
        cache.store_path(i, {1, 1, 1});
        cache.distances[i] = 0;
        cache.aims[i] = SubpathAim::Seek;
        sites[first + i] = {}; // written completely, because the host reads all of it
    }
};

} // namespace pertev
