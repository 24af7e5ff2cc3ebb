#pragma once

// What a frame's reconstruction went by, kept to be looked at: how far each pixel's surface has moved since the frame
// before, and how much the signals stray. The frame itself stays the same.

#include "denoise/reconstruction_view.h"

namespace pertev {

struct KeepLayers {
    const Vec2* was_at;  // AccumulateSignals'
    SignalsView signals; // with the variances that lead the filter
    uint32_t width;      // pixels
    bool has_history;    // false at a cut: nothing has moved
    bool has_gloss;      // AccumulateSignals'
    Float4* layers;      // x, y: pixels to the right and down; z, w: variance of diffuse and of gloss

    HD void operator()(uint32_t i) const {
        const Vec2 centre = {static_cast<float>(i % width) + 0.5f, static_cast<float>(i / width) + 0.5f};
        const Vec2 then = has_history ? was_at[i] : centre;
        layers[i] = {centre.x - then.x, centre.y - then.y, signals.diffuse[i].w, has_gloss ? signals.gloss[i].w : 0.0f};
    }
};

} // namespace pertev
