#include <limits>

#include "base/error.h"
#include "device/buffer.h"
#include "lab/trace_rays.h"

namespace pertev {

RayTracer make_ray_tracer(Queue& queue, const SceneBvhView& scene) {
    return [&queue, scene](std::span<const Ray> rays, std::span<RayHit> hits) {
        PERTEV_CHECK(rays.size() == hits.size() && rays.size() <= std::numeric_limits<uint32_t>::max());
        const uint32_t count = static_cast<uint32_t>(rays.size());
        if (!queue.is_cuda()) { // its memory is the host's
            launch(queue, "trace rays", count, TraceRays<StackWalk, false>{scene, rays.data(), hits.data()});
            return;
        }
        const Buffer<Ray> on_device(queue, rays, "rays");
        const Buffer<RayHit> found(queue, count, "hits");
        launch(queue, "trace rays", count, TraceRays<StackWalk, false>{scene, on_device.data(), found.data()});
        queue.copy_to_host(hits.data(), found.data(), hits.size_bytes());
    };
}

} // namespace pertev
