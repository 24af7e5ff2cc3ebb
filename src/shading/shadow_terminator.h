#pragma once

// The shadow terminator of coarse smooth meshes. About an interpolated normal a BSDF scatters into a hemisphere of
// which a part lies behind the triangle: light from there ends at the triangle's horizon as if cut off, facet by facet,
// and what is scattered there is lost. So directions are raised towards the shading normal, by as much as clears the
// horizons of the triangle and of its neighbours wherever they join as smoothly. Across an edge the two triangles raise
// alike: the terminator is one smooth line, a little nearer to the light, and no light is lost.
//
// Source: the shift of the terminator in appleseed (Beaune 2019; shift_cos_in in Cycles), which takes the light's
// cosine at a stretched angle. Here the stretch follows from the mesh, is the identity high above the horizon, and is a
// change of variables of the whole BSDF: with wi = raise(w), the value at wi is that at w over slope = d height(wi) / d
// height (w), the ratio of solid angles. For Lambert that is a factor height(w) / (height(wi) slope) of wi; for all
// lobes the integral over wi stays what it was. Shadowing factors (Estevez et al., Ray Tracing Gems, 2019, chapter 12;
// Chiang et al., "Taming the Shadow Terminator", 2019) are at most 1 and lose light: docs/conventions.md has the
// figures.

#include "base/host_device.h"
#include "math/scalar.h"
#include "math/vec3.h"

namespace pertev {

/// Directions are moved up to this many times the tilt above the shading horizon: wide enough that the value rises
/// there at most 2.3 times as fast as it did and is nowhere more than 11 % higher, narrow enough that fine meshes keep
/// their reflections.
inline constexpr float kTerminatorReach = 6.0f;
/// Greater tilts (over 19.5 degrees) are made up for by this much only, for lobes would become narrow, and from
/// kHopelessTilt (49 degrees) not at all: a cube with smooth corners is not meant as a sphere. What then still lies
/// behind the triangle is lost.
inline constexpr float kLargestTilt = 1.0f / 3.0f, kHopelessTilt = 0.75f;
/// Less than this (0.06 degrees) is left alone: flat meshes may come with normals.
inline constexpr float kLeastTilt = 1e-3f;

/// Sine of the angle between two unit vectors; from the cross product: of small angles the cosine says nothing.
HD inline float sine_between(Vec3 a, Vec3 b) { return length(cross(a, b)); }

/// What the functions below take, from the sine of the angle between interpolated and geometric normal: `here` at the
/// point, `at_corners` interpolated from those of the triangle's three vertices. The latter hardly changes over a
/// regular mesh, so triangles do not show; the former is less but where they curl. 0 or in [kLeastTilt, kLargestTilt].
HD inline float terminator_tilt(float here, float at_corners) {
    const float sine = max(here, at_corners);
    const float tilt = min(min(sine, kLargestTilt), kHopelessTilt - sine);
    return tilt < kLeastTilt ? 0.0f : tilt;
}

struct RaisedDirection {
    Vec3 direction; // unit, shading frame
    float slope;    // d height(raised) / d height(before), (0, 1]; 0: no direction is raised to this one
};

/// `w` (unit) with its height |w.z| moved to `height`, in [0, 1].
HD inline Vec3 at_height(Vec3 w, float height) {
    const float across = w.x * w.x + w.y * w.y;
    const float scale = across > 0 ? safe_sqrt((1.0f - height) * (1.0f + height) / across) : 0.0f;
    return {scale * w.x, scale * w.y, copysign(height, w.z)};
}

/// `w` (unit, shading frame, of either side) raised by `tilt` > 0. In heights x and y over the reach and with
/// t = tilt / reach, y = t + (1 - 2t) x + t x^2: from t at the horizon, to 1 with slope 1 at the reach.
HD inline RaisedDirection raise_direction(Vec3 w, float tilt) {
    const float reach = min(kTerminatorReach * tilt, 1.0f), height = abs(w.z);
    if (height >= reach) return {w, 1.0f};
    const float t = tilt / reach, x = height / reach, rise = 1.0f - 2.0f * t;
    return {at_height(w, reach * (t + (rise + t * x) * x)), rise + 2.0f * t * x};
}

/// The direction that raise_direction turns into `wi`, and the slope there.
HD inline RaisedDirection lower_direction(Vec3 wi, float tilt) {
    const float reach = min(kTerminatorReach * tilt, 1.0f), height = abs(wi.z);
    if (height >= reach) return {wi, 1.0f};
    if (!(height > tilt)) return {wi, 0.0f};
    const float t = tilt / reach, y = height / reach, rise = 1.0f - 2.0f * t;
    const float slope = sqrt(rise * rise + 4.0f * t * (y - t));
    return {at_height(wi, reach * (2.0f * (y - t) / (rise + slope))), slope};
}

} // namespace pertev
