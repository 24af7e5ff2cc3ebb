#pragma once

// The phase function of Henyey and Greenstein: how a medium distributes the directions of scattered light. It depends
// on the angle between the light's directions before and after, and integrates to 1 over the sphere.
//
// Source: Henyey, Greenstein, "Diffuse Radiation in the Galaxy", 1941; sampling: Pharr, Jakob, Humphreys, "Physically
// Based Rendering", 4th ed., section 11.3.1.

#include "math/frame.h"
#include "math/sampling.h"

namespace pertev {

/// Returns the density, 1/sr, of an angle with this cosine between both directions of travel. The mean cosine `g` is in
/// (-1, 1).
HD inline float henyey_greenstein(float g, float cosine) {
    const float size = abs(g), rest = 1.0f - size;
    // 1 + g^2 - 2 g cosine, without cancellation where it is small
    const float spread = fma(2.0f * size, 1.0f - copysign(1.0f, g) * cosine, rest * rest);
    return 0.25f * kInvPi * (rest * (1.0f + size)) / (spread * sqrt(spread));
}

/// Samples a direction with that density about the unit direction of travel `along`.
HD inline Vec3 sample_henyey_greenstein(float g, Vec3 along, Vec2 u) {
    float cosine = 1.0f - 2.0f * u.x;
    if (abs(g) > 0x1p-10f) {
        const float root = fma(-g, g, 1.0f) / fma(g, cosine, 1.0f);
        cosine = clamp((fma(g, g, 1.0f) - root * root) / (2.0f * g), -1.0f, 1.0f);
    }
    return normalize(make_frame(along).to_world(direction_at_height(cosine, u.y)));
}

} // namespace pertev
