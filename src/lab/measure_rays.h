#pragma once

// A set of rays on a device, and what one walk makes of it: hits, time, work. Time counts the walk of all rays alone;
// making rays and trees, copies and counting do not.

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
    /// Throws Error(OutOfMemory). `queue` outlives it; fewer than 2^32 rays.
    RaysOnDevice(Queue& queue, const RaySet& set)
        : queue_(queue), any_hit_(set.any_hit), rays_(queue, set.rays, "rays"), hits_(queue, set.rays.size(), "hits") {
        PERTEV_CHECK(set.rays.size() <= std::numeric_limits<uint32_t>::max());
    }

    uint32_t count() const { return static_cast<uint32_t>(rays_.size()); }
    /// Of the last trace().
    std::vector<RayHit> hits() const { return hits_.download(); }

    /// Where all triangles are baked, by the kernel that has no top level in it.
    template <class Walk>
    void trace(const SceneTrees<typename Walk::Tree>& scene) {
        if (scene.top_root == kNoLink) {
            trace_in<Walk>(SingleTree<typename Walk::Tree>{scene.baked});
        } else {
            trace_in<Walk>(scene);
        }
    }

    template <class Walk>
    RunTimes time(const SceneTrees<typename Walk::Tree>& scene, int warm_ups, int runs) {
        return time_runs(queue_, warm_ups, runs, [&] { trace<Walk>(scene); });
    }

    /// What each ray costs.
    template <class Walk>
    std::vector<RayWork> count_work(const SceneTrees<typename Walk::Tree>& scene) {
        const Buffer<RayWork> work(queue_, rays_.size(), "counts");
        if (any_hit_) {
            launch(queue_, "count work", count(), CountRays<Walk, true>{scene, rays_.data(), work.data()});
        } else {
            launch(queue_, "count work", count(), CountRays<Walk, false>{scene, rays_.data(), work.data()});
        }
        return work.download();
    }

private:
    template <class Walk, class Scene>
    void trace_in(const Scene& scene) {
        if (any_hit_) {
            launch(queue_, "trace rays", count(), TraceRays<Walk, true, Scene>{scene, rays_.data(), hits_.data()});
        } else {
            launch(queue_, "trace rays", count(), TraceRays<Walk, false, Scene>{scene, rays_.data(), hits_.data()});
        }
    }

    Queue& queue_;
    bool any_hit_;
    Buffer<Ray> rays_;
    Buffer<RayHit> hits_;
};

/// Of a set: means, and the ray that costs most, which one lane of a GPU walks alone in the end.
struct WorkSummary {
    double nodes = 0, triangles = 0; // a ray
    uint32_t most_nodes = 0, most_triangles = 0;
};

WorkSummary summarize_work(const std::vector<RayWork>& work);

/// In [0, 1]; 0 of none.
double hit_share(const std::vector<RayHit>& hits);

} // namespace pertev
