#pragma once

// What rays meet, as the laboratory compares it, and where that lies on a device.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "device/buffer.h"
#include "device_scene/ray_queue.h"
#include "tracer/tracer.h"

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

/// Room for what a set of rays meets.
class HitsOnDevice {
public:
    /// Throws Error(OutOfMemory).
    HitsOnDevice(Queue& queue, std::size_t rays) : places_(queue, rays, "hits"), instances_(queue, rays, "hits") {}

    /// Of the rays from number `first` on.
    HitQueueView from(std::size_t first) const { return {places_.data() + first, instances_.data() + first}; }
    /// No ray has this result.
    void spoil() {
        places_.fill(0xff);
        instances_.fill(0xfe);
    }
    std::vector<RayHit> download(bool any_hit) const;

private:
    Buffer<Float4> places_;
    Buffer<uint32_t> instances_;
};

/// Rays [0, count) that lie in a device's memory, of which every candidate counts.
inline TraceQuery all_candidates(const Ray* rays) { return {.rays = {.rays = rays}}; }

inline void trace(const Tracer& tracer, bool any_hit, const Ray* rays, uint32_t count, const HitQueueView& hits) {
    if (any_hit) {
        tracer.find_occlusions(all_candidates(rays), count, hits);
    } else {
        tracer.find_hits(all_candidates(rays), count, hits);
    }
}

/// What many rays meet first; both spans are the host's and equally long.
using RayTracer = std::function<void(std::span<const Ray>, std::span<RayHit>)>;

/// On the queue's device, where the tracer is. Both outlive it.
RayTracer make_ray_tracer(Queue& queue, const Tracer& tracer);

} // namespace pertev
