#pragma once

// Reflectance of a thin transparent film on a base, in linear Rec. 709 under D65: soap bubbles, oil, anodised metal.
//
// Source: Belcour & Barla, "A Practical Extension to Microfacet Theory for the Modeling of Varying Iridescence", 2017.
// They sum Airy's series term by term in Gaussians. Here Airy's sum is computed as a whole at 36 wave numbers, because
// its series converges slowly at grazing angles on metal. The weights of a channel are fitted to the Fourier transform
// of its sensitivity (CIE 1931, D65). Each reflection fades with its path, so that the sharp peaks of many reflections,
// which fall between the wave numbers, and thick films have no colours that the eye would not see.
// tests/statistical/thin_film_test.cpp has Airy's sum by wavelengths.

#include "base/host_device.h"
#include "math/portable_math.h"
#include "math/rgb.h"
#include "math/scalar.h"
#include "shading/lobes/fresnel.h"

namespace pertev {

struct ThinFilm {
    float weight = 0;    // [0, 1], of the reflectance with the film
    float ior = 1.3f;    // >= 1
    float thickness = 0; // micrometres
};

namespace thin_film {

inline constexpr int kWaves = 36;
inline constexpr float kFirstWave = 1.36f, kWaveStep = 1.14f / 35; // wave numbers, 1/micrometre
inline constexpr float kCoherence = 40, kFadedPath = 26;           // micrometres

/// Weight of wave number `i` in each channel.
HD inline Rgb weight_of_wave(int i) {
    static constexpr float kOf[kWaves][3] = {
        {0.00032f, -0.00005f, 0.00004f},  {0.00101f, -0.00010f, 0.00007f},  {0.00293f, -0.00034f, 0.00001f},
        {0.00889f, -0.00094f, 0.00003f},  {0.02523f, -0.00270f, -0.00015f}, {0.05694f, -0.00575f, -0.00034f},
        {0.10992f, -0.01020f, -0.00094f}, {0.17479f, -0.01289f, -0.00184f}, {0.23667f, -0.00995f, -0.00352f},
        {0.25471f, 0.00556f, -0.00573f},  {0.22133f, 0.03192f, -0.00836f},  {0.17058f, 0.06682f, -0.01162f},
        {0.10519f, 0.09857f, -0.01424f},  {0.04195f, 0.12295f, -0.01585f},  {-0.00910f, 0.13923f, -0.01634f},
        {-0.04721f, 0.14189f, -0.01493f}, {-0.07190f, 0.13713f, -0.01188f}, {-0.08110f, 0.11848f, -0.00694f},
        {-0.07601f, 0.09303f, 0.00124f},  {-0.06251f, 0.06695f, 0.01161f},  {-0.04681f, 0.04476f, 0.02326f},
        {-0.03550f, 0.02957f, 0.03856f},  {-0.02705f, 0.01862f, 0.06327f},  {-0.01744f, 0.00827f, 0.09043f},
        {-0.00732f, -0.00104f, 0.11805f}, {0.00141f, -0.00763f, 0.13538f},  {0.00833f, -0.01190f, 0.13869f},
        {0.01244f, -0.01381f, 0.13164f},  {0.01377f, -0.01380f, 0.11618f},  {0.01227f, -0.01164f, 0.09130f},
        {0.00956f, -0.00880f, 0.06551f},  {0.00668f, -0.00598f, 0.04351f},  {0.00364f, -0.00324f, 0.02306f},
        {0.00195f, -0.00169f, 0.01205f},  {0.00088f, -0.00078f, 0.00545f},  {0.00057f, -0.00047f, 0.00335f}};
    return {kOf[i][0], kOf[i][1], kOf[i][2]};
}

/// Amplitudes of the reflection at the film and at the base, for both polarisations.
struct Amplitudes {
    float s12, p12, s23, p23;

    HD Amplitudes(float cos_o, float cos_f, float film, float base) {
        const float cos_b = safe_sqrt(1.0f - (1.0f - cos_o * cos_o) / (base * base));
        s12 = (cos_o - film * cos_f) / (cos_o + film * cos_f);
        p12 = (film * cos_o - cos_f) / (film * cos_o + cos_f);
        s23 = (film * cos_f - base * cos_b) / (film * cos_f + base * cos_b);
        p23 = (base * cos_f - film * cos_b) / (base * cos_f + film * cos_b);
    }
    /// Transmittance for a cosine of the phase between successive reflections (Airy's sum), each of which is fainter by
    /// the factor `kept`. The mean over all phases does not depend on that.
    HD float transmittance(float cosine, float kept) const {
        return 0.5f * (transmittance_of(s12, s23, cosine, kept) + transmittance_of(p12, p23, cosine, kept));
    }

private:
    HD static float transmittance_of(float r12, float r23, float cosine, float kept) {
        const float x = r12 * r23, y = kept * x;
        const float mean = (1.0f - r12 * r12) * (1.0f - r23 * r23) / (1.0f - x * x);
        return mean * (1.0f - y * y) / (1.0f + y * (y + 2.0f * cosine));
    }
};

} // namespace thin_film

/// Reflectance of the film, regardless of its weight, on a base of index `base` >= 1 per channel. `cos_o` in [0, 1] is
/// that outside.
HD_CALL inline Rgb film_reflectance(float cos_o, const ThinFilm& film, Rgb base) {
    using namespace thin_film;
    if (!(cos_o > 1e-4f)) return {1, 1, 1};
    const float cos_f = safe_sqrt(1.0f - (1.0f - cos_o * cos_o) / (film.ior * film.ior));
    const float path = 2.0f * film.ior * film.thickness * cos_f;
    const float kept = exp(-path / kCoherence) * clamp(0.1f * (kFadedPath - path), 0.0f, 1.0f);
    const Amplitudes r(cos_o, cos_f, film.ior, base.r), g(cos_o, cos_f, film.ior, base.g),
        b(cos_o, cos_f, film.ior, base.b);
    const bool is_grey = base.r == base.g && base.r == base.b; // dielectrics are, for a third of the work
    Rgb passed = {0, 0, 0};
    for (int i = 0; i < kWaves; ++i) {
        const float turns = (kFirstWave + kWaveStep * static_cast<float>(i)) * path;
        float sine, cosine;
        sin_cos_2pi(turns - floor(turns), sine, cosine);
        Rgb through = grey(r.transmittance(cosine, kept));
        if (!is_grey) through.g = g.transmittance(cosine, kept), through.b = b.transmittance(cosine, kept);
        passed += weight_of_wave(i) * through;
    }
    return {clamp(1.0f - passed.r, 0.0f, 1.0f), clamp(1.0f - passed.g, 0.0f, 1.0f), clamp(1.0f - passed.b, 0.0f, 1.0f)};
}

/// Index of a base that reflects `f0` in [0, 1] at normal incidence.
HD inline float ior_from_f0(float f0) {
    const float root = sqrt(clamp(f0, 0.0f, 0.9999f));
    return (1.0f + root) / (1.0f - root);
}
HD inline Rgb ior_from_f0(Rgb f0) { return {ior_from_f0(f0.r), ior_from_f0(f0.g), ior_from_f0(f0.b)}; }

} // namespace pertev
