#pragma once

// Whether the lights of a scene illuminate it well enough to see it.

#include "base/sink.h"
#include "scene/scene.h"

namespace pertev {

/// Shares of the visible surfaces of a picture, [0, 1].
struct SeenShares {
    double lit = 1;   // brighter than 1/16 of middle grey
    double burnt = 0; // white, beyond 90 times middle grey
};

/// Evaluates a small picture, 64 x 36 pixels with 4 samples, or 16 where 4 leave doubt, of the scene at time 0 from its
/// first camera or else the default one, without a sky, at the exposure found for it. It depends only on the scene and
/// is the same on every machine. The scene has passed validate(). Throws Error(OverLimit) as prepare_scene() does.
/// `sink` may end it and hears no messages.
SeenShares shares_seen(const Scene& scene, Sink& sink = nobody());

/// Returns whether less than three quarters of the visible surfaces are lit, or over a sixteenth is burnt out, as by
/// labels that glow brighter than their surroundings and need another light to be read.
bool is_light_too_weak(const Scene& scene, Sink& sink);

/// Returns whether next to nothing visible is lit, because every light is out of range, turned away or enclosed. Lights
/// without extent need nothing more, because their author meant the shadows that they leave.
bool lights_nothing_seen(const Scene& scene, Sink& sink);

} // namespace pertev
