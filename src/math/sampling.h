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

struct PolarPoint {
    float radius;       // [0, 1]
    float cosine, sine; // cosine and sine of the angle
};

/// A uniform point of the unit disk, in polar form: concentric squares map to concentric circles.
HD inline PolarPoint sample_disk_polar(Vec2 u) {
    const float x = 2.0f * u.x - 1.0f, y = 2.0f * u.y - 1.0f;
    const bool wide = abs(x) > abs(y);
    const float radius = wide ? x : y;
    if (radius == 0) return {0, 1, 0};
    float sine, cosine;
    sin_cos_2pi(0.125f * (wide ? y / x : x / y), sine, cosine);
    // A negative radius rotates the point by pi.
    const float sign = copysign(1.0f, radius);
    return wide ? PolarPoint{abs(radius), sign * cosine, sign * sine}
                : PolarPoint{abs(radius), sign * sine, sign * cosine};
}

/// A uniform point of the unit disk; density 1/pi by area.
HD inline Vec2 sample_uniform_disk_concentric(Vec2 u) {
    const PolarPoint p = sample_disk_polar(u);
    return {p.radius * p.cosine, p.radius * p.sine};
}

/// A direction with density z/pi by solid angle; z > 0 for u inside (0, 1)^2.
HD inline Vec3 sample_cosine_hemisphere(Vec2 u) {
    const PolarPoint p = sample_disk_polar(u);
    return {p.radius * p.cosine, p.radius * p.sine, safe_sqrt(fma(-p.radius, p.radius, 1.0f))};
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

/// A uniform point of a triangle by the weights of its second and third vertex: both > 0, sum < 1 up to rounding.
/// Density 1/area.
HD inline Vec2 sample_uniform_triangle(Vec2 u) {
    const float half = 0.5f * min(u.x, u.y); // folds the square along its diagonal continuously
    return u.x < u.y ? Vec2{half, u.y - half} : Vec2{u.x - half, half};
}

/// A number in (-1, 1) with density 1 - |x|.
HD inline float sample_tent(float u) { return u < 0.5f ? sqrt(2.0f * u) - 1.0f : 1.0f - sqrt(2.0f - 2.0f * u); }
HD inline float pdf_tent(float x) { return max(1.0f - abs(x), 0.0f); }

} // namespace pertev
