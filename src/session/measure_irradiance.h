#pragma once

// The light that arrives at a point, in numbers: the path tracer's own estimate (integrators/path/meter_light.h), the
// same on every device. It is made of independent estimates, from whose spread its error is known.

#include <cstdint>
#include <functional>

#include "device/queue.h"
#include "render/prepare_scene.h"
#include "settings/render_settings.h"

namespace pertev {

/// A measured number and the standard error of it.
struct Measured {
    double value = 0, standard_error = 0;
};

struct Irradiance {
    Measured rgb[3];            // W/m2, of linear Rec. 709
    Measured luminance;         // W/m2, by the weights of luminance() in math/rgb.h
    uint64_t paths = 0;         // that began at the point
    uint64_t invalid_paths = 0; // of which brought light that is not finite, and count as black
    RayCounts rays;
};

/// Independent estimates, and the sides of the picture that each of them is.
inline constexpr uint32_t kMeterRepeats = 32, kMeterSide = 16;
/// The seed of the first estimate is so many times the one asked for: two seeds share none.
inline constexpr uint32_t kMostMeterSeed = UINT32_MAX / kMeterRepeats;

/// Where and which way a meter looks; metres, in the coordinates of the scene's file.
struct MeterPlace {
    DoubleVec3 point;
    Vec3 normal; // out of the surface that the light is for; any length but 0
};

/// A camera there that shows no picture but what arrives (Projection::Cosine): off the surface by 2^-19 of the largest
/// coordinate of `scene` and place, which is more than rounding moves them by.
Camera meter_camera(const Scene& scene, const MeterPlace& place);

/// `settings`: path settings, samples (paths through each of the picture's parts) and tracers; the rest has no say.
/// The seed is at most kMostMeterSeed. Light that is scattered up to settings.path.max_depth times counts. Backs that
/// cameras pass are passed: where they are to count, make materials double sided before. `keep_going` is told the share
/// that is done, in [0, 1]; where it returns false, Error(Interrupted) is thrown. Throws as Session.
Irradiance measure_irradiance(Queue& queue, const PreparedScene& scene, const MeterPlace& place,
                              const RenderSettings& settings, const std::function<bool(double)>& keep_going = {});

} // namespace pertev
