#pragma once

// First stage: splits a frame's light into its two signals, and stores the data that the next frame needs.

#include "denoise/split_light.h"

namespace pertev {

struct SplitSignals {
    NoisyFrameView frame;
    SignalsView signals; // w is 0, or kUnknownSignal. The second one is absent if the frame does not split its light,
                         // because it is black
    HistoryView now;

    HD void operator()(uint32_t i) const {
        const Float4 normal = frame.normal[i];
        now.guide[i] = pack({vec3_of(normal), frame.albedo[i].w, normal.w, bits_of(frame.hit[i].x)});
        const SplitLight light = split_light(frame, i);
        signals.diffuse[i] = diffuse_signal(light.diffuse, light.diffuse_divisor);
        if (frame.splits_light()) signals.gloss[i] = with_w(light.gloss / light.gloss_divisor, 0);
    }
};

} // namespace pertev
