#pragma once

// The area of an emissive surface and the mean of its emission texture, from which flux and intensity follow.

#include "scene/scene.h"

namespace pertev {

struct EmitterSurface {
    double area = 0; // m2, of one face
    bool is_flat = true;
    double texture[3] = {1, 1, 1}; // mean of the emission texture's colours over the area, linear
};

/// Measures the instance at its present position. A texture's mean is a sum over small triangles, of about a texel
/// each if there are at most 2^24 of them.
EmitterSurface emitter_surface(const Scene& scene, const Instance& instance);

} // namespace pertev
