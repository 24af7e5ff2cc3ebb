#pragma once

// Describes a camera by settings and their values, which place the same camera when they are given again.

#include <string>

#include "math/double_vec3.h"
#include "scene/camera.h"

namespace pertev {

/// Returns "`eye=0,1,3` `target=0,1,2` `up=0,1,0` `projection=perspective` `fov=39.3`" with the
/// vertical field of view in degrees. The lens is left out: the laboratory's rays pass through its centre.
std::string describe_camera(const Camera& camera, DoubleVec3 origin = {0, 0, 0});

} // namespace pertev
