#pragma once

// Sampling of the lobe that compensates lost energy (energy_tables.h). That lobe is e(cos) cos with e about (alpha /
// cos)^2 for cos > alpha: a cosine lobe would miss it for small alpha and cause weights of 100. Density by solid
// angle: cos / (pi L (cos^2 + alpha^2)), L = log(1 + 1 / alpha^2); for large alpha a cosine lobe.

#include "base/host_device.h"
#include "math/portable_math.h"
#include "math/vec2.h"
#include "math/vec3.h"

namespace pertev {

template <class T>
HD inline T grazing_lobe_log(T alpha) {
    return for_each_lane(1.0f + 1.0f / (alpha * alpha), [](float x) { return log(x); });
}

/// Samples a direction above the surface; u in [0, 1]^2, alpha in [kSmoothAlpha, 1].
HD inline Vec3 sample_grazing_lobe(float alpha, Vec2 u) {
    const float z2 = clamp(alpha * alpha * (exp(u.y * grazing_lobe_log(alpha)) - 1.0f), 0.0f, 1.0f);
    const float radius = sqrt(1.0f - z2);
    float sin_phi, cos_phi;
    sin_cos_2pi(u.x, sin_phi, cos_phi);
    return {radius * cos_phi, radius * sin_phi, sqrt(z2)};
}
/// Density of sample_grazing_lobe() at `cosine` in [0, 1], 1/sr.
template <class T>
HD inline T pdf_grazing_lobe(T cosine, T alpha) {
    return kInvPi * cosine / ((cosine * cosine + alpha * alpha) * grazing_lobe_log(alpha));
}

} // namespace pertev
