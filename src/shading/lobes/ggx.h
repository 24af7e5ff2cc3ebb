#pragma once

// GGX microfacets: distribution of normals, height-correlated Smith masking, sampling of visible normals.
//
// Source: Walter et al., "Microfacet Models for Refraction through Rough Surfaces", 2007; Heitz, "Understanding the
// Masking-Shadowing Function", JCGT 3(2), 2014, section 5 and appendix A; sampling: Dupuy & Benyoub, "Sampling Visible
// GGX Normals with Spherical Caps", 2023.
// Masking never appears alone. With S(z) = sqrt(z^2 + alpha^2 (1 - z^2)),
//     G1(o) = 2 o / (o + S(o)),   G2(o, i) / (4 o i) = 1 / (2 (S(o) i + S(i) o)),
// and in that form nothing is divided by a cosine, so everything is finite down to grazing angles.

#include "base/host_device.h"
#include "math/portable_math.h"
#include "math/vec2.h"
#include "math/vec3.h"

namespace pertev {

/// Below this alpha (roughness^2) a surface counts as perfectly smooth: its lobe is narrower than 1/10 degree, and a
/// half vector of two float directions no longer resolves it well.
inline constexpr float kSmoothAlpha = 1e-3f;

/// Density of normals per projected area, 1/sr. `h` has unit length; h.z may have either sign.
HD inline float ggx_normals(Vec3 h, float alpha) {
    const float a2 = alpha * alpha;
    const float t = (h.x * h.x + h.y * h.y) / a2 + h.z * h.z; // from x and y, because 1 - z^2 would cancel
    return 1.0f / (kPi * a2 * (t * t));
}

/// The function S(z) of the first comment, for z in [0, 1].
HD inline float ggx_slope_length(float z, float alpha) { return sqrt(z * z + alpha * alpha * max(1.0f - z * z, 0.0f)); }

/// Samples a normal m with density G1(wo) max(wo . m, 0) D(m) / wo.z. wo.z >= 0; u in [0, 1]^2.
HD inline Vec3 sample_ggx_visible_normal(Vec3 wo, float alpha, Vec2 u) {
    const Vec3 w = normalize(Vec3{alpha * wo.x, alpha * wo.y, wo.z});
    const float drop = u.y * (1.0f + w.z); // 1 - z of a point on the cap z > -w.z
    const float s = safe_sqrt(drop * (2.0f - drop));
    float sin_phi, cos_phi;
    sin_cos_2pi(u.x, sin_phi, cos_phi);
    const Vec3 h = {s * cos_phi + w.x, s * sin_phi + w.y, (1.0f - u.y) * (1.0f + w.z)};
    const Vec3 m = {alpha * h.x, alpha * h.y, h.z};
    const float length2 = length_squared(m);
    if (!(length2 > 0)) return {0, 0, 1}; // the cap's point opposite to wo: probability 0
    return (1.0f / sqrt(length2)) * m;
}

/// Mirror image of `wo` about the unit normal `m`.
HD inline Vec3 reflect(Vec3 wo, Vec3 m) { return 2.0f * dot(wo, m) * m - wo; }

/// The single-scattering reflection lobe without Fresnel's factor, common to all GGX reflectors.
struct GgxReflection {
    float f = 0;     // D G2 / (4 |cos(wo)|), 1/sr
    float pdf = 0;   // density of reflecting wo about a visible normal
    float cos_h = 0; // wo . h
};
/// Evaluates the lobe for wo.z > 0, wi.z > 0.
HD inline GgxReflection evaluate_ggx_reflection(Vec3 wo, Vec3 wi, float alpha) {
    const Vec3 sum = wo + wi;
    const Vec3 h = (1.0f / sqrt(length_squared(sum))) * sum;
    const float d = ggx_normals(h, alpha);
    const float so = ggx_slope_length(wo.z, alpha), si = ggx_slope_length(wi.z, alpha);
    return {d * wi.z / (2.0f * (so * wi.z + si * wo.z)), d / (2.0f * (wo.z + so)), min(abs(dot(wo, h)), 1.0f)};
}

} // namespace pertev
