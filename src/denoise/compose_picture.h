#pragma once

// Fifth stage: multiplies the signals by the surfaces' colours again and adds emission.

#include "denoise/shown_color.h"

namespace pertev {

struct ComposePicture {
    NoisyFrameView frame;
    SignalsView signals;
    Float4* picture; // shown_color; w: depth, metres

    HD void operator()(uint32_t i) const {
        Rgb light = frame.light[i].w != 0 ? rgb_of(frame.emission[i]) : Rgb{0, 0, 0};
        light += rgb_of(signals.diffuse[i]) * diffuse_divisor(frame, i);
        if (frame.splits_light()) light += rgb_of(signals.gloss[i]) * gloss_divisor(frame, i);
        picture[i] = with_w(shown_color(light), frame.normal[i].w);
    }
};

} // namespace pertev
