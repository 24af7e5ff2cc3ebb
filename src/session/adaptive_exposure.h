#pragma once

// Exposure that adapts over a sequence of frames. It depends only on the frames in their order. It approaches the
// exposure that image/auto_exposure.h finds for each frame, with 1/e of the difference left after 16 frames. As in
// the light meter (session/meter_exposure.h), directly visible emitters and sky do not count unless there is nothing
// else.
//
// Source: Krawczyk, Myszkowski, Seidel, "Perceptual Effects in Real-Time Tone Mapping", SCCG 2005, section 4.1 (an
// exponential decay towards the luminance to be adapted to), after Pattanaik et al., "Time-Dependent Visual Adaptation
// for Fast Realistic Image Display", SIGGRAPH 2000.

#include "denoise/reconstruction.h"

namespace pertev {

class AdaptiveExposure {
public:
    /// Share of the way to the target per frame: 1 - exp(-1 / 16).
    static constexpr float kShare = 0.0605869f;

    /// Sets the exposure from which the adaptation continues.
    void set(float stops) { stops_ = stops; }
    float stops() const { return stops_; }
    /// Adapts to a frame that `tone_map` will display, and returns the stops for it.
    float next(const FrameTones& tones, ToneMap tone_map);

private:
    float stops_ = 0;
};

} // namespace pertev
