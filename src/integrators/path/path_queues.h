#pragma once

// Paths in flight on the GPU, as structures of arrays, and their shadow rays.
//
// Paths go round by round: a round traces one ray of every path in flight. Those that go on are written side by side to
// the front of a second set of arrays, which the next round reads, and those that have ended to its end, for the film.
// The next round begins new paths there, so that all rounds but the last few are full, and all that is read and written
// lies side by side. How many paths a round has only the device knows (RoundCounts).

#include <cstdint>

#include "device/list_places.h"
#include "device_scene/ray_queue.h"
#include "integrators/path/path_state.h"
#include "math/float4.h"

namespace pertev {

struct PathQueueView {
    Ray* rays;          // to trace next, endless; pixel and sample in place of where they begin and end
    Uint2* starts;      // RayQueueView's; with the keys, one array of both sets: only the tracer reads it
    uint32_t* keys;     // written where some surface is blended
    Float4* throughput; // rgb, bits of (depth | rough_depth << 16)
    Float4* radiance;   // rgb, bsdf_pdf; of a path that has ended rgb, bits of the pixel
    float* times;       // RayQueueView's, as the keys; null unless something moves while the shutter is open

    /// Of the rays at places 0, 1, ..., or back from `last`.
    RayQueueView query() const {
        return {.rays = rays, .starts = starts, .keys = keys, .times = times, .is_endless = true};
    }
    RayQueueView query_back(uint32_t last) const {
        return {.rays = rays + last,
                .starts = starts + last,
                .keys = keys + last,
                .times = times != nullptr ? times + last : nullptr,
                .step = -1,
                .is_endless = true};
    }

    /// Without `start`, which only the tracer needs.
    HD PathState load(uint32_t i) const {
        const Ray ray = load_ray(rays + i);
        const Float4 t = throughput[i], r = radiance[i];
        const uint32_t depths = bits_of(t.w);
        PathState path;
        path.origin = ray.origin;
        path.direction = ray.direction;
        path.throughput = {t.x, t.y, t.z};
        path.radiance = {r.x, r.y, r.z};
        path.bsdf_pdf = r.w;
        path.pixel = bits_of(ray.t_min);
        path.sample = bits_of(ray.t_max);
        path.depth = depths & 0xffffu;
        path.rough_depth = depths >> 16;
        return path;
    }
    /// `any_alpha`: the coin's key is wanted.
    HD void store(uint32_t i, const PathState& path, uint32_t seed, bool any_alpha) const {
        store_ray(rays + i, {path.origin, float_of(path.pixel), path.direction, float_of(path.sample)});
        starts[i] = {path.start.instance, path.start.primitive};
        if (any_alpha) keys[i] = path_key(path, seed, false);
        throughput[i] = {path.throughput.r, path.throughput.g, path.throughput.b,
                         float_of(path.depth | (path.rough_depth << 16))};
        radiance[i] = {path.radiance.r, path.radiance.g, path.radiance.b, path.bsdf_pdf};
    }
    /// A path that has ended.
    HD void store_ended(uint32_t i, const PathState& path) const {
        radiance[i] = {path.radiance.r, path.radiance.g, path.radiance.b, float_of(path.pixel)};
    }
    HD uint32_t load_pixel(uint32_t i) const { return bits_of(radiance[i].w); }
    HD Rgb load_radiance(uint32_t i) const { return {radiance[i].x, radiance[i].y, radiance[i].z}; }
    /// Keeps what lies beside it.
    HD void add_radiance(uint32_t i, Rgb value) const {
        const Float4 r = radiance[i];
        radiance[i] = {r.x + value.r, r.y + value.g, r.z + value.b, r.w};
    }
};

struct ShadowQueueView {
    Ray* rays;
    Uint2 *starts, *targets;
    uint32_t* keys;       // then what the ray met
    Float4* contribution; // rgb, bits of the path's place in the next round's arrays
    float* times;         // as PathQueueView's

    RayQueueView query() const {
        return {.rays = rays, .starts = starts, .targets = targets, .keys = keys, .times = times};
    }

    HD void store(uint32_t i, const ShadowRay& ray, uint32_t path, uint32_t key) const {
        store_ray(rays + i, {ray.origin, 0.0f, ray.direction, ray.t_max});
        starts[i] = {ray.start.instance, ray.start.primitive};
        targets[i] = {ray.target.instance, ray.target.primitive};
        keys[i] = key;
        contribution[i] = {ray.contribution.r, ray.contribution.g, ray.contribution.b, float_of(path)};
    }
};

/// Of one round; on cache lines of its own, since kernels of two rounds go side by side.
struct alignas(128) RoundCounts {
    uint64_t first;       // number of the first fresh path's sample (BeginOrder::at)
    uint32_t going_on;    // paths from the round before, at the front
    uint32_t fresh;       // paths that begin in it, from the end on
    uint32_t active;      // both
    uint32_t shadows;     // rays that its vertices ask for
    uint32_t next, ended; // of the active paths, those that go on after it and those that do not
    uint32_t all_begun;   // 1: no path begins after it
    uint32_t taken[3];    // of its rays, by RayKind, what a tracer has taken from its pool
};

/// What the host knows of a round.
struct SeenCounts {
    uint32_t active, all_begun; // RoundCounts'
};

/// Where a vertex stores its path for the next round, or for the film, and its shadow ray.
struct RoundPlaces {
    uint32_t path, shadow;
};
using RoundLists = BlockLists<3>;

/// `last`: place of the first path that ends.
HD inline RoundPlaces take_places(const RoundLists& lists, RoundCounts& round, uint32_t last, bool is_there,
                                  bool goes_on, bool wants_shadow) {
    const bool ends = is_there && !goes_on;
    const ListPlaces<3> places = lists.take({&round.next, &round.ended, &round.shadows}, {goes_on, ends, wants_shadow});
    return {ends ? last - places.at[1] : places.at[0], places.at[2]};
}

/// Of all rounds of a render.
struct RenderCounts {
    uint64_t begun;            // samples of pixels; may pass how many are wanted
    uint64_t bounces, shadows; // rays
};

} // namespace pertev
