#pragma once

// Origin of a ray that leaves a surface: far enough from the computed hit point that rounding cannot place it on the
// other side, and no farther. It is offset from its own triangle along the normal, and kept away from the triangle's
// edges, because an offset along the normal does not separate it from the adjacent triangles.
//
// Source: Pharr, Jakob, Humphreys, "Physically Based Rendering", 4th ed., section 6.8.6 (robust spawned ray origins).

#include "base/host_device.h"
#include "math/vec3.h"

namespace pertev {

/// The next float away from zero or towards it in the direction of `sign`.
HD inline float next_float(float x, float sign) {
    if (x == 0) return copysign(float_of(1u), sign);
    const uint32_t bits = bits_of(x);
    const bool away = (x > 0) == (sign > 0);
    return float_of(away ? bits + 1 : bits - 1);
}

/// Weights of a triangle's second and third vertex.
struct PointOnTriangle {
    float u, v;
};

/// Moves the position (u, v) inwards if one of its three weights is below `least` (in [0, 1/4]). Each weight is then
/// at least 2/3 of that; nothing changes if none is below it.
HD inline PointOnTriangle keep_off_edges(float u, float v, float least) {
    const float w = 1.0f - u - v;
    if (min(w, min(u, v)) >= least) return {u, v};
    const float at_u = max(u, least), at_v = max(v, least);
    const float scale = 1.0f / (max(w, least) + at_u + at_v); // 1 to 3/2
    return {at_u * scale, at_v * scale};
}

/// Offsets `point`, whose distance to a plane with unit normal `normal` has an error of at most `error` (metres, per
/// component, >= 0), to the side of the plane that `direction` points to.
HD inline Vec3 offset_ray_origin(Vec3 point, Vec3 error, Vec3 normal, Vec3 direction) {
    const float distance = dot(abs(normal), error);
    const Vec3 offset = dot(direction, normal) < 0 ? -distance * normal : distance * normal;
    const Vec3 moved = point + offset;
    return {offset.x != 0 ? next_float(moved.x, offset.x) : moved.x,
            offset.y != 0 ? next_float(moved.y, offset.y) : moved.y,
            offset.z != 0 ? next_float(moved.z, offset.z) : moved.z};
}

} // namespace pertev
