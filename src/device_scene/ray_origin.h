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
template <class T = float>
HD inline T next_float(T x, T sign) {
    const WordOf<T> bits = bits_of(x);
    const MaskOf<T> away = (x > 0) == (sign > 0);
    return select(x == 0, copysign(T(float_of(1u)), sign), float_of<T>(select(away, bits + 1u, bits - 1u)));
}

/// Weights of a triangle's second and third vertex.
template <class T>
struct PointOnTriangleOf {
    T u, v;
};
using PointOnTriangle = PointOnTriangleOf<float>;

/// Moves the position (u, v) inwards if one of its three weights is below `least` (in [0, 1/4]). Each weight is then
/// at least 2/3 of that; nothing changes if none is below it.
template <class T = float>
HD inline PointOnTriangleOf<T> inset_barycentrics(T u, T v, T least) {
    const T w = 1.0f - u - v;
    const MaskOf<T> is_near = !(min(w, min(u, v)) >= least);
    if (!any(is_near)) return {u, v};
    const T at_u = max(u, least), at_v = max(v, least);
    const T scale = 1.0f / (max(w, least) + at_u + at_v); // 1 to 3/2
    return {select(is_near, at_u * scale, u), select(is_near, at_v * scale, v)};
}

/// Offsets `point`, whose distance to a plane with unit normal `normal` has an error of at most `error` (metres, per
/// component, >= 0), to the side of the plane that `direction` points to.
template <class T = float>
HD inline Vec3Of<T> offset_ray_origin(Vec3Of<T> point, Vec3Of<T> error, Vec3Of<T> normal, Vec3Of<T> direction) {
    const T distance = dot(abs(normal), error);
    const Vec3Of<T> offset = select(dot(direction, normal) < 0, -distance, distance) * normal;
    const Vec3Of<T> moved = point + offset;
    return {select(offset.x != 0, next_float(moved.x, offset.x), moved.x),
            select(offset.y != 0, next_float(moved.y, offset.y), moved.y),
            select(offset.z != 0, next_float(moved.z, offset.z), moved.z)};
}

} // namespace pertev
