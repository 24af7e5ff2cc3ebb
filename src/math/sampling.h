#pragma once

// Maps a point u of (0, 1)^2 to directions, disks, triangles and filters, each with its density. The maps preserve
// stratification: near points stay near. Directions are unit vectors around +z.
//
// Sources: Shirley, Chiu, "A Low Distortion Map Between Disk and Square", JGT 2(3), 1997; Heitz, "A Low-Distortion Map
// Between Triangle and Square", 2019.

#include "base/host_device.h"
#include "math/portable_trig.h"
#include "math/scalar.h"
#include "math/vec2.h"
#include "math/vec3.h"

namespace pertev {

template <class T>
struct PolarPointOf {
    T radius;       // [0, 1]
    T cosine, sine; // cosine and sine of the angle
};
using PolarPoint = PolarPointOf<float>;

/// A point of the square (-1, 1)^2 on one of its concentric squares.
template <class T>
struct SquarePointOf {
    T radius;       // half the side of its square; negative left of or below the centre, which rotates it by pi
    T ratio;        // y / x if `wide`, else x / y: from -1 to 1
    MaskOf<T> wide; // whether it lies right or left of the centre, not above or below
};

template <class T = float>
HD inline SquarePointOf<T> on_concentric_square(Vec2Of<T> u) {
    const T x = 2.0f * u.x - 1.0f, y = 2.0f * u.y - 1.0f;
    const MaskOf<T> wide = abs(x) > abs(y) || y == 0; // the angle in the centre is 0
    const T radius = select(wide, x, y), other = select(wide, y, x);
    return {radius, select(radius == 0, T(0.0f), other / radius), wide};
}

/// A uniform point of the unit disk, in polar form: concentric squares map to concentric circles.
template <class T = float>
HD inline PolarPointOf<T> sample_disk_polar(Vec2Of<T> u) {
    const SquarePointOf<T> p = on_concentric_square(u);
    T sine, cosine;
    sin_cos_2pi(0.125f * p.ratio, sine, cosine);
    const T sign = copysign(T(1.0f), p.radius);
    return {abs(p.radius), sign * select(p.wide, cosine, sine), sign * select(p.wide, sine, cosine)};
}

/// A uniform point of the unit disk; density 1/pi by area.
template <class T = float>
HD inline Vec2Of<T> sample_uniform_disk_concentric(Vec2Of<T> u) {
    const PolarPointOf<T> p = sample_disk_polar(u);
    return {p.radius * p.cosine, p.radius * p.sine};
}

/// A regular polygon inscribed in the unit circle, prepared for sampling.
struct RegularPolygon {
    float sides = 0, inv_sides = 0;
    float apothem = 0, side = 0; // distance of a side from the centre, and its length
    float turn = 0;              // angle of the middle of a side, as a part of a full turn, in [0, 1)
};

/// A uniform point of a regular polygon; density 1/area. Concentric squares map to concentric polygons, and equal
/// lengths on each to equal lengths.
template <class T = float>
HD inline Vec2Of<T> sample_regular_polygon(const RegularPolygon& polygon, Vec2Of<T> u) {
    const SquarePointOf<T> p = on_concentric_square(u);
    const T eighth = 0.125f * p.ratio, half_turn = select(p.radius < 0, T(0.5f), T(0.0f));
    const T at = (half_turn + select(p.wide, eighth, 0.25f - eighth)) * polygon.sides; // from side to side
    const T number = portable::round_to_integer(at);
    T sine, cosine;
    sin_cos_2pi(fma(number, T(polygon.inv_sides), T(polygon.turn)), sine, cosine);
    const T out = abs(p.radius) * polygon.apothem, along = abs(p.radius) * ((at - number) * polygon.side);
    return {out * cosine - along * sine, out * sine + along * cosine};
}

/// Density z/pi by solid angle; z > 0 for u inside (0, 1)^2.
template <class T = float>
HD inline Vec3Of<T> sample_cosine_hemisphere(Vec2Of<T> u) {
    const PolarPointOf<T> p = sample_disk_polar(u);
    return {p.radius * p.cosine, p.radius * p.sine, safe_sqrt(fma(-p.radius, p.radius, T(1.0f)))};
}
HD inline float pdf_cosine_hemisphere(float cos_theta) { return cos_theta > 0 ? cos_theta * kInvPi : 0.0f; }

/// The direction at height z whose angle around +z is `turns` of a full turn.
HD inline Vec3 direction_at_height(float z, float turns) {
    const float radius = safe_sqrt(fma(-z, z, 1.0f));
    float sine, cosine;
    sin_cos_2pi(turns, sine, cosine);
    return {radius * cosine, radius * sine, z};
}

HD inline Vec3 sample_uniform_sphere(Vec2 u) { return direction_at_height(1.0f - 2.0f * u.x, u.y); }
HD inline constexpr float pdf_uniform_sphere() { return 0.25f * kInvPi; }

/// A uniform direction of the hemisphere z > 0; density 1/(2 pi) by solid angle.
HD inline Vec3 sample_uniform_hemisphere(Vec2 u) { return direction_at_height(u.x, u.y); }
HD inline constexpr float pdf_uniform_hemisphere() { return 0.5f * kInvPi; }

/// A uniform direction in the cone around +z with 1 - cos(half angle) = `one_minus_cos`, in (0, 2], a parameter with
/// which narrow cones keep their precision.
HD inline Vec3 sample_uniform_cone(Vec2 u, float one_minus_cos) {
    const float depth = u.x * one_minus_cos, radius = safe_sqrt(depth * (2.0f - depth));
    float sine, cosine;
    sin_cos_2pi(u.y, sine, cosine);
    return {radius * cosine, radius * sine, 1.0f - depth};
}
/// The density of sample_uniform_cone() by solid angle inside the cone, 1/sr.
HD inline float pdf_uniform_cone(float one_minus_cos) { return 0.5f * kInvPi / one_minus_cos; }

/// Weights of the second and third vertex, uniform by area: both > 0, sum < 1 up to rounding. Density 1/area.
template <class T = float>
HD inline Vec2Of<T> sample_uniform_triangle(Vec2Of<T> u) {
    const T half = 0.5f * min(u.x, u.y); // folds the square along its diagonal continuously
    return {select(u.x < u.y, half, u.x - half), select(u.x < u.y, u.y - half, half)};
}

/// A number in (-1, 1) with density 1 - |x|.
template <class T = float>
HD inline T sample_tent(T u) {
    const MaskOf<T> is_left = u < 0.5f;
    const T root = sqrt(select(is_left, 2.0f * u, 2.0f - 2.0f * u));
    return select(is_left, root - 1.0f, 1.0f - root);
}
HD inline float pdf_tent(float x) { return max(1.0f - abs(x), 0.0f); }

} // namespace pertev
