#pragma once

// A camera path: keys with position and target at given times.
//
// Between keys each component follows a cubic through the keys' values. Its slope at a key is that of the parabola
// through the key and its neighbours in time (at the ends, of the line to the neighbour): the three-point Hermite
// spline. Thus position and velocity are continuous, and keys are reached at their times. It uses only products and
// sums in double, so results are equal everywhere.

#include <vector>

#include "math/double_vec3.h"

namespace pertev {

// Limits of a field of view that people state, degrees.
inline constexpr double kMinFovDeg = 0.01, kMaxFovDeg = 179;

struct CameraKey {
    double time_s = 0;
    DoubleVec3 eye = {0, 0, 0}, target = {0, 0, 0}; // metres, in the coordinates of the scene's file
    Vec3 up = {0, 1, 0};                            // any length but 0
    float fov_deg = 0;                              // full vertical field of view, degrees; 0: the camera's own
};

struct CameraPath {
    std::vector<CameraKey> keys; // at least one; times ascend; all or none have a fov_deg
};

/// The camera at `time_s`, which is finite. Before the first and after the last key it does not move.
CameraKey sample_path(const CameraPath& path, double time_s);

} // namespace pertev
