#pragma once

// Measures the light that arrives at a point, with the path tracer's estimator (integrators/path/meter_light.h),
// equal on every device. The standard error comes from independent estimates.

#include <cstdint>

#include "base/sink.h"
#include "device/queue.h"
#include "render/prepare_scene.h"
#include "settings/render_settings.h"

namespace pertev {

/// A measured value and its standard error.
struct Measured {
    double value = 0, standard_error = 0;
};

struct Irradiance {
    Measured rgb[3];            // W/m2, of linear Rec. 709
    Measured luminance;         // W/m2, by the weights of luminance() in math/rgb.h
    uint64_t paths = 0;         // paths that began at the point
    uint64_t invalid_paths = 0; // paths whose light is not finite, which count as black
    RayCounts rays;
};

/// Number of independent estimates, and the side of each one's picture.
inline constexpr uint32_t kMeterRepeats = 32, kMeterSide = 16;
/// Limit of the seed: the first estimate's seed is the seed times kMeterRepeats, so that two seeds share no estimate.
inline constexpr uint32_t kMaxMeterSeed = UINT32_MAX / kMeterRepeats;

/// Position and direction of a meter, in metres in the coordinates of the scene's file.
struct MeterPoint {
    DoubleVec3 point;
    Vec3 normal; // outward normal of the lit surface; any length but 0
};

/// Throws Error(BadInput) for a normal that is no direction, and for a seed beyond kMaxMeterSeed.
void check_meter(const MeterPoint& meter, uint32_t seed);

/// A camera that measures irradiance (Projection::Cosine). It is offset from the surface by 2^-19 of the largest
/// coordinate of `scene` and `meter`, which is more than rounding moves them.
Camera meter_camera(const Scene& scene, const MeterPoint& meter);

/// Measures irradiance. Of `settings` it uses path settings, samples (paths through each pixel) and tracers. Light with
/// up to settings.path.max_depth scatterings counts. Culled backs do not block rays; to include them, make materials
/// double sided first. If `sink` stops it, Error(Interrupted) is thrown. Throws as check_meter and Session.
Irradiance measure_irradiance(Queue& queue, const PreparedScene& scene, const MeterPoint& meter,
                              const RenderSettings& settings, Sink& sink = nobody());

} // namespace pertev
