#pragma once

// The size of a surface that gives light, and what its emission's texture leaves of that: what its flux and its
// intensity go by.

#include "scene/scene.h"

namespace pertev {

struct LampSurface {
    double area = 0; // m2, both faces as one
    bool is_flat = true;
    double texture[3] = {1, 1, 1}; // mean of the emission texture's colours over the area, linear
};

/// As the instance stands. A texture's mean is a sum over small triangles, of about a texel each where there are not
/// more than 2^24 of them.
LampSurface lamp_surface(const Scene& scene, const Instance& instance);

} // namespace pertev
