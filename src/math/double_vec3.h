#pragma once

// Vectors in double, for geometry that is computed once before tracing: neither tiny nor huge triangles leave the
// range, and cancellation keeps enough digits.

#include <cmath>

#include "base/host_device.h"
#include "math/vec3.h"

namespace pertev {

struct DoubleVec3 {
    double x, y, z;
    bool operator==(const DoubleVec3&) const = default;
};

HD inline DoubleVec3 to_double(Vec3 v) {
    return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}
/// Rounds each component.
HD inline Vec3 to_float(DoubleVec3 v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}
HD inline DoubleVec3 operator+(DoubleVec3 a, DoubleVec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
HD inline DoubleVec3 operator-(DoubleVec3 a, DoubleVec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
HD inline DoubleVec3 operator/(DoubleVec3 a, double b) { return {a.x / b, a.y / b, a.z / b}; }
HD inline double dot(DoubleVec3 a, DoubleVec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
HD inline DoubleVec3 cross(DoubleVec3 a, DoubleVec3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Returns `v` at unit length for any finite length but 0, else not finite. A vector that is unit within the
/// precision of floats does not change, so the function is idempotent.
HD inline Vec3 normalize_safely(Vec3 v) {
    const float square = length_squared(v);
    if (abs(square - 1) <= 0x1p-22f) return v;
    const DoubleVec3 exact = to_double(v);
    return to_float(exact / ::sqrt(dot(exact, exact)));
}

} // namespace pertev
