#pragma once

// A set of rays on a device, traced by one traversal: its hits, time and work. Times cover only the traversal of all
// rays, without making rays and trees, copies and counting.

#include <cstdint>
#include <limits>
#include <vector>

#include "base/error.h"
#include "device/buffer.h"
#include "device/device_timer.h"
#include "lab/ray_sets.h"
#include "lab/trace_rays.h"

namespace pertev {

class RaysOnDevice {
public:
    /// Uploads fewer than 2^32 rays. `queue` must outlive this. Throws Error(OutOfMemory).
    RaysOnDevice(Queue& queue, const RaySet& set)
        : queue_(queue), any_hit_(set.any_hit), rays_(queue, set.rays, "rays"), hits_(queue, set.rays.size()) {
        PERTEV_CHECK(set.rays.size() <= std::numeric_limits<uint32_t>::max());
    }

    uint32_t count() const { return static_cast<uint32_t>(rays_.size()); }
    /// Downloads the hits of the last trace().
    std::vector<RayHit> hits() const { return hits_.download(any_hit_); }

    void trace(const Tracer& tracer) { pertev::trace(tracer, any_hit_, rays_.data(), count(), hits_.from(0)); }
    RunTimes time(const Tracer& tracer, int warm_ups, int runs) {
        return time_runs(queue_, warm_ups, runs, [&] { trace(tracer); });
    }

    /// Returns the work of each ray; empty if the tracer cannot count it.
    std::vector<RayWork> count_work(const Tracer& tracer) const {
        const Buffer<RayWork> work(queue_, rays_.size(), "counts");
        if (!tracer.count_work(any_hit_, all_candidates(rays_.data()), count(), work.data())) return {};
        return work.download();
    }

private:
    Queue& queue_;
    bool any_hit_;
    Buffer<Ray> rays_;
    HitsOnDevice hits_;
};

/// Work of a ray set: its means, and the most expensive ray, which one GPU lane traces alone at the end.
struct WorkSummary {
    double nodes = 0, triangles = 0; // mean per ray
    uint32_t max_nodes = 0, max_triangles = 0;
};

WorkSummary summarize_work(const std::vector<RayWork>& work);

/// The share of rays that hit, in [0, 1]; 0 without rays.
double hit_share(const std::vector<RayHit>& hits);

} // namespace pertev
