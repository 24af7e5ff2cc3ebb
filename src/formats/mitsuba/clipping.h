#pragma once

// The clipping planes of Mitsuba's sensors, which a camera here lacks: whether they cut anything.

#include <cstdint>

#include "scene/scene.h"

namespace pertev::mitsuba {

struct Clipping {
    bool is_near = false, is_far = false; // surfaces in front of the near plane and behind the far one
};

/// Returns what the planes `near` and `far` along the view, in metres, cut off in pictures of the camera.
Clipping find_clipping(const Scene& scene, const Camera& camera, float near, float far);

} // namespace pertev::mitsuba
