#pragma once

// Whether the surfaces that glow light a scene well enough to see it by.

#include "scene/scene.h"

namespace pertev {

/// Judges a small picture, 64 x 36 pixels of 16 samples, of the scene at time 0 from its first camera or else the
/// made-up one, without a sky, at the exposure that is found for it. The light is too weak where less than three
/// quarters of the surfaces that it shows comes out brighter than 1/16 of middle grey. A function of the scene alone,
/// the same on every machine. The scene has been through validate() and gives light. Throws Error(OverLimit) as
/// prepare_scene() does.
bool is_light_too_weak(const Scene& scene);

/// The share of the picture's surfaces that can be seen, [0, 1]; 1 where it shows none.
double share_lit(const Scene& scene);

} // namespace pertev
