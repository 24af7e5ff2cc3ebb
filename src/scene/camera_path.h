#pragma once

// A camera that goes from key to key: where it is and what it looks at, at given times.
//
// Between keys each number follows a cubic with the keys' values, whose slope at a key is that of the parabola through
// it and its neighbours in time (at the ends, of the line to the neighbour): the three-point Hermite spline. So place
// and speed are continuous, and keys are passed at their times. Products and sums in double alone: the same everywhere.

#include <vector>

#include "math/double_vec3.h"

namespace pertev {

struct CameraKey {
    double time_s = 0;
    DoubleVec3 eye = {0, 0, 0}, target = {0, 0, 0}; // metres, in the coordinates of the scene's file
    Vec3 up = {0, 1, 0};                            // of any length but 0
    float fov_deg = 0;                              // full vertical angle of view, degrees; 0: the camera's own
};

struct CameraPath {
    std::vector<CameraKey> keys; // at least one; times rise; all have a fov_deg, or none
};

/// The camera at `time_s`, which is finite; before the first and after the last key it stands there.
CameraKey sample_path(const CameraPath& path, double time_s);

} // namespace pertev
