#pragma once

// A surface whose interpolated normal leans away from its triangle's.

#include <cmath>

#include "device_scene/surface.h"

namespace pertev::test {

/// A surface whose shading normal is +z and whose triangle is turned by asin(tilt) about y.
inline Surface tilted_surface(const Bsdf& bsdf, float tilt) {
    Surface surface = {};
    surface.geometric_normal = {tilt, 0, std::sqrt(1.0f - tilt * tilt)};
    surface.frame = make_frame({0, 0, 1});
    surface.bsdf = bsdf;
    surface.tilt = terminator_tilt(tilt, 0);
    return surface;
}

} // namespace pertev::test
