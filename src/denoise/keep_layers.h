#pragma once

// Keeps intermediate results of a frame's reconstruction for inspection: the motion of each pixel's surface since the
// previous frame, and the deviation of the signals. It does not affect the frame.

#include "denoise/reconstruction_view.h"

namespace pertev {

struct KeepLayers {
    const Vec2* was_at;  // output of AccumulateSignals
    SignalsView signals; // with the variances that control the filter
    uint32_t width;      // pixels
    bool has_history;    // false at a cut: no motion
    bool has_gloss;      // see AccumulateSignals
    Float4* layers;      // x, y: pixels to the right and down; z, w: variance of the diffuse signal and of gloss

    HD void operator()(uint32_t i) const {
        const Vec2 centre = {static_cast<float>(i % width) + 0.5f, static_cast<float>(i / width) + 0.5f};
        const Vec2 then = has_history ? was_at[i] : centre;
        layers[i] = {centre.x - then.x, centre.y - then.y, max(signals.diffuse[i].w, 0.0f),
                     has_gloss ? signals.gloss[i].w : 0.0f};
    }
};

} // namespace pertev
