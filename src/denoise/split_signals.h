#pragma once

// First stage: from a frame's light to its two signals, with fireflies held back.

#include "denoise/reconstruction_view.h"

namespace pertev {

struct SplitSignals {
    NoisyFrameView frame;
    SignalsView signals; // their w: 0. Without the other one where the frame does not split its light: it is black
    HistoryView now;

    HD void operator()(uint32_t i) const {
        const Float4 light = frame.light[i], normal = frame.normal[i], albedo = frame.albedo[i];
        now.guide[i] = pack({vec3_of(normal), albedo.w, normal.w, bits_of(frame.place[i].x)});
        const bool is_valid = light.w != 0;
        const Rgb scattered = is_valid ? rgb_of(light) - rgb_of(frame.emission[i]) : Rgb{0, 0, 0};
        Rgb diffuse = scattered;
        if (frame.splits_light()) {
            diffuse = is_valid ? rgb_of(frame.diffuse[i]) : Rgb{0, 0, 0};
            const Rgb gloss = not_negative(scattered - diffuse);
            signals.gloss[i] = with_w(gloss / divisor_of(rgb_of(frame.gloss[i])), 0);
        }
        signals.diffuse[i] = with_w(not_negative(diffuse) / divisor_of(rgb_of(albedo)), 0);
    }

private:
    HD static Rgb not_negative(Rgb c) { return {max(c.r, 0.0f), max(c.g, 0.0f), max(c.b, 0.0f)}; }
};

} // namespace pertev
