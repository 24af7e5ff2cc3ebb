#pragma once

// What a frame's reconstruction went by, kept to be looked at: how far each pixel's surface has moved since the frame
// before, and how much the signals stray. The frame itself stays the same.

#include "denoise/reproject.h"

namespace pertev {

struct KeepLayers {
    NoisyFrameView frame;
    SceneView scene;
    PreviousScene scene_before;
    FrameCameras cameras;
    SignalsView signals; // with the variances that lead the filter
    bool has_history;    // false at a cut: nothing has moved
    Float4* layers;      // x, y: pixels to the right and down; z, w: variance of diffuse and of gloss

    HD void operator()(uint32_t i) const {
        const Vec2 centre = {static_cast<float>(i % cameras.width) + 0.5f,
                             static_cast<float>(i / cameras.width) + 0.5f};
        const Float4 place = frame.place[i];
        Vec2 then = centre;
        if (has_history) {
            then = bits_of(place.x) == kNoHit ? reproject_sky(cameras, centre)
                                              : reproject_surface(cameras, scene, scene_before, centre, place).pixel;
        }
        layers[i] = {centre.x - then.x, centre.y - then.y, signals.diffuse[i].w, signals.gloss[i].w};
    }
};

} // namespace pertev
