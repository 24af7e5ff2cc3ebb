#pragma once

// Rays that wait to be traced and what they meet, in a device's memory: the form in which integrators hand rays to a
// tracer (render/tracer/scene_tracer.h) and get hits back.

#include <cstdint>

#include "base/host_device.h"
#include "math/float4.h"
#include "math/scalar.h"
#include "trace/ray.h"

namespace pertev {

static_assert(sizeof(Ray) == 32);

/// rays[i], by two loads of 16 bytes on the device; `rays` begins on a multiple of 16 there, as every buffer does.
HD inline Ray load_ray(const Ray* rays, uint32_t i) {
#if PERTEV_ON_DEVICE
    const float4* from = reinterpret_cast<const float4*>(rays) + 2 * static_cast<uint64_t>(i);
    const float4 a = __ldg(from), b = __ldg(from + 1);
    return {{a.x, a.y, a.z}, a.w, {b.x, b.y, b.z}, b.w};
#else
    return rays[i];
#endif
}

HD inline void store_ray(Ray* rays, uint32_t i, const Ray& ray) {
#if PERTEV_ON_DEVICE
    float4* to = reinterpret_cast<float4*>(rays) + 2 * static_cast<uint64_t>(i);
    to[0] = {ray.origin.x, ray.origin.y, ray.origin.z, ray.t_min};
    to[1] = {ray.direction.x, ray.direction.y, ray.direction.z, ray.t_max};
#else
    rays[i] = ray;
#endif
}

/// Rays lie in slots. A list may name the slots that take part.
struct RayQueueView {
    const Ray* rays = nullptr;
    const Uint4* ends = nullptr;     // instance and primitive of the triangle that a ray leaves, and of the one that it
                                     // is aimed at: neither is hit. kNoHit: none. Null: none of any ray
    const uint32_t* keys = nullptr;  // of the coin that blended surfaces toss; null where no surface is blended
    const uint32_t* slots = nullptr; // ray i lies in slots[i]; null: in slot i

    HD uint32_t slot(uint32_t i) const { return slots != nullptr ? slots[i] : i; }
    HD Ray load(uint32_t i) const { return load_ray(rays, slot(i)); }
};

/// What rays 0, 1, ... meet.
struct HitQueueView {
    Float4* places = nullptr;      // t, u, v, bits of the primitive. Not there for an any-hit search
    uint32_t* instances = nullptr; // kNoHit: nothing; of an any-hit search else 0

    HD Hit load(uint32_t i) const {
        const Float4 p = places[i];
        return {p.x, p.y, p.z, instances[i], bits_of(p.w)};
    }
    HD void store(uint32_t i, const Hit& hit) const {
        places[i] = {hit.t, hit.u, hit.v, float_of(hit.primitive)};
        instances[i] = hit.instance;
    }
    HD void store_any(uint32_t i, bool found) const { instances[i] = found ? 0 : kNoHit; }
};

} // namespace pertev
