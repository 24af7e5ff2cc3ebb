#pragma once

// Completes the frame of a light with a table (scene/intensity_table.h) for those who know only in which direction it
// shines. It is apart from scene/light.h because nearly every file includes that.

#include "math/frame.h"
#include "scene/light.h"

namespace pertev {

/// Gives the light an `up` across its direction if it needs one and has none.
inline void orient_light(Light& light) {
    if (!is_oriented(light)) light.up = make_frame(light.direction).tangent;
}

} // namespace pertev
