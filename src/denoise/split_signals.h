#pragma once

// First stage: from a frame's light to its two signals, with fireflies held back.

#include "denoise/reconstruction_view.h"

namespace pertev {

struct SplitSignals {
    NoisyFrameView frame;
    SignalsView signals; // their w: 0
    HistoryView now;

    HD void operator()(uint32_t i) const {
        const Float4 light = frame.light[i], normal = frame.normal[i];
        now.normal[i] = normal;
        now.object[i] = bits_of(frame.place[i].x);
        Rgb diffuse = {0, 0, 0}, gloss = {0, 0, 0};
        if (light.w != 0) {
            const Rgb scattered = rgb_of(light) - rgb_of(frame.emission[i]);
            diffuse = frame.splits_light() ? rgb_of(frame.diffuse[i]) : scattered;
            gloss = frame.splits_light() ? not_negative(scattered - diffuse) : Rgb{0, 0, 0};
        }
        signals.diffuse[i] = with_w(not_negative(diffuse) / divisor_of(rgb_of(frame.albedo[i])), 0);
        signals.gloss[i] = with_w(gloss / divisor_of(rgb_of(frame.gloss[i])), 0);
    }

private:
    HD static Rgb not_negative(Rgb c) { return {max(c.r, 0.0f), max(c.g, 0.0f), max(c.b, 0.0f)}; }
};

} // namespace pertev
