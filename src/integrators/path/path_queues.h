#pragma once

// Paths in flight on the GPU and their shadow rays, as structures of arrays.
//
// Paths are processed in rounds: a round traces one ray of every path in flight. Paths that continue are compacted at
// the front of a second set of arrays, which the next round reads, and paths that end after their shadow ray at its
// end; the others that end go to the film at once. The next round starts new paths there, so that all rounds but the
// last few are full and all accesses are contiguous. Only the device knows the number of paths of a round
// (RoundCounts).

#include <cstdint>

#include "device/block_append.h"
#include "device/block_order.h"
#include "device_scene/ray_queue.h"
#include "integrators/path/generate_path.h"
#include "math/float4.h"

namespace pertev {

struct PathQueueView {
    Ray* rays;          // to trace next, endless; pixel and sample are stored in place of t_min and t_max
    Uint2* starts;      // the starts of RayQueueView
    uint32_t* keys;     // written if some surface is blended; one array for both sets, because only the tracer reads it
    Float4* throughput; // rgb, bits of (depth | rough_depth << 16)
    Float4* radiance;   // rgb, bsdf_pdf; for an ended path rgb, bits of the pixel
    float* times;       // the times of RayQueueView; null unless something moves while the shutter is open
    Uint2* interiors;   // PathState::interior; null unless solids are nested
    Vec3* normals;      // PathState::normal; null unless lights are selected by a tree
    float* passed;      // PathState::passed; null unless the scene has thin walls

    /// Query of the rays at slots 0, 1, ..., or of those from the camera, backwards from `last`.
    RayQueueView query() const {
        return {.rays = rays, .starts = starts, .keys = keys, .times = times, .is_endless = true};
    }
    RayQueueView query_back(uint32_t last) const {
        return {.rays = rays + last,
                .keys = keys + last,
                .times = times != nullptr ? times + last : nullptr,
                .step = -1,
                .is_endless = true};
    }

    /// Loads a path that begins, without its time: all but its ray is known.
    HD PathState load_begun(uint32_t i, const CameraRays& camera) const {
        const Ray ray = load_ray(rays + i);
        return begin_path(camera, bits_of(ray.t_min), bits_of(ray.t_max), ray, kAtRest);
    }
    /// Stores a path that begins. `any_alpha` means that the coin's key is needed, which `key` of its sample gives.
    HD void store_begun(uint32_t i, const PathState& path, const SampleKey& key, bool any_alpha) const {
        store_ray(rays + i, {path.origin, float_of(path.pixel), path.direction, float_of(path.sample)});
        if (any_alpha) keys[i] = coin_key(key, path.depth, false);
    }

    /// Returns the triangle that the ray of a path that continues leaves.
    HD TriangleId start_of(uint32_t i) const { return {starts[i].x, starts[i].y}; }
    /// Loads a path that continues, without its start and its time, which only some scenes need.
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
    HD void store(uint32_t i, const PathState& path, const SampleKey& key, bool any_alpha) const {
        store_begun(i, path, key, any_alpha);
        starts[i] = {path.start.instance, path.start.primitive};
        throughput[i] = {path.throughput.r, path.throughput.g, path.throughput.b,
                         float_of(path.depth | (path.rough_depth << 16))};
        radiance[i] = {path.radiance.r, path.radiance.g, path.radiance.b, path.bsdf_pdf};
    }
    /// Stores a path that ends after its shadow ray.
    HD void store_ended(uint32_t i, const PathState& path) const {
        radiance[i] = {path.radiance.r, path.radiance.g, path.radiance.b, float_of(path.pixel)};
    }
};

/// Bit of the slot of a path that ends after its shadow ray. Queues have fewer slots (kMaxQueueBytes).
inline constexpr uint32_t kEndsPath = 0x80000000u;

struct ShadowQueueView {
    Ray* rays;
    Uint2 *starts, *targets;
    uint32_t* keys;       // keys, and after tracing the results
    Float4* contribution; // rgb, bits of the path's slot in the next round's arrays with kEndsPath
    float* times;         // the times of PathQueueView

    RayQueueView query(bool passes_thin_walls) const {
        return {.rays = rays,
                .starts = starts,
                .targets = targets,
                .keys = keys,
                .times = times,
                .passes_thin_walls = passes_thin_walls};
    }

    HD void store(uint32_t i, const ShadowRay& ray, uint32_t path, uint32_t key) const {
        store_ray(rays + i, {ray.origin, 0.0f, ray.direction, ray.t_max});
        starts[i] = {ray.start.instance, ray.start.primitive};
        targets[i] = {ray.target.instance, ray.target.primitive};
        keys[i] = key;
        contribution[i] = {ray.contribution.r, ray.contribution.g, ray.contribution.b, float_of(path)};
    }
};

/// Counts of one round, on their own cache lines because kernels of two rounds run concurrently.
struct alignas(128) RoundCounts {
    uint64_t first;                // number of the first new path's sample (BeginOrder::at)
    uint32_t going_on;             // paths from the previous round, at the front
    uint32_t fresh;                // new paths in this round, at the end
    uint32_t active;               // sum of both
    uint32_t shadows;              // shadow rays of its vertices
    uint32_t next, ended;          // active paths that continue after the round, and that end after their shadow ray
    uint32_t all_begun;            // 1 if no path begins afterwards
    uint32_t taken[3];             // rays that a tracer has taken from its pool, by RayKind
    uint32_t in_group[kBlockKeys]; // hits of each shading group, if orders_hits()
    uint32_t ordered[kBlockKeys];  // hits of each group that have been sorted so far
};

/// The host's knowledge of a round.
struct HostCounts {
    uint32_t active, all_begun; // copies from RoundCounts
};

/// Slots of a vertex's path, if it does not end at once, and of its shadow ray.
struct RoundSlots {
    uint32_t path, shadow;
};
using RoundAppend = BlockAppend<3>;

/// Reserves the slots of a vertex. `last` is the slot of the first path that ends after its shadow ray.
HD inline RoundSlots append_to_round(const RoundAppend& lists, RoundCounts& round, uint32_t last, bool goes_on,
                                     bool has_shadow_ray) {
    const bool ends = has_shadow_ray && !goes_on;
    const ListSlots<3> slots = lists.take({&round.next, &round.ended, &round.shadows}, {goes_on, ends, has_shadow_ray});
    return {ends ? last - slots.at[1] : slots.at[0], slots.at[2]};
}

/// Counts of all rounds of a render.
struct RenderCounts {
    uint64_t begun;            // samples; may exceed the requested number
    uint64_t bounces, shadows; // rays
};

} // namespace pertev
