#pragma once

// The light meter: how a picture that is yet to be rendered should be exposed. It looks at a small picture of its own,
// with samples of its own, so that neither the samples of the picture nor their noise, nor its size, move the exposure.

#include "image/tone_map.h"
#include "integrators/render_picture.h"

namespace pertev {

/// Of the meter's picture: about 6400 pixels of the picture's shape, 16 samples each, whatever the picture has.
inline constexpr uint32_t kMeterPixels = 6400, kMeterSamples = 16;

/// Stops for the picture that `settings` ask for, shown by `tone_map` (image/auto_exposure.h says which): a multiple of
/// 1/100 within [-60, 60]. Judged by what surfaces scatter towards the camera. Lamps and sky that are seen directly do
/// not count, unless there is nothing else. A function of scene, camera and what `settings` say of light paths and of
/// width : height, not of their seed, samples or filter; the same on every device, to the bit. Costs an upload of the
/// scene and some 10^5 samples, and as many camera rays. Throws what render_picture throws.
float meter_exposure(Queue& queue, const PreparedScene& prepared, const Camera& camera, const RenderSettings& settings,
                     ToneMap tone_map);

} // namespace pertev
