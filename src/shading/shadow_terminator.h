#pragma once

// Corrects the shadow terminator of coarse smooth meshes. With an interpolated normal a BSDF scatters into a
// hemisphere of which a part lies behind the triangle: light from there is cut off at the triangle's horizon, facet
// by facet, and light scattered there is lost. So directions are raised towards the shading normal, just enough to
// clear the horizons of the triangle and of its neighbours if they join equally smoothly. On an edge both triangles
// raise equally: the terminator is one smooth line, slightly nearer to the light, and no light is lost.
//
// Source: the shift of the terminator in appleseed (Beaune 2019; shift_cos_in in Cycles), which evaluates the light's
// cosine at a stretched angle. Here the stretch follows from the mesh, is the identity high above the horizon, and is
// a change of variables of the whole BSDF: with wi = raise(w), the value at wi is that at w divided by slope = d
// height(wi) / d height(w), the ratio of solid angles. For Lambert that is a factor height(w) / (height(wi) slope);
// for all lobes the integral over wi does not change. Shadowing factors (Estevez et al., Ray Tracing Gems, 2019,
// chapter 12; Chiang et al., "Taming the Shadow Terminator", 2019) are at most 1 and lose light: docs/conventions.md
// has the figures.

#include <type_traits>

#include "base/host_device.h"
#include "math/scalar.h"
#include "math/vec3.h"

namespace pertev {

/// Height above the shading horizon, in multiples of the tilt, up to which directions are raised: wide enough that the
/// value there rises at most 2.3 times as fast as before and is nowhere more than 11 % higher, narrow enough that fine
/// meshes keep their reflections.
inline constexpr float kTerminatorReach = 6.0f;
/// Limits of the tilt. Greater ones than kLargestTilt (19.5 degrees) are corrected by only that much, because lobes
/// would become narrow, and from kHopelessTilt (49 degrees) on not at all: a cube with smooth corners is not meant as a
/// sphere. Light that then still lies behind the triangle is lost.
inline constexpr float kLargestTilt = 1.0f / 3.0f, kHopelessTilt = 0.75f;
/// The least tilt that is corrected, 0.06 degrees; smaller ones are ignored, because flat meshes may have normals.
inline constexpr float kMinTilt = 1e-3f;

/// Sine of the angle between two unit vectors, from the cross product, because the cosine is imprecise for small
/// angles.
template <class T = float>
HD inline T sine_between(Vec3Of<T> a, Vec3Of<T> b) {
    return length(cross(a, b));
}

/// Tilt for the functions below, from the sine of the angle between interpolated and geometric normal: `here` at the
/// point, `at_corners` interpolated from the triangle's three vertices. The latter hardly varies over a regular mesh,
/// so triangles are not visible; the former is smaller except where the mesh curls. The result is 0 or in
/// [kMinTilt, kLargestTilt].
template <class T = float>
HD inline T terminator_tilt(T here, std::type_identity_t<T> at_corners) {
    const T sine = max(here, at_corners);
    const T tilt = min(min(sine, T(kLargestTilt)), kHopelessTilt - sine);
    return select(tilt < kMinTilt, T(0.0f), tilt);
}

template <class T>
struct RaisedDirectionOf {
    Vec3Of<T> direction; // unit, shading frame
    T slope;             // d height(raised) / d height(before), (0, 1]; 0: no direction is raised to this one
};
using RaisedDirection = RaisedDirectionOf<float>;

/// Changes the height |w.z| of `w` (unit) to `height`, in [0, 1].
template <class T = float>
HD inline Vec3Of<T> at_height(Vec3Of<T> w, T height) {
    const T across = w.x * w.x + w.y * w.y;
    const T scale = select(across > 0, safe_sqrt((1.0f - height) * (1.0f + height) / across), T(0.0f));
    return {scale * w.x, scale * w.y, copysign(height, w.z)};
}

/// Raises `w` (unit, shading frame, on either side) by `tilt` > 0. With heights x and y relative to the reach and t =
/// tilt / reach, y = t + (1 - 2t) x + t x^2: t at the horizon, and 1 with slope 1 at the reach.
template <class T = float>
HD inline RaisedDirectionOf<T> raise_direction(Vec3Of<T> w, T tilt) {
    const T reach = min(kTerminatorReach * tilt, T(1.0f)), height = abs(w.z);
    const MaskOf<T> is_low = !(height >= reach);
    if (!any(is_low)) return {w, T(1.0f)};
    const T t = tilt / reach, x = height / reach, rise = 1.0f - 2.0f * t;
    return {select(is_low, at_height(w, reach * (t + (rise + t * x) * x)), w),
            select(is_low, rise + 2.0f * t * x, T(1.0f))};
}

/// The direction that raise_direction maps to `wi`, and the slope there.
template <class T = float>
HD inline RaisedDirectionOf<T> lower_direction(Vec3Of<T> wi, T tilt) {
    const T reach = min(kTerminatorReach * tilt, T(1.0f)), height = abs(wi.z);
    const MaskOf<T> is_high = height >= reach, is_low = !is_high && height > tilt;
    if (!any(is_low)) return {wi, select(is_high, T(1.0f), T(0.0f))};
    const T t = tilt / reach, y = height / reach, rise = 1.0f - 2.0f * t;
    const T slope = sqrt(rise * rise + 4.0f * t * (y - t));
    return {select(is_low, at_height(wi, reach * (2.0f * (y - t) / (rise + slope))), wi),
            select(is_low, slope, select(is_high, T(1.0f), T(0.0f)))};
}

} // namespace pertev
