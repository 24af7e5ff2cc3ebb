#include "lab/isolated_rays.h"

#include "lab/measure_rays.h"

namespace pertev {

Tracer make_tracer(Queue& queue, const Combination& combination, const PreparedScene& prepared, Sink& sink) {
    return {queue, combination, prepared.structures->get(combination, sink)};
}

const Combination& tracer_of_pictures(const RaySet& set, const TracerChoice& choice) {
    return set.any_hit ? choice.shadow : set.name == "primary" ? choice.camera : choice.bounce;
}

std::vector<RaySet> make_isolated_sets(Queue& queue, const Scene& scene, const Camera& camera,
                                       const PreparedScene& prepared, uint32_t count, Sink& sink) {
    const Tracer tracer = make_tracer(queue, kBinaryTracer, prepared, sink);
    const FrameSize frame = record_frame(count);
    const auto trace = [&, trace_rays = make_ray_tracer(queue, tracer)](std::span<const Ray> rays,
                                                                        std::span<RayHit> hits) {
        sink.check();
        trace_rays(rays, hits);
    };
    return make_record_ray_sets({scene, camera, frame.width, frame.height, trace}, count);
}

double IsolatedRates::of_mix(const RayCounts& rays) const {
    double seconds = 0;
    const auto add = [&](uint64_t count, double rate) {
        if (count > 0) seconds += static_cast<double>(count) / rate; // infinite where a kind has no rate
    };
    add(rays.camera, camera);
    add(rays.bounce, bounce);
    add(rays.shadow, shadow);
    return seconds > 0 ? static_cast<double>(rays.total()) / seconds : 0.0;
}

IsolatedRates measure_isolated_rays(Queue& queue, const Scene& scene, const Camera& camera,
                                    const PreparedScene& prepared, const TracerChoice& choice, uint32_t count,
                                    Sink& sink) {
    struct Sum {
        double rays = 0, seconds = 0;
        double rate() const { return seconds > 0 ? rays / seconds : 0.0; }
    };
    Sum camera_rays, bounces, shadows;
    for (RaySet& set : make_isolated_sets(queue, scene, camera, prepared, count, sink)) {
        if (set.rays.empty()) continue;
        sink.check();
        const Tracer tracer = make_tracer(queue, tracer_of_pictures(set, choice), prepared, sink);
        RaysOnDevice rays(queue, set);
        Sum& sum = set.any_hit ? shadows : set.name == "primary" ? camera_rays : bounces;
        sum.rays += static_cast<double>(rays.count());
        sum.seconds += rays.time(tracer, queue.is_cuda() ? 3 : 1, queue.is_cuda() ? 11 : 3).median;
        set.rays = {}; // frees a quarter of a gigabyte at the record's size
    }
    return {camera_rays.rate(), bounces.rate(), shadows.rate()};
}

} // namespace pertev
