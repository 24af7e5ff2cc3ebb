#pragma once

// The light meter: how a picture that is yet to be rendered should be exposed. It looks at small pictures of its own,
// with samples of its own, so that neither the samples of the picture nor their noise, nor its size, move the exposure.
// Meter looks at a scene on a device; it needs no session.

#include <functional>

#include "image/tone_map.h"
#include "session/picture_renderer.h"

namespace pertev {

/// Of the meter's pictures: about 6400 pixels of the picture's shape, 16 samples each, whatever the picture has.
inline constexpr uint32_t kMeterPixels = 6400, kMeterSamples = 16;

/// Share of a picture, RGBA without lamps and sky, that light is scattered from. It takes lit pixels: black ones tell
/// nothing. With less than the fewest that count there is nothing but lamps and sky.
double share_that_counts(const Image& scattered);
inline constexpr double kFewestThatCount = 0.01;

/// Stops for the picture that `settings` ask for, shown by `tone_map` (image/auto_exposure.h says which): a multiple of
/// 1/100 within [-60, 60]. Judged by what surfaces scatter towards the camera. Lamps and sky that are seen directly do
/// not count, unless there is nothing else. A function of scene, camera and what `settings` say of light paths and of
/// width : height, not of their seed, samples or filter; the same on every device, to the bit. `render` gives the
/// picture of the scene by the settings that it gets; it is asked for two or three, some 10^5 samples each.
float meter_exposure(const RenderSettings& settings, ToneMap tone_map,
                     const std::function<Image(const RenderSettings&)>& render);

/// The meter over a scene on a device. It uploads nothing, and keeps its small film.
class Meter {
public:
    /// `pictures` outlives it.
    explicit Meter(PictureRenderer& pictures) : pictures_(pictures) {}
    /// Returns meter_exposure() of what `camera` sees. Throws Error(OutOfMemory, DeviceFault).
    float stops(const Camera& camera, const RenderSettings& settings, ToneMap tone_map);

private:
    PictureRenderer& pictures_;
    std::optional<Film> film_;
};

} // namespace pertev
