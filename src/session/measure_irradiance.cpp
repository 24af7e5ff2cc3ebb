#include "session/measure_irradiance.h"

#include <cmath>
#include <span>

#include <fmt/format.h>

#include "base/error.h"
#include "math/double_pi.h"
#include "math/frame.h"
#include "scene/scene_origin.h"
#include "session/session.h"

namespace pertev {
namespace {

RenderSettings probe_settings(const RenderSettings& requested) {
    RenderSettings settings;
    settings.integrator = IntegratorKind::Path;
    settings.path = requested.path;
    settings.body = requested.body;
    settings.batch = requested.batch;
    settings.tracers = requested.tracers;
    settings.samples = requested.samples;
    settings.width = settings.height = kMeterSide;
    settings.filter = PixelFilter::Box;
    return settings;
}

double luminance_of(const double (&rgb)[3]) { return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]; }

Measured mean_of(std::span<const double> estimates) {
    const double n = static_cast<double>(estimates.size());
    double sum = 0, squares = 0;
    for (const double estimate : estimates) sum += estimate;
    const double mean = sum / n;
    for (const double estimate : estimates) squares += (estimate - mean) * (estimate - mean);
    return {mean, std::sqrt(squares / (n * (n - 1)))};
}

} // namespace

void check_meter(const MeterPoint& meter, uint32_t seed) {
    const Vec3 n = meter.normal;
    if (!(length_squared(n) > 0) || !is_finite(normalize(n))) {
        throw Error(ErrorCode::BadInput, "normal", fmt::format("{},{},{}", n.x, n.y, n.z),
                    "the normal has no direction; expected a length above 0");
    }
    if (seed > kMaxMeterSeed)
        throw Error(ErrorCode::BadInput, "seed", fmt::format("{}", seed), fmt::format("at most {}", kMaxMeterSeed));
}

Camera meter_camera(const Scene& scene, const MeterPoint& meter) {
    PERTEV_CHECK(length_squared(meter.normal) > 0);
    const Bounds3 bounds = bounds_of(scene);
    const Vec3 point = in_scene(scene, meter.point);
    float largest = max_component(abs(point));
    if (!bounds.is_empty()) largest = max(largest, max_component(max(abs(bounds.lo), abs(bounds.hi))));
    const Frame frame = make_frame(normalize(meter.normal));
    Camera camera;
    camera.projection = Projection::Cosine;
    // The camera looks along -z, so its x and y are swapped relative to the frame's.
    const Vec3 x = frame.bitangent, y = frame.tangent, z = -frame.normal;
    camera.world_from_camera = {
        {x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}, point + 0x1p-19f * largest * frame.normal};
    return camera;
}

Irradiance measure_irradiance(Queue& queue, const PreparedScene& scene, const MeterPoint& meter,
                              const RenderSettings& requested, Sink& sink) {
    check_meter(meter, requested.path.seed);
    RenderSettings settings = probe_settings(requested);
    Session session(queue, scene, meter_camera(*scene.scene, meter), settings);
    Irradiance result;
    double estimates[4][kMeterRepeats];
    for (uint32_t repeat = 0; repeat < kMeterRepeats; ++repeat) {
        settings.path.seed = requested.path.seed * kMeterRepeats + repeat;
        session.set_settings(settings);
        session.cut();
        session.render(settings.samples,
                       part_of(sink, double(repeat) / kMeterRepeats, double(repeat + 1) / kMeterRepeats));
        sink.check();
        const Image picture = session.picture();
        double sums[3] = {};
        for (std::size_t i = 0; i < picture.pixels.size(); ++i) sums[i % 3] += static_cast<double>(picture.pixels[i]);
        constexpr double kPixels = kMeterSide * kMeterSide;
        for (double& sum : sums) sum *= kPiDouble / kPixels; // radiance of a white surface
        for (int k = 0; k < 3; ++k) estimates[k][repeat] = sums[k];
        estimates[3][repeat] = luminance_of(sums);
        const RenderStats stats = session.stats();
        result.paths += uint64_t(kMeterSide) * kMeterSide * stats.samples;
        result.invalid_paths += stats.invalid_samples;
        result.rays = result.rays + stats.rays;
    }
    for (int k = 0; k < 3; ++k) result.rgb[k] = mean_of(estimates[k]);
    result.luminance = mean_of(estimates[3]);
    return result;
}

} // namespace pertev
