#pragma once

// Absorption in a coat along the refracted ray, as OpenPBR Surface 1.1.1 has it (section on view-dependent absorption):
// the coat's colour is what both ways leave at normal incidence, and a way is longer by the refracted cosine. It is
// reciprocal, because it is a function of the lengths of both ways together.

#include "base/host_device.h"
#include "math/portable_pow.h"
#include "math/rgb.h"

namespace pertev {

/// Length of one way through a coat of thickness 1 and reflectance `f0` at normal incidence, seen at `cosine`.
HD inline float length_in_coat(float cosine, float f0) {
    const float root = sqrt(min(f0, 0.9999f)), inv_ior = (1.0f - root) / (1.0f + root);
    const float across2 = (1.0f - cosine * cosine) * (inv_ior * inv_ior);
    return 1.0f / sqrt(max(1.0f - across2, 1e-4f));
}

/// Factor on the light that a coat of `weight` and `albedo` transmits, 1 - weight albedo, so that together they are
/// lerp(1, absorbed (1 - albedo), weight); `passes` counts crossings both in and out at normal incidence.
HD inline Rgb coat_tint(Rgb color, float weight, float passes, float albedo) {
    const float bare = 1.0f - weight, coated = weight * (1.0f - albedo), sum = bare + coated;
    if (!(sum > 0)) return {1, 1, 1};
    const float a = bare / sum, b = coated / sum;
    return {a + b * pow(color.r, passes), a + b * pow(color.g, passes), a + b * pow(color.b, passes)};
}

} // namespace pertev
