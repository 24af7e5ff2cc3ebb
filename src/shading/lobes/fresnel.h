#pragma once

// Reflectance of a smooth interface for unpolarised light.
//
// Source: Born & Wolf, "Principles of Optics", 7th ed., sections 1.5.2 and 14.2; Schlick, "An Inexpensive BRDF Model
// for Physically-based Rendering", 1994; average of the dielectric: fit of Kulla & Conty, "Revisiting Physically Based
// Shading at Imageworks", 2017 (off by at most 0.007).

#include "base/host_device.h"
#include "math/rgb.h"
#include "math/scalar.h"

namespace pertev {

struct DielectricFresnel {
    float reflectance; // [0, 1]
    float cos_t;       // cosine of refraction, >= 0; 0 under total reflection
};

/// Reflectance of a dielectric and the refracted cosine. `cos_o` is in [0, 1]; `eta` is the refractive index of the far
/// side over that of the near side.
HD inline DielectricFresnel fresnel_dielectric(float cos_o, float eta) {
    // 1 - sin^2 / eta^2, written so that nothing cancels at grazing angles.
    const float c2 = cos_o * cos_o, e2 = eta * eta;
    const float cos2_t = ((e2 - 1.0f) + c2) / e2;
    if (!(cos2_t > 0)) return {1.0f, 0.0f};
    const float cos_t = sqrt(cos2_t);
    const float s = (cos_o - eta * cos_t) / (cos_o + eta * cos_t);
    const float p = (eta * cos_o - cos_t) / (eta * cos_o + cos_t);
    return {min(0.5f * (s * s + p * p), 1.0f), cos_t};
}

/// Returns 1 - reflectance for cosines that obey Snell's law. Nothing cancels near total reflection, and the result
/// from the other side (exchanged cosines, 1 / eta) is equal.
HD inline float transmittance_dielectric(float cos_o, float cos_t, float eta) {
    const float s = cos_o + eta * cos_t, p = eta * cos_o + cos_t;
    return 2.0f * eta * cos_o * cos_t * (1.0f / (s * s) + 1.0f / (p * p));
}

/// Average of the reflectance over a cosine-weighted hemisphere of the near side.
HD inline float fresnel_dielectric_average(float eta) {
    if (eta == 1) return 0;
    const float up = eta > 1 ? eta : 1.0f / eta; // from the thinner side
    const float from_thin = (up - 1.0f) / (4.08567f + 1.00071f * up);
    // Light that enters can leave: (1 - F) n^2 is equal from both sides.
    return eta > 1 ? from_thin : 1.0f - (1.0f - from_thin) / (up * up);
}

/// Reflectance of a conductor with the complex index eta + i k (over that of the outside); `cos_o` in [0, 1], eta >= 0,
/// k >= 0.
HD inline float fresnel_conductor(float cos_o, float eta, float k) {
    const float c2 = cos_o * cos_o, s2 = max(1.0f - c2, 0.0f);
    const float eta2 = eta * eta, k2 = k * k;
    const float t0 = eta2 - k2 - s2;
    const float a2_plus_b2 = sqrt(t0 * t0 + 4.0f * eta2 * k2);
    const float a = safe_sqrt(0.5f * (a2_plus_b2 + t0));
    const float t1 = a2_plus_b2 + c2, t2 = 2.0f * a * cos_o;
    if (!(t1 + t2 > 0)) return 1; // grazing with an index of 1
    const float s = (t1 - t2) / (t1 + t2);
    const float t3 = c2 * a2_plus_b2 + s2 * s2, t4 = t2 * s2;
    const float p = t3 + t4 > 0 ? s * (t3 - t4) / (t3 + t4) : s;
    return clamp(0.5f * (s + p), 0.0f, 1.0f);
}

HD inline Rgb fresnel_conductor(float cos_o, Rgb eta, Rgb k) {
    return {fresnel_conductor(cos_o, eta.r, k.r), fresnel_conductor(cos_o, eta.g, k.g),
            fresnel_conductor(cos_o, eta.b, k.b)};
}

/// Average reflectance over a cosine-weighted hemisphere: two-point Gauss rule for the weight 2 cos.
HD inline Rgb fresnel_conductor_average(Rgb eta, Rgb k) {
    return 0.36391724f * fresnel_conductor(0.35505103f, eta, k) + 0.63608276f * fresnel_conductor(0.84494897f, eta, k);
}

/// Schlick's weight, (1 - cos_o)^5.
template <class T>
HD inline T schlick_weight(T cos_o) {
    const T x = clamp(1.0f - cos_o, 0.0f, 1.0f);
    return x * x * (x * x) * x;
}
/// Schlick's approximation; `f0` is the reflectance at normal incidence, and that at grazing incidence is 1.
template <class T>
HD inline RgbOf<T> fresnel_schlick(T cos_o, RgbOf<T> f0) {
    const T w = schlick_weight(cos_o);
    return {f0.r + (1.0f - f0.r) * w, f0.g + (1.0f - f0.g) * w, f0.b + (1.0f - f0.b) * w};
}
/// Average of Schlick's approximation over a cosine-weighted hemisphere, exact.
template <class T>
HD inline T fresnel_schlick_average(T f0) {
    return f0 + (1.0f - f0) * (1.0f / 21.0f);
}
template <class T>
HD inline RgbOf<T> fresnel_schlick_average(RgbOf<T> f0) {
    return {fresnel_schlick_average(f0.r), fresnel_schlick_average(f0.g), fresnel_schlick_average(f0.b)};
}
/// The fraction of b (x (1 - x)^6) that F82 takes from Schlick's reflectance; `tint` in [0, 1] is the factor at the
/// cosine 1/7, about 82 degrees.
HD inline float f82_drop(float f0, float tint) {
    constexpr float weight = 0.46266437f, inv_most = 17.6513846f; // (6/7)^5, 7 (7/6)^6
    return (f0 + (1.0f - f0) * weight) * (1.0f - tint) * inv_most;
}
/// Schlick's approximation with a tint near grazing incidence (Kutz, Hasan & Edmondson, "Novel Aspects of the Adobe
/// Standard Material", 2021).
HD inline float fresnel_f82(float cos_o, float f0, float tint) {
    const float w = schlick_weight(cos_o);
    return clamp(f0 + (1.0f - f0) * w - f82_drop(f0, tint) * (cos_o * w * (1.0f - cos_o)), 0.0f, 1.0f);
}
HD inline Rgb fresnel_f82(float cos_o, Rgb f0, Rgb tint) {
    return {fresnel_f82(cos_o, f0.r, tint.r), fresnel_f82(cos_o, f0.g, tint.g), fresnel_f82(cos_o, f0.b, tint.b)};
}
/// Average of fresnel_f82() over a cosine-weighted hemisphere. The clamp, which is left out, would only raise it.
HD inline Rgb fresnel_f82_average(Rgb f0, Rgb tint) {
    const auto of = [](float at_normal, float factor) {
        return max(fresnel_schlick_average(at_normal) - (1.0f / 126.0f) * f82_drop(at_normal, factor), 0.0f);
    };
    return {of(f0.r, tint.r), of(f0.g, tint.g), of(f0.b, tint.b)};
}
/// Reflectance at normal incidence of a dielectric.
HD inline float f0_from_ior(float ior) { return square((ior - 1.0f) / (ior + 1.0f)); }

} // namespace pertev
