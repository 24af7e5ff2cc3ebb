// Reflectance of thin films (shading/lobes/thin_film.h) against Airy's sum, wavelength by wavelength.

#include <doctest/doctest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "shading/lobes/thin_film.h"

using namespace pertev;

namespace {

// CIE 1931 standard observer times illuminant D65 from 380 to 780 nm in steps of 10 nm, with a luminance of 1 in all
// (CIE 018:2019, tables 1 and 6).
constexpr double kObserved[41][3] = {
    {0.000065, 0.000002, 0.000305}, {0.000219, 0.000006, 0.001037}, {0.001121, 0.000031, 0.005313},
    {0.003767, 0.000105, 0.017954}, {0.011880, 0.000354, 0.057077}, {0.023286, 0.000951, 0.113651},
    {0.034559, 0.002282, 0.173358}, {0.037224, 0.004207, 0.196206}, {0.032418, 0.006689, 0.186081},
    {0.021233, 0.009888, 0.139950}, {0.010491, 0.015249, 0.089174}, {0.003296, 0.021418, 0.047896},
    {0.000507, 0.033423, 0.028145}, {0.000949, 0.051310, 0.016138}, {0.006274, 0.070402, 0.007759},
    {0.016865, 0.087838, 0.004296}, {0.028689, 0.094249, 0.002005}, {0.042675, 0.097956, 0.000861},
    {0.056254, 0.094152, 0.000369}, {0.069470, 0.086781, 0.000191}, {0.083053, 0.078856, 0.000150},
    {0.086126, 0.063526, 0.000092}, {0.090466, 0.053741, 0.000068}, {0.085003, 0.042646, 0.000029},
    {0.070906, 0.031617, 0.000016}, {0.050629, 0.020885, 0.000004}, {0.035474, 0.013860, 0.000002},
    {0.021468, 0.008103, 0.000000}, {0.012516, 0.004630, 0.000000}, {0.006805, 0.002491, 0.000000},
    {0.003465, 0.001259, 0.000000}, {0.001498, 0.000542, 0.000000}, {0.000770, 0.000278, 0.000000},
    {0.000407, 0.000147, 0.000000}, {0.000169, 0.000061, 0.000000}, {0.000095, 0.000034, 0.000000},
    {0.000049, 0.000018, 0.000000}, {0.000020, 0.000007, 0.000000}, {0.000007, 0.000003, 0.000000},
    {0.000005, 0.000002, 0.000000}, {0.000002, 0.000001, 0.000000}};

/// Airy's sum for one polarisation: reflectance of a film for light of one wavelength.
double airy(double r12, double r23, double path_nm, double wavelength_nm) {
    const std::complex<double> turn = std::polar(1.0, 2 * std::numbers::pi * path_nm / wavelength_nm);
    return std::norm((r12 + r23 * turn) / (1.0 + r12 * r23 * turn));
}

struct Channels {
    double rgb[3];
};

Channels exact(double cosine, double film, double thickness_nm, double base) {
    const double sine2 = 1 - cosine * cosine, cf = std::sqrt(1 - sine2 / (film * film)),
                 cb = std::sqrt(1 - sine2 / (base * base)), path = 2 * film * thickness_nm * cf;
    const double s12 = (cosine - film * cf) / (cosine + film * cf), p12 = (film * cosine - cf) / (film * cosine + cf);
    const double s23 = (film * cf - base * cb) / (film * cf + base * cb),
                 p23 = (base * cf - film * cb) / (base * cf + film * cb);
    double xyz[3] = {}, white[3] = {};
    for (int nm = 380; nm < 780; ++nm) {
        const int row = (nm - 380) / 10;
        const double part = (nm - 380) % 10 / 10.0;
        const double r = 0.5 * (airy(s12, s23, path, nm) + airy(p12, p23, path, nm));
        for (int i = 0; i < 3; ++i) {
            const double observed = (1 - part) * kObserved[row][i] + part * kObserved[row + 1][i];
            xyz[i] += observed * r;
            white[i] += observed;
        }
    }
    constexpr double kToRgb[3][3] = {
        {3.2404542, -1.5371385, -0.4985314}, {-0.9692660, 1.8760108, 0.0415560}, {0.0556434, -0.2040259, 1.0572252}};
    Channels result = {};
    for (int c = 0; c < 3; ++c) {
        double value = 0, of_white = 0;
        for (int i = 0; i < 3; ++i) {
            value += kToRgb[c][i] * xyz[i];
            of_white += kToRgb[c][i] * white[i];
        }
        result.rgb[c] = std::fmin(std::fmax(value / of_white, 0.0), 1.0);
    }
    return result;
}

} // namespace

TEST_CASE("a thin film of 0 to 1200 nm reflects as Airy's sum over the wavelengths, within 0.03 a channel") {
    double worst = 0;
    for (const float film : {1.2f, 1.33f, 1.8f, 2.4f})
        for (const float base : {1.3f, 1.5f, 2.5f, 8.0f, 30.0f}) // the last two are metals of 60 and 87 %
            for (const float cosine : {1.0f, 0.8f, 0.5f, 0.25f, 0.1f, 0.02f})
                for (int nm = 0; nm <= 1200; nm += 20) {
                    const Rgb ours = film_reflectance(cosine, {1, film, 1e-3f * static_cast<float>(nm)}, grey(base));
                    const Channels there =
                        exact(static_cast<double>(cosine), static_cast<double>(film), nm, static_cast<double>(base));
                    const float channels[] = {ours.r, ours.g, ours.b};
                    for (int c = 0; c < 3; ++c) {
                        const double error = std::fabs(static_cast<double>(channels[c]) - there.rgb[c]);
                        CAPTURE(film);
                        CAPTURE(base);
                        CAPTURE(cosine);
                        CAPTURE(nm);
                        CAPTURE(c);
                        if (!(error < 0.03)) CHECK(error < 0.03);
                        worst = std::fmax(worst, error);
                    }
                }
    MESSAGE("largest error " << worst);
    CHECK(worst < 0.03);
}

TEST_CASE("a film of the base's index, or of no thickness, reflects as the base alone") {
    for (const float cosine : {1.0f, 0.6f, 0.2f}) {
        const float base = fresnel_dielectric(cosine, 1.5f).reflectance;
        const Rgb same = film_reflectance(cosine, {1, 1.5f, 0.5f}, grey(1.5f)),
                  none = film_reflectance(cosine, {1, 2.0f, 0}, grey(1.5f));
        CHECK(same.g == doctest::Approx(base).epsilon(1e-3));
        CHECK(none.r == doctest::Approx(base).epsilon(0.002));
        CHECK(none.b == doctest::Approx(base).epsilon(0.002));
    }
    CHECK(ior_from_f0(0.04f) == doctest::Approx(1.5f).epsilon(1e-5));
}
