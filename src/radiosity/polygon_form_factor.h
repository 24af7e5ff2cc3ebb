#pragma once

// Closed form factor from a point to a triangle without occlusion.
//
// Source: Lambert 1760; Baum, Rushmeier, Winget, "Improving Radiosity Solutions Through the Use of Analytically
// Determined Form-Factors", SIGGRAPH 1989, section 2: the sum over the polygon's edges of the angle that each covers
// times the cosine between the receiver's normal and the normal of the plane through edge and place.

#include "math/portable_math.h"
#include "math/vec3.h"

namespace pertev {

/// Form factor from a point to a triangle. `corner` is in metres from the point; `normal` is the receiver's, unit. The
/// part in front of the receiver counts, whichever side of the triangle faces it.
inline float triangle_form_factor(const Vec3 (&corner)[3], Vec3 normal) {
    Vec3 above[4]; // clipped by the receiver's plane
    int count = 0;
    for (int i = 0; i < 3; ++i) {
        const Vec3 a = corner[i], b = corner[(i + 1) % 3];
        const float height_a = dot(a, normal), height_b = dot(b, normal);
        if (height_a > 0) above[count++] = a;
        if ((height_a > 0) != (height_b > 0)) above[count++] = a + (height_a / (height_a - height_b)) * (b - a);
    }
    float sum = 0;
    for (int i = 0; i < count; ++i) {
        const Vec3 a = above[i], b = above[(i + 1) % count];
        const Vec3 across = cross(a, b);
        const float sine = length(across);
        if (sine > 0) sum += atan2(sine, dot(a, b)) * dot(across, normal) / sine;
    }
    return min(abs(sum) * (0.5f * kInvPi), 1.0f);
}

} // namespace pertev
