#pragma once

// Beckmann's microfacets, whose slopes have a normal distribution, in the form of ggx.h: slope_length(z) is S(z) =
// z (1 + 2 Lambda), so masking has the formulas of that file.
//
// Source: Walter et al. 2007; Heitz 2014, section 5 (exact Lambda, not Walter's rational fit); sampling of visible
// slopes by inversion: Heitz & d'Eon, "Importance Sampling Microfacet-Based BSDFs using the Distribution of Visible
// Normals", 2014. The error function: Abramowitz & Stegun 7.1.26; its inverse: Giles, "Approximating the erfinv
// function", 2012.

#include "base/host_device.h"
#include "math/portable_math.h"
#include "math/vec2.h"
#include "math/vec3.h"

namespace pertev::beckmann {

inline constexpr float kInvSqrtPi = 0.56418958f;

/// exp(x^2) erfc(x) for x >= 0, off by at most 2e-7.
HD inline float scaled_erfc(float x) {
    const float t = 1.0f / (1.0f + 0.3275911f * x);
    return t * (0.254829592f + t * (-0.284496736f + t * (1.421413741f + t * (-1.453152027f + t * 1.061405429f))));
}
HD_CALL inline float erf(float x) { return copysign(1.0f - exp(-x * x) * scaled_erfc(abs(x)), x); }

/// Inverse of erf(), for x in (-1, 1).
HD_CALL inline float erf_inverse(float x) {
    float w = -log((1.0f - x) * (1.0f + x)), p;
    if (w < 5) {
        w -= 2.5f;
        p = 2.81022636e-08f;
        p = 3.43273939e-07f + p * w;
        p = -3.5233877e-06f + p * w;
        p = -4.39150654e-06f + p * w;
        p = 0.00021858087f + p * w;
        p = -0.00125372503f + p * w;
        p = -0.00417768164f + p * w;
        p = 0.246640727f + p * w;
        return (1.50140941f + p * w) * x;
    }
    w = sqrt(w) - 3.0f;
    p = -0.000200214257f;
    p = 0.000100950558f + p * w;
    p = 0.00134934322f + p * w;
    p = -0.00367342844f + p * w;
    p = 0.00573950773f + p * w;
    p = -0.0076224613f + p * w;
    p = 0.00943887047f + p * w;
    p = 1.00167406f + p * w;
    return (2.83297682f + p * w) * x;
}

/// S for the cosine `z` >= 0 and the width times the sine, `across`.
HD inline float slope_length(float z, float across) {
    if (!(z < 4.0f * across)) return z; // nothing is masked; also where `across` is 0
    const float a = z / across, e = exp(-a * a);
    return z + (across * kInvSqrtPi - z * scaled_erfc(a)) * e;
}

/// Samples the squared cosine of a direction for the light that one bounce loses, which is most at cosines of 1 to 2
/// widths; u in [0, 1).
HD inline float sample_lost_lobe(float alpha, float u) {
    const float wide = 0.5f * alpha * alpha, k = 0.25f / (alpha * alpha);
    float z2;
    if (u < wide) {
        z2 = sqrt(u / wide);
    } else {
        z2 = -log(1.0f - (u - wide) / (1.0f - wide) * (1.0f - exp(-k))) / k;
    }
    return clamp(z2, 0.0f, 1.0f);
}
/// Density of sample_lost_lobe() at `cosine` in [0, 1], 1/sr.
HD inline float pdf_lost_lobe(float cosine, float alpha) {
    const float wide = 0.5f * alpha * alpha, k = 0.25f / (alpha * alpha), z2 = cosine * cosine;
    return kInvPi * cosine * ((1.0f - wide) * k * exp(-k * z2) / (1.0f - exp(-k)) + wide * 2.0f * z2);
}

/// Slope towards the view of visible normals, for width 1: the view's cosine is `z` >= 0 and its sine `s`. u in [0, 1).
HD inline float sample_visible_slope(float z, float s, float u) {
    constexpr float most = 0x1.fffffep-1f;
    u = clamp(u, 1e-6f, most);
    if (!(s > 1e-6f)) return erf_inverse(clamp(2.0f * u - 1.0f, -most, most));
    // The cumulative distribution is monotone in t = erf(slope), on (-1, erf(z / s)). Newton's method within bounds
    // starts from the fit of Jakob, "An Improved Visible Normal Sampling Routine for the Beckmann Distribution", 2014.
    const float ratio = s / max(z, 1e-7f), edge = z / s, e = exp(-edge * edge), end = 1.0f - e * scaled_erfc(edge);
    const float norm = 1.0f / (1.0f + end + kInvSqrtPi * e * ratio);
    const float angle = acos(min(z, 1.0f));
    const float fit = 1.0f + angle * (-0.876f + angle * (0.4265f - 0.0594f * angle));
    float low = -most, high = min(end, most), t = end - (1.0f + end) * pow(1.0f - u, fit), slope = 0;
    for (int i = 0; i < 10; ++i) {
        if (!(t > low && t < high)) t = 0.5f * (low + high);
        slope = erf_inverse(t);
        const float error = norm * (1.0f + t + kInvSqrtPi * ratio * exp(-slope * slope)) - u;
        if (abs(error) < 1e-6f) break;
        (error > 0 ? high : low) = t;
        t -= error / (norm * (1.0f - slope * ratio));
    }
    return slope;
}

/// Samples a visible normal for width 1. `w` is unit with w.z >= 0; u in [0, 1)^2.
HD_CALL inline Vec3 sample_visible_normal(Vec3 w, Vec2 u) {
    const float s = sqrt(w.x * w.x + w.y * w.y);
    const float towards = sample_visible_slope(w.z, s, u.x);
    const float aside = erf_inverse(clamp(2.0f * u.y - 1.0f, -0x1.fffffep-1f, 0x1.fffffep-1f));
    const float cos_phi = s > 1e-6f ? w.x / s : 1.0f, sin_phi = s > 1e-6f ? w.y / s : 0.0f;
    return {-(cos_phi * towards - sin_phi * aside), -(sin_phi * towards + cos_phi * aside), 1};
}

} // namespace pertev::beckmann
