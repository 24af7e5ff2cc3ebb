#pragma once

// First stage: from a frame's light to its two signals, and what of the frame the next one asks for.

#include "denoise/split_light.h"

namespace pertev {

struct SplitSignals {
    NoisyFrameView frame;
    SignalsView signals; // their w: 0
    HistoryView now;

    HD void operator()(uint32_t i) const {
        now.normal[i] = frame.normal[i];
        now.object[i] = bits_of(frame.place[i].x);
        const SplitLight light = split_light(frame, i);
        signals.diffuse[i] = with_w(light.diffuse / light.diffuse_divisor, 0);
        signals.gloss[i] = with_w(light.gloss / light.gloss_divisor, 0);
    }
};

} // namespace pertev
