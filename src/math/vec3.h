#pragma once

// Three numbers: a point, direction or normal. Products are evaluated left to right, unfused, so that both devices
// round equally.

#include "base/host_device.h"
#include "math/scalar.h"

namespace pertev {

/// `T` is float, or eight floats at once on the host (math/lanes.h), with the same bits in each lane.
template <class T>
struct Vec3Of {
    T x = 0, y = 0, z = 0;
    bool operator==(const Vec3Of&) const = default;

    HD friend inline Vec3Of operator+(Vec3Of a, Vec3Of b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    HD friend inline Vec3Of operator-(Vec3Of a, Vec3Of b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    HD friend inline Vec3Of operator-(Vec3Of a) { return {-a.x, -a.y, -a.z}; }
    HD friend inline Vec3Of operator*(T s, Vec3Of a) { return {s * a.x, s * a.y, s * a.z}; }
    HD friend inline Vec3Of operator*(Vec3Of a, T s) { return s * a; }
    HD friend inline Vec3Of operator/(Vec3Of a, T s) { return (1.0f / s) * a; }
    HD friend inline Vec3Of& operator+=(Vec3Of& a, Vec3Of b) { return a = a + b; }

    HD friend inline T dot(Vec3Of a, Vec3Of b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
    HD friend inline Vec3Of cross(Vec3Of a, Vec3Of b) {
        return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    }
    HD friend inline T length_squared(Vec3Of a) { return dot(a, a); }
    HD friend inline T length(Vec3Of a) { return sqrt(dot(a, a)); }
    /// Returns `a` at unit length; not finite for a zero vector.
    HD friend inline Vec3Of normalize(Vec3Of a) { return (1.0f / length(a)) * a; }

    HD friend inline Vec3Of min(Vec3Of a, Vec3Of b) { return {min(a.x, b.x), min(a.y, b.y), min(a.z, b.z)}; }
    HD friend inline Vec3Of max(Vec3Of a, Vec3Of b) { return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)}; }
    HD friend inline Vec3Of abs(Vec3Of a) { return {abs(a.x), abs(a.y), abs(a.z)}; }
    HD friend inline T max_component(Vec3Of a) { return max(a.x, max(a.y, a.z)); }
    HD friend inline auto is_finite(Vec3Of a) { return is_finite(a.x) && is_finite(a.y) && is_finite(a.z); }
    HD friend inline Vec3Of lerp(Vec3Of a, Vec3Of b, T t) { return a + t * (b - a); }

    HD friend inline Vec3Of select(MaskOf<T> condition, Vec3Of a, Vec3Of b) {
        return {select(condition, a.x, b.x), select(condition, a.y, b.y), select(condition, a.z, b.z)};
    }
    /// Returns a.x, a.y or a.z for k = 0, 1, 2, by selects, so that device code keeps `a` in registers.
    HD friend inline T component(Vec3Of a, int k) { return k == 0 ? a.x : (k == 1 ? a.y : a.z); }
};

using Vec3 = Vec3Of<float>;

} // namespace pertev
