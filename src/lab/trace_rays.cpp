#include "lab/trace_rays.h"

#include <algorithm>
#include <limits>

#include "base/error.h"
#include "base/parallel_for.h"

namespace pertev {

std::vector<RayHit> HitsOnDevice::download(bool any_hit) const {
    std::vector<Float4> records_copy;
    std::vector<uint32_t> instances_copy;
    const std::span<const Float4> records = any_hit ? std::span<const Float4>() : records_.read(records_copy);
    const std::span<const uint32_t> instances = instances_.read(instances_copy);
    std::vector<RayHit> hits(instances.size());
    parallel_for(hits.size(), 1 << 14, [&](uint64_t i) {
        hits[i] = any_hit ? RayHit{0, instances[i], 0} : RayHit{records[i].x, instances[i], bits_of(records[i].w)};
    });
    return hits;
}

RayTracer make_ray_tracer(Queue& queue, const Tracer& tracer) {
    return [&queue, &tracer](std::span<const Ray> rays, std::span<RayHit> hits) {
        PERTEV_CHECK(rays.size() == hits.size() && rays.size() <= std::numeric_limits<uint32_t>::max());
        const Buffer<Ray> on_device(queue, rays, "rays");
        const HitsOnDevice found(queue, rays.size());
        trace(tracer, false, on_device.data(), static_cast<uint32_t>(rays.size()), found.from(0));
        std::ranges::copy(found.download(false), hits.begin());
    };
}

} // namespace pertev
