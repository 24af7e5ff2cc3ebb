#pragma once

// One walk over a set of rays, as a stage: a ray in (32 bytes), what it met out (12). Every walk of the laboratory runs
// as this stage, so that their results can be compared byte for byte and their times with each other. A walk's .cu file
// instantiates launch() of the stages it is run with; lab/trace_rays.cu does so for the walk of pictures.

#include <cstdint>
#include <functional>
#include <span>

#include "base/host_device.h"
#include "device/launch.h"
#include "trace/trace_any.h"
#include "trace/trace_closest.h"

namespace pertev {

/// Closest: the least (t, instance, primitive) of the candidates; t is the ray's own t_max where there is none. Any:
/// {0, 0, 0} where there is a candidate, {0, kNoHit, 0} where not: which one was met first is the walk's affair.
struct RayHit {
    float t = 0;
    uint32_t instance = kNoHit;
    uint32_t primitive = 0;

    HD bool is_hit() const { return instance != kNoHit; }
    bool operator==(const RayHit&) const = default;
};
static_assert(sizeof(RayHit) == 12 && sizeof(Ray) == 32);

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

/// What the ray meets, told to `counter`.
template <class Walk, bool kAny, class Scene, class Counter>
HD inline RayHit trace_ray(const Scene& scene, const Ray& ray, const Counter& counter) {
    const AcceptAll accept;
    if constexpr (kAny) {
        return {0.0f, trace_any<Walk>(scene, ray, accept, counter) ? 0u : kNoHit, 0u};
    } else {
        Hit hit;
        trace_closest<Walk>(scene, ray, accept, hit, counter);
        return {hit.t, hit.instance, hit.primitive};
    }
}

/// `Scene` is SceneTrees or SingleTree of what the walk walks.
template <class Walk, bool kAny, class Scene = SceneTrees<typename Walk::Tree>>
struct TraceRays {
    Scene scene;
    const Ray* rays;
    RayHit* hits;

    HD void operator()(uint32_t i) const { hits[i] = trace_ray<Walk, kAny>(scene, load_ray(rays, i), NoWalkCounter{}); }
};

/// What one ray cost: nodes and triangles that were tested.
struct RayWork {
    uint32_t nodes = 0, triangles = 0;
};

/// The same walk, counted. A stage of its own, so that the counting costs the timed one nothing.
template <class Walk, bool kAny>
struct CountRays {
    SceneTrees<typename Walk::Tree> scene;
    const Ray* rays;
    RayWork* work;

    HD void operator()(uint32_t i) const {
        uint64_t nodes = 0, triangles = 0;
        trace_ray<Walk, kAny>(scene, load_ray(rays, i), WalkCounter{&nodes, &triangles});
        work[i] = {static_cast<uint32_t>(nodes), static_cast<uint32_t>(triangles)};
    }
};

/// What many rays meet first; both spans are the host's and equally long.
using RayTracer = std::function<void(std::span<const Ray>, std::span<RayHit>)>;

/// By the walk that pictures are made with, on the queue's device, where the trees lie. `queue` outlives it.
RayTracer make_ray_tracer(Queue& queue, const SceneBvhView& scene);

} // namespace pertev
