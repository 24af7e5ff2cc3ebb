#pragma once

// Three floats: a point, direction or normal. Products are evaluated left to right, unfused, so that both devices
// round equally.

#include "base/host_device.h"
#include "math/scalar.h"

namespace pertev {

struct Vec3 {
    float x = 0, y = 0, z = 0;
    bool operator==(const Vec3&) const = default;
};

HD inline Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
HD inline Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
HD inline Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
HD inline Vec3 operator*(float s, Vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
HD inline Vec3 operator*(Vec3 a, float s) { return s * a; }
HD inline Vec3 operator/(Vec3 a, float s) { return (1.0f / s) * a; }
HD inline Vec3& operator+=(Vec3& a, Vec3 b) { return a = a + b; }

HD inline float dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
HD inline Vec3 cross(Vec3 a, Vec3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
HD inline float length_squared(Vec3 a) { return dot(a, a); }
HD inline float length(Vec3 a) { return sqrt(dot(a, a)); }
/// Returns `a` at unit length; not finite for a zero vector.
HD inline Vec3 normalize(Vec3 a) { return (1.0f / length(a)) * a; }

HD inline Vec3 min(Vec3 a, Vec3 b) { return {min(a.x, b.x), min(a.y, b.y), min(a.z, b.z)}; }
HD inline Vec3 max(Vec3 a, Vec3 b) { return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)}; }
HD inline Vec3 abs(Vec3 a) { return {abs(a.x), abs(a.y), abs(a.z)}; }
HD inline float max_component(Vec3 a) { return max(a.x, max(a.y, a.z)); }
HD inline bool is_finite(Vec3 a) { return is_finite(a.x) && is_finite(a.y) && is_finite(a.z); }
HD inline Vec3 lerp(Vec3 a, Vec3 b, float t) { return a + t * (b - a); }

/// Returns a.x, a.y or a.z for k = 0, 1, 2, by selects, so that device code keeps `a` in registers.
HD inline float component(Vec3 a, int k) { return k == 0 ? a.x : (k == 1 ? a.y : a.z); }

} // namespace pertev
