#pragma once

// Whether what gives light in a scene lights it well enough to see it by.

#include "scene/scene.h"

namespace pertev {

/// Shares of the surfaces that a picture shows, [0, 1].
struct SeenShares {
    double lit = 1;   // brighter than 1/16 of middle grey
    double burnt = 0; // white, beyond 90 times middle grey
};

/// Judges a small picture, 64 x 36 pixels of 16 samples, of the scene at time 0 from its first camera or else the
/// made-up one, without a sky, at the exposure that is found for it. A function of the scene alone, the same on every
/// machine. The scene has been through validate(). Throws Error(OverLimit) as prepare_scene() does.
SeenShares shares_seen(const Scene& scene);

/// The light is too weak where less than three quarters of what is shown is lit; or where over a sixteenth is burnt, as
/// labels are that glow past what is behind them: they dazzle, and would be read by another light.
bool is_light_too_weak(const Scene& scene);

/// Whether next to nothing of what is shown is lit, as where every light is out of range, turned away or walled in. Of
/// lights without a size no more is asked: whoever placed them meant the shadows that they leave.
bool lights_nothing_seen(const Scene& scene);

} // namespace pertev
