#pragma once

// Queues of rays and of their hits in device memory, which integrators and tracers exchange (tracer/scene_tracer.h).

#include <cstdint>

#include "base/host_device.h"
#include "math/float4.h"
#include "math/scalar.h"
#include "trace/intersect/ray.h"

namespace pertev {

static_assert(sizeof(Ray) == 32);

/// Loads *at by two loads of 16 bytes on the device; `at` is a multiple of 16 there, as in every buffer.
HD inline Ray load_ray(const Ray* at) {
#if PERTEV_ON_DEVICE
    const float4* from = reinterpret_cast<const float4*>(at);
    const float4 a = __ldg(from), b = __ldg(from + 1);
    return {{a.x, a.y, a.z}, a.w, {b.x, b.y, b.z}, b.w};
#else
    return *at;
#endif
}

HD inline void store_ray(Ray* at, const Ray& ray) {
#if PERTEV_ON_DEVICE
    float4* to = reinterpret_cast<float4*>(at);
    to[0] = {ray.origin.x, ray.origin.y, ray.origin.z, ray.t_min};
    to[1] = {ray.direction.x, ray.direction.y, ray.direction.z, ray.t_max};
#else
    *at = ray;
#endif
}

/// Consecutive rays, from the first element on or from the last one backwards.
struct RayQueueView {
    const Ray* rays = nullptr;
    // Instance and primitive of the triangle that a ray leaves, and of the one at which it is aimed; neither is hit.
    // kNoHit: none. Null: none for any ray.
    const Uint2* starts = nullptr;
    const Uint2* targets = nullptr;
    const uint32_t* keys = nullptr; // keys of the coins of blended surfaces; null if no surface is blended
    const float* times = nullptr;   // while the shutter is open, [0, 1]; null: all is at rest
    int32_t step = 1;               // -1: the pointers are to the last elements, and ray i is i elements before them
    bool passes_thin_walls = false; // AcceptHit::passes_thin_walls
    bool is_endless = false;        // all go from t = 0 to infinity; t_min and t_max hold numbers of the owner

    HD int64_t index(uint32_t i) const { return step * static_cast<int64_t>(i); }
    HD Ray load(uint32_t i) const {
        Ray ray = load_ray(rays + index(i));
        if (is_endless) {
            ray.t_min = 0;
            ray.t_max = kInfinity;
        }
        return ray;
    }
};

/// Hits of rays 0, 1, ....
struct HitQueueView {
    Float4* records = nullptr;     // t, u, v, bits of the primitive; absent in an any-hit search
    uint32_t* instances = nullptr; // kNoHit: no hit; in an any-hit search otherwise 0
    int32_t step = 1;              // see RayQueueView

    HD uint32_t load_instance(uint32_t i) const { return instances[index(i)]; }
    HD Hit load(uint32_t i) const {
        const Float4 p = records[index(i)];
        return {p.x, p.y, p.z, instances[index(i)], bits_of(p.w)};
    }
    HD void store(uint32_t i, const Hit& hit) const {
        records[index(i)] = {hit.t, hit.u, hit.v, float_of(hit.primitive)};
        instances[index(i)] = hit.instance;
    }
    HD void store_any(uint32_t i, bool found) const { instances[index(i)] = found ? 0 : kNoHit; }

private:
    HD int64_t index(uint32_t i) const { return step * static_cast<int64_t>(i); }
};

} // namespace pertev
