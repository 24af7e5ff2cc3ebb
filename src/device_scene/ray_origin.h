#pragma once

// Where a ray that leaves a surface starts: far enough off the computed hit point that rounding cannot put it on the
// other side, and no farther. Off its own triangle along the normal; off the triangles that stand on its edges by
// keeping away from these, which no move along the normal does.
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
struct PlaceOnTriangle {
    float u, v;
};

/// The place (u, v), moved in where one of its three weights is under `least` (in [0, 1/4]). Each weight is then at
/// least 2/3 of that, and as it was where none is under it.
HD inline PlaceOnTriangle keep_off_edges(float u, float v, float least) {
    const float w = 1.0f - u - v;
    if (min(w, min(u, v)) >= least) return {u, v};
    const float at_u = max(u, least), at_v = max(v, least);
    const float scale = 1.0f / (max(w, least) + at_u + at_v); // 1 to 3/2
    return {at_u * scale, at_v * scale};
}

/// `point`, known to within `error` (metres, per component, >= 0) of a plane with unit normal `normal`, moved to the
/// side of the plane that `direction` points to.
HD inline Vec3 offset_ray_origin(Vec3 point, Vec3 error, Vec3 normal, Vec3 direction) {
    const float distance = dot(abs(normal), error);
    const Vec3 offset = dot(direction, normal) < 0 ? -distance * normal : distance * normal;
    const Vec3 moved = point + offset;
    return {offset.x != 0 ? next_float(moved.x, offset.x) : moved.x,
            offset.y != 0 ? next_float(moved.y, offset.y) : moved.y,
            offset.z != 0 ? next_float(moved.z, offset.z) : moved.z};
}

} // namespace pertev
