#pragma once

// Paths in flight on the GPU, as structures of arrays. A path keeps its slot from camera to film; the active list says
// which slots still have a ray to trace. Shadow rays lie packed, each with its path's slot.

#include <cstdint>

#include "device/atomic_add.h"
#include "integrators/path/path_state.h"
#include "math/float4.h"
#include "render/ray_queue.h"

namespace pertev {

struct PathQueueView {
    Ray* rays;          // to trace next
    Uint4* ends;        // RayQueueView's
    uint32_t* keys;     // written where some surface is blended
    Float4* throughput; // rgb, bits of (depth | rough_depth << 16)
    Float4* radiance;   // rgb, bsdf_pdf
    Uint2* samples;     // pixel, sample

    /// Without `start`, which only the tracer needs.
    HD PathState load(uint32_t slot) const {
        const Ray ray = load_ray(rays, slot);
        const Float4 t = throughput[slot], r = radiance[slot];
        const Uint2 sample = samples[slot];
        const uint32_t depths = bits_of(t.w);
        PathState path;
        path.origin = ray.origin;
        path.direction = ray.direction;
        path.throughput = {t.x, t.y, t.z};
        path.radiance = {r.x, r.y, r.z};
        path.bsdf_pdf = r.w;
        path.pixel = sample.x;
        path.sample = sample.y;
        path.depth = depths & 0xffffu;
        path.rough_depth = depths >> 16;
        return path;
    }
    /// All but the pixel and the sample, which do not change. `any_alpha`: the coin's key is wanted.
    HD void store(uint32_t slot, const PathState& path, uint32_t seed, bool any_alpha) const {
        store_ray(rays, slot, {path.origin, 0.0f, path.direction, kInfinity});
        ends[slot] = {path.start.instance, path.start.primitive, kNoHit, 0};
        if (any_alpha) keys[slot] = path_key(path, seed, false);
        throughput[slot] = {path.throughput.r, path.throughput.g, path.throughput.b,
                            float_of(path.depth | (path.rough_depth << 16))};
        radiance[slot] = {path.radiance.r, path.radiance.g, path.radiance.b, path.bsdf_pdf};
    }
    HD Rgb load_radiance(uint32_t slot) const { return {radiance[slot].x, radiance[slot].y, radiance[slot].z}; }
    /// Keeps what lies beside it.
    HD void add_radiance(uint32_t slot, Rgb value) const {
        const Float4 r = radiance[slot];
        radiance[slot] = {r.x + value.r, r.y + value.g, r.z + value.b, r.w};
    }
};

struct ShadowQueueView {
    Ray* rays;
    Uint4* ends;
    uint32_t* keys;
    Float4* contribution; // rgb, bits of the path's slot

    HD void store(uint32_t i, const ShadowRay& ray, uint32_t slot, TriangleId start, uint32_t key) const {
        store_ray(rays, i, {ray.origin, 0.0f, ray.direction, ray.t_max});
        ends[i] = {start.instance, start.primitive, ray.target.instance, ray.target.primitive};
        keys[i] = key;
        contribution[i] = {ray.contribution.r, ray.contribution.g, ray.contribution.b, float_of(slot)};
    }
};

/// Slots that the next round works on, and how many.
struct SlotListView {
    uint32_t* slots;
    uint32_t* count;

    HD void push(uint32_t slot) const { slots[atomic_add(count, 1u)] = slot; }
};

} // namespace pertev
