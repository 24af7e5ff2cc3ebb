#pragma once

// Exposure that follows a sequence of frames: a function of them, in their order, alone. It goes towards what
// image/auto_exposure.h finds for each frame, by as much of the way as leaves 1/e of it after 16 frames, judged by what
// the light meter judges pictures by (session/meter_exposure.h): lamps and sky that are seen directly do not count,
// unless there is nothing else.
//
// Source: Krawczyk, Myszkowski, Seidel, "Perceptual Effects in Real-Time Tone Mapping", SCCG 2005, section 4.1 (an
// exponential decay towards the luminance to be adapted to), after Pattanaik et al., "Time-Dependent Visual Adaptation
// for Fast Realistic Image Display", SIGGRAPH 2000.

#include "denoise/reconstruction.h"

namespace pertev {

class AdaptiveExposure {
public:
    /// 1 - exp(-1 / 16).
    static constexpr float kShare = 0.0605869f;

    /// Where it goes on from.
    void set(float stops) { stops_ = stops; }
    float stops() const { return stops_; }
    /// A frame is there, to be shown by `tone_map`: takes a step, and gives the stops for it.
    float next(const FrameTones& tones, ToneMap tone_map);

private:
    float stops_ = 0;
};

} // namespace pertev
