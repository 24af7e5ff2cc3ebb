#pragma once

// Fifth stage: the signals, given back the surfaces' own colours, with what the camera met itself.

#include "denoise/reconstruction_view.h"

namespace pertev {

struct ComposePicture {
    NoisyFrameView frame;
    SignalsView signals;
    Float4* picture; // rgb, W/(sr m2); w: depth, metres

    HD void operator()(uint32_t i) const {
        const Rgb scattered = rgb_of(signals.diffuse[i]) * divisor_of(rgb_of(frame.albedo[i])) +
                              rgb_of(signals.gloss[i]) * divisor_of(rgb_of(frame.gloss[i]));
        const Rgb met = frame.light[i].w != 0 ? rgb_of(frame.emission[i]) : Rgb{0, 0, 0};
        picture[i] = with_w(met + scattered, frame.normal[i].w);
    }
};

} // namespace pertev
