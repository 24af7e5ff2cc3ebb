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
template <class T = float>
HD inline T ggx_normals(Vec3Of<T> h, T alpha) {
    const T a2 = alpha * alpha;
    const T t = (h.x * h.x + h.y * h.y) / a2 + h.z * h.z; // from x and y, because 1 - z^2 would cancel
    return 1.0f / (kPi * a2 * (t * t));
}

/// The function S(z) of the first comment, for z in [0, 1].
template <class T>
HD inline T ggx_slope_length(T z, T alpha) {
    return sqrt(z * z + alpha * alpha * max(1.0f - z * z, T(0.0f)));
}

/// Samples a normal m with density G1(wo) max(wo . m, 0) D(m) / wo.z. wo.z >= 0; u in [0, 1]^2.
template <class T = float>
HD inline Vec3Of<T> sample_ggx_visible_normal(Vec3Of<T> wo, T alpha, Vec2Of<T> u) {
    const Vec3Of<T> w = normalize(Vec3Of<T>{alpha * wo.x, alpha * wo.y, wo.z});
    const T drop = u.y * (1.0f + w.z); // 1 - z of a point on the cap z > -w.z
    const T s = safe_sqrt(drop * (2.0f - drop));
    T sin_phi, cos_phi;
    sin_cos_2pi(u.x, sin_phi, cos_phi);
    const Vec3Of<T> h = {s * cos_phi + w.x, s * sin_phi + w.y, (1.0f - u.y) * (1.0f + w.z)};
    const Vec3Of<T> m = {alpha * h.x, alpha * h.y, h.z};
    const T length2 = length_squared(m);
    // The cap's point opposite to wo has no direction, and probability 0.
    return select(length2 > 0, (1.0f / sqrt(length2)) * m, Vec3Of<T>{0, 0, 1});
}

/// Mirror image of `wo` about the unit normal `m`.
template <class T = float>
HD inline Vec3Of<T> reflect(Vec3Of<T> wo, Vec3Of<T> m) {
    return 2.0f * dot(wo, m) * m - wo;
}

/// The single-scattering reflection lobe without Fresnel's factor, common to all GGX reflectors.
template <class T>
struct GgxReflectionOf {
    T f = 0;     // D G2 / (4 |cos(wo)|), 1/sr
    T pdf = 0;   // density of reflecting wo about a visible normal
    T cos_h = 0; // wo . h
};
using GgxReflection = GgxReflectionOf<float>;
/// Evaluates the lobe for wo.z > 0, wi.z > 0.
template <class T = float>
HD inline GgxReflectionOf<T> evaluate_ggx_reflection(Vec3Of<T> wo, Vec3Of<T> wi, T alpha) {
    const Vec3Of<T> sum = wo + wi;
    const Vec3Of<T> h = (1.0f / sqrt(length_squared(sum))) * sum;
    const T d = ggx_normals(h, alpha);
    const T so = ggx_slope_length(wo.z, alpha), si = ggx_slope_length(wi.z, alpha);
    return {d * wi.z / (2.0f * (so * wi.z + si * wo.z)), d / (2.0f * (wo.z + so)), min(abs(dot(wo, h)), T(1.0f))};
}

} // namespace pertev
