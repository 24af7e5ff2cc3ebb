#pragma once

// Ray hits in the form that the laboratory compares, and their storage on a device.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "device/buffer.h"
#include "device_scene/ray_queue.h"
#include "tracer/tracer.h"

namespace pertev {

/// The hit of a ray. Closest hit: the least (t, instance, primitive) of the candidates; t is the ray's t_max without
/// one. Any hit: {0, 0, 0} if there is a candidate and {0, kNoHit, 0} if not, because traversals may find different
/// ones first.
struct RayHit {
    float t = 0;
    uint32_t instance = kNoHit;
    uint32_t primitive = 0;

    HD bool is_hit() const { return instance != kNoHit; }
    bool operator==(const RayHit&) const = default;
};

/// Device memory for the hits of a ray set.
class HitsOnDevice {
public:
    /// Allocates memory for `rays` hits. Throws Error(OutOfMemory).
    HitsOnDevice(Queue& queue, std::size_t rays) : records_(queue, rays, "hits"), instances_(queue, rays, "hits") {}

    /// View of the hits of ray number `first` and the rays after it.
    HitQueueView from(std::size_t first) const { return {records_.data() + first, instances_.data() + first}; }
    /// Fills the hits with a result that no ray has.
    void spoil() {
        records_.fill(0xff);
        instances_.fill(0xfe);
    }
    std::vector<RayHit> download(bool any_hit) const;

private:
    Buffer<Float4> records_;
    Buffer<uint32_t> instances_;
};

/// Query of rays [0, count) in device memory for which every candidate counts.
inline TraceQuery all_candidates(const Ray* rays) { return {.rays = {.rays = rays}}; }

inline void trace(const Tracer& tracer, bool any_hit, const Ray* rays, uint32_t count, const HitQueueView& hits) {
    if (any_hit) {
        tracer.find_occlusions(all_candidates(rays), count, hits);
    } else {
        tracer.find_hits(all_candidates(rays), count, hits);
    }
}

/// Traces closest hits of many rays; both spans are host memory and have equal length.
using RayTracer = std::function<void(std::span<const Ray>, std::span<RayHit>)>;

/// Traces on the queue's device, which must also hold the tracer. Both must outlive the result.
RayTracer make_ray_tracer(Queue& queue, const Tracer& tracer);

} // namespace pertev
