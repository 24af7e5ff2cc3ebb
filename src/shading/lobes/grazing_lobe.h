#pragma once

// Sampling of the lobe that compensates lost energy (energy_tables.h). That lobe is e(cos) cos with e about (alpha /
// cos)^2 for cos > alpha: a cosine lobe would miss it for small alpha and cause weights of 100. Density by solid
// angle of the grazing lobe: cos / (pi L (cos^2 + alpha^2)), L = log(1 + 1 / alpha^2); for large alpha a cosine lobe.
//
// A mixture of that lobe, a cosine and a cosine's cube draws what metal loses, because the lobe alone is too thin
// far from the horizon (weights of 4 at roughness 0.05). The shares are those of a search over roughness and angle.

#include "base/host_device.h"
#include "math/portable_math.h"
#include "math/vec2.h"
#include "math/vec3.h"

namespace pertev {

template <class T>
HD inline T grazing_lobe_log(T alpha) {
    return for_each_lane(1.0f + 1.0f / (alpha * alpha), [](float x) { return log(x); });
}

/// Returns the direction with the squared cosine `z2` in [0, 1] at the azimuth of `u` turns.
HD inline Vec3 direction_of_squared_cosine(float z2, float u) {
    const float radius = sqrt(1.0f - z2);
    float sin_phi, cos_phi;
    sin_cos_2pi(u, sin_phi, cos_phi);
    return {radius * cos_phi, radius * sin_phi, sqrt(z2)};
}

/// Samples the squared cosine of a direction above the surface; u in [0, 1], alpha at least kSmoothAlpha.
HD inline float sample_grazing_lobe(float alpha, float u) {
    return clamp(alpha * alpha * (exp(u * grazing_lobe_log(alpha)) - 1.0f), 0.0f, 1.0f);
}
HD inline Vec3 sample_grazing_lobe(float alpha, Vec2 u) {
    return direction_of_squared_cosine(sample_grazing_lobe(alpha, u.y), u.x);
}
/// Density of sample_grazing_lobe() at `cosine` in [0, 1], 1/sr.
template <class T>
HD inline T pdf_grazing_lobe(T cosine, T alpha) {
    return kInvPi * cosine / ((cosine * cosine + alpha * alpha) * grazing_lobe_log(alpha));
}

/// Shares of the lobe of what metal loses that are drawn by a cosine to the first or third power, and to the third.
template <class T>
HD inline T wide_share_of_lost(T alpha) {
    return 0.2f + 0.5f * alpha;
}
template <class T>
HD inline T cubed_share_of_lost(T alpha) {
    return 0.8f * alpha * wide_share_of_lost(alpha);
}
inline constexpr float kLostWidth = 1.6f; // width of the grazing lobe of the rest, over alpha

/// Samples the squared cosine of a direction for the light that metal loses; u in [0, 1), alpha in [kSmoothAlpha, 1].
HD inline float sample_metal_lost(float alpha, float u) {
    const float wide = wide_share_of_lost(alpha), cubed = cubed_share_of_lost(alpha);
    const float first = u < cubed ? 0.0f : u < wide ? cubed : wide, end = u < cubed ? cubed : u < wide ? wide : 1.0f;
    const float of_part = min((u - first) / (end - first), 1.0f);
    if (u < cubed) return sqrt(of_part);
    return u < wide ? of_part : sample_grazing_lobe(kLostWidth * alpha, of_part);
}
HD inline Vec3 sample_metal_lost(float alpha, Vec2 u) {
    return direction_of_squared_cosine(sample_metal_lost(alpha, u.y), u.x);
}
/// Density of sample_metal_lost() at `cosine` in [0, 1], 1/sr.
template <class T>
HD inline T pdf_metal_lost(T cosine, T alpha) {
    const T wide = wide_share_of_lost(alpha), cubed = cubed_share_of_lost(alpha);
    return (1.0f - wide) * pdf_grazing_lobe(cosine, kLostWidth * alpha) +
           kInvPi * cosine * (wide - cubed + cubed * (2.0f * cosine * cosine));
}

} // namespace pertev
