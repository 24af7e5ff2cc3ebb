#pragma once

// A camera as settings with their values: given back, they place the camera where it was.

#include <string>

#include "math/double_vec3.h"
#include "scene/camera.h"

namespace pertev {

/// "`eye=0,1,3` `target=0,1,2` `up=0,1,0` `projection=perspective` `fov=39.3` (vertical field of view, degrees)". The
/// lens is left out: rays of the laboratory go through its middle.
std::string describe_camera(const Camera& camera, DoubleVec3 origin = {0, 0, 0});

} // namespace pertev
