#pragma once

// Vectors in double, for geometry that is made once on the host: there neither tiny nor huge triangles leave the range,
// and what cancels keeps its digits.

#include "math/vec3.h"

namespace pertev {

struct DoubleVec3 {
    double x, y, z;
};

inline DoubleVec3 to_double(Vec3 v) {
    return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}
/// Each component rounded.
inline Vec3 to_float(DoubleVec3 v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}
inline DoubleVec3 operator-(DoubleVec3 a, DoubleVec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline DoubleVec3 operator/(DoubleVec3 a, double b) { return {a.x / b, a.y / b, a.z / b}; }
inline double dot(DoubleVec3 a, DoubleVec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline DoubleVec3 cross(DoubleVec3 a, DoubleVec3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

} // namespace pertev
