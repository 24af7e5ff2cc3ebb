#pragma once

// The light meter, which finds the exposure of a picture before it is rendered. It renders small pictures with its
// own samples, so that samples, noise and size of the picture do not affect the exposure. Meter works on a scene on a
// device; it needs no session.

#include <functional>

#include "image/tone_map.h"
#include "session/picture_renderer.h"

namespace pertev {

/// Size of the meter's pictures: about 6400 pixels with the picture's aspect ratio, 16 samples each, whatever the
/// picture's settings.
inline constexpr uint32_t kMeterPixels = 6400, kMeterSamples = 16;

/// Share of a picture, RGBA without emitters and sky, that scatters light. Only lit pixels count, because black ones
/// carry no information. Below the minimum, the picture shows only emitters and sky.
double share_that_counts(const Image& scattered);
inline constexpr double kFewestThatCount = 0.01;

/// Returns what the meter sees of the picture of `settings`, for auto_exposure_stops: the light that surfaces scatter
/// towards the camera; directly visible emitters and sky do not count unless there is nothing else. It depends on the
/// scene, the camera, and the light paths and aspect ratio of `settings`, not on seed, samples or filter, and is equal
/// on every device, to the bit. `render` renders the scene with the settings that it gets; it is called two or three
/// times, with some 10^5 samples each.
Image metered_light(const RenderSettings& settings, const std::function<Image(const RenderSettings&)>& render);
/// Stops for the picture of `settings`, displayed by `tone_map`: a multiple of 1/100 in [-60, 60].
float meter_exposure(const RenderSettings& settings, ToneMap tone_map,
                     const std::function<Image(const RenderSettings&)>& render);

/// The meter for a scene on a device. It uploads nothing, and keeps its small film.
class Meter {
public:
    /// Makes a meter; `pictures` outlives it.
    explicit Meter(PictureRenderer& pictures) : pictures_(pictures) {}
    /// Returns metered_light() for the view of `camera`. Throws Error(OutOfMemory, DeviceFault).
    Image light(const Camera& camera, const RenderSettings& settings);
    /// Returns meter_exposure() for the view of `camera`. Throws as light().
    float stops(const Camera& camera, const RenderSettings& settings, ToneMap tone_map);

private:
    PictureRenderer& pictures_;
    std::optional<Film> film_;
};

} // namespace pertev
