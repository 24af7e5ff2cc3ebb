#pragma once

// A density over the unit square that is bilinear between four corners, and its sampling. The inversion samples y
// from the marginal, which is linear, and then x from the conditional, which is linear too. It preserves
// stratification.
//
// Source: Pharr, Jakob, Humphreys, "Physically Based Rendering", 4th edition, 2023, sections 2.3.2 and A.5.1.

#include "base/host_device.h"
#include "math/scalar.h"
#include "math/vec2.h"

namespace pertev {

/// Samples x in [0, 1] by `u` in [0, 1] with a density proportional to lerp(a, b, x); a, b > 0.
HD inline float sample_linear(float u, float a, float b) {
    return min(u * (a + b) / (a + sqrt(lerp(a * a, b * b, u))), 1.0f);
}

/// The density proportional to the bilinear interpolation of its corners, each within [2^-20, 2^20].
struct BilinearPatch {
    float f00, f10, f01, f11; // at (0, 0), (1, 0), (0, 1) and (1, 1)

    /// Returns the density at `p` in the unit square; its integral over the square is 1.
    HD float pdf(Vec2 p) const {
        return 4.0f * lerp(lerp(f00, f10, p.x), lerp(f01, f11, p.x), p.y) / (f00 + f10 + (f01 + f11));
    }

    HD Vec2 sample(Vec2 u) const {
        const float y = sample_linear(u.y, f00 + f10, f01 + f11);
        return {sample_linear(u.x, lerp(f00, f01, y), lerp(f10, f11, y)), y};
    }
};

} // namespace pertev
