#pragma once

// Paths in flight on the GPU, as structures of arrays with 16-byte elements. A path keeps its slot from camera to film;
// the active list says which slots still have a ray to trace. Shadow rays lie packed, each with its path's slot.

#include <cstdint>

#include "device/atomic_add.h"
#include "integrators/path/path_state.h"
#include "math/float4.h"

namespace pertev {

struct PathQueueView {
    Float4* ray_origin;    // xyz, bsdf_pdf
    Float4* ray_direction; // xyz, unused
    Float4* throughput;    // rgb, bits of (depth | rough_depth << 16)
    Float4* radiance;      // rgb, unused
    Uint4* ids;            // pixel, sample, start instance, start primitive

    HD PathState load(uint32_t slot) const {
        const Float4 o = ray_origin[slot], d = ray_direction[slot], t = throughput[slot], r = radiance[slot];
        const Uint4 id = ids[slot];
        const uint32_t depths = bits_of(t.w);
        PathState path;
        path.origin = {o.x, o.y, o.z};
        path.direction = {d.x, d.y, d.z};
        path.throughput = {t.x, t.y, t.z};
        path.radiance = {r.x, r.y, r.z};
        path.bsdf_pdf = o.w;
        path.pixel = id.x;
        path.sample = id.y;
        path.start = {id.z, id.w};
        path.depth = depths & 0xffffu;
        path.rough_depth = depths >> 16;
        return path;
    }
    HD void store(uint32_t slot, const PathState& path) const {
        ray_origin[slot] = {path.origin.x, path.origin.y, path.origin.z, path.bsdf_pdf};
        ray_direction[slot] = {path.direction.x, path.direction.y, path.direction.z, 0};
        throughput[slot] = {path.throughput.r, path.throughput.g, path.throughput.b,
                            float_of(path.depth | (path.rough_depth << 16))};
        ids[slot] = {path.pixel, path.sample, path.start.instance, path.start.primitive};
        store_radiance(slot, path.radiance);
    }
    HD Rgb load_radiance(uint32_t slot) const { return {radiance[slot].x, radiance[slot].y, radiance[slot].z}; }
    HD void store_radiance(uint32_t slot, Rgb value) const { radiance[slot] = {value.r, value.g, value.b, 0}; }
};

struct HitQueueView {
    Float4* place;   // t, u, v, unused
    Uint4* triangle; // instance, primitive, unused, unused

    HD Hit load(uint32_t i) const {
        const Float4 p = place[i];
        const Uint4 id = triangle[i];
        return {p.x, p.y, p.z, id.x, id.y};
    }
    HD void store(uint32_t i, const Hit& hit) const {
        place[i] = {hit.t, hit.u, hit.v, 0};
        triangle[i] = {hit.instance, hit.primitive, 0, 0};
    }
};

struct ShadowQueueView {
    Float4* origin;       // xyz, t_max
    Float4* direction;    // xyz, bits of the path's slot
    Float4* contribution; // rgb, bits of the target's instance
    Uint4* ids;           // start instance, start primitive, target primitive, key

    HD void store(uint32_t i, const ShadowRay& ray, uint32_t slot, TriangleId start, uint32_t key) const {
        origin[i] = {ray.origin.x, ray.origin.y, ray.origin.z, ray.t_max};
        direction[i] = {ray.direction.x, ray.direction.y, ray.direction.z, float_of(slot)};
        contribution[i] = {ray.contribution.r, ray.contribution.g, ray.contribution.b, float_of(ray.target.instance)};
        ids[i] = {start.instance, start.primitive, ray.target.primitive, key};
    }
};

/// Slots that the next round works on, and how many.
struct SlotListView {
    uint32_t* slots;
    uint32_t* count;

    HD void push(uint32_t slot) const { slots[atomic_add(count, 1u)] = slot; }
};

} // namespace pertev
