#include "shading/lobes/fresnel.h"

#include <doctest/doctest.h>

#include <cmath>
#include <complex>

using namespace pertev;

namespace {

/// The textbook formula in complex double arithmetic. n is the index of the far side relative to the near side.
double reflectance(double cosine, std::complex<double> n) {
    const std::complex<double> far = std::sqrt(1.0 - (1.0 - cosine * cosine) / (n * n));
    const std::complex<double> s = (cosine - n * far) / (cosine + n * far);
    const std::complex<double> p = (n * cosine - far) / (n * cosine + far);
    return 0.5 * (std::norm(s) + std::norm(p));
}

template <class F>
double cosine_average(F f) { // 2 int f(mu) mu dmu, midpoints
    constexpr int kSteps = 20'000;
    double sum = 0;
    for (int i = 0; i < kSteps; i++) {
        const double mu = (i + 0.5) / kSteps;
        sum += 2 * mu * f(mu) / kSteps;
    }
    return sum;
}

} // namespace

TEST_CASE(
    "dielectric transmittance is 1 minus reflectance to 1e-6 of itself down to grazing angles, equal from both sides") {
    for (const float eta : {1.1f, 1.33f, 1.5f, 2.4f, 3.0f})
        for (const float cosine : {1e-6f, 1e-4f, 0.01f, 0.3f, 0.7f, 1.0f}) {
            const double c = cosine, n = eta, far = std::sqrt(1 - (1 - c * c) / (n * n));
            const double s = (c - n * far) / (c + n * far), p = (n * c - far) / (n * c + far);
            const double passed = 0.5 * ((1 - s) * (1 + s) + (1 - p) * (1 + p));
            INFO("cosine " << cosine << " eta " << eta);
            const auto cos_t = static_cast<float>(far);
            CHECK(double(transmittance_dielectric(cosine, cos_t, eta)) == doctest::Approx(passed).epsilon(1e-6));
            CHECK(double(transmittance_dielectric(cos_t, cosine, 1 / eta)) == doctest::Approx(passed).epsilon(1e-6));
        }
}

TEST_CASE("dielectric reflectance agrees with complex arithmetic to 1e-5, including total reflection") {
    for (const float eta : {1.0f / 2.4f, 1.0f / 1.5f, 0.99f, 1.0f, 1.01f, 1.33f, 1.5f, 3.0f})
        for (int i = 1; i <= 1000; i++) {
            const float cosine = static_cast<float>(i) / 1000.0f;
            const DielectricFresnel f = fresnel_dielectric(cosine, eta);
            INFO("cosine " << cosine << " eta " << eta);
            // The square root at the critical angle turns rounding of 1e-7 into 3e-4.
            const double at_edge = std::fabs(1 - (1 - double(cosine) * double(cosine)) / (double(eta) * double(eta)));
            CHECK(double(f.reflectance) ==
                  doctest::Approx(reflectance(double(cosine), double(eta))).epsilon(at_edge < 1e-4 ? 2e-2 : 1e-5));
            // Snell's law.
            if (f.reflectance < 1)
                CHECK(double(eta * std::sqrt(1 - f.cos_t * f.cos_t)) ==
                      doctest::Approx(std::sqrt(1 - double(cosine) * double(cosine))).epsilon(1e-3));
        }
    CHECK(fresnel_dielectric(1, 1.5f).reflectance == doctest::Approx(0.04));
    CHECK(fresnel_dielectric(0, 1.5f).reflectance == 1);
    CHECK(fresnel_dielectric(0.5f, 1).reflectance < 1e-12f);
}

TEST_CASE("conductor reflectance agrees with complex arithmetic to 1e-4") {
    for (const float eta : {0.05f, 0.2f, 1.0f, 3.0f})
        for (const float k : {0.0f, 0.5f, 2.0f, 7.0f})
            for (int i = 1; i <= 100; i++) {
                const float cosine = static_cast<float>(i) / 100.0f;
                // A real index below 1 causes total reflection, which tests the branch of the complex root.
                if (k == 0 && eta < 1) continue;
                INFO("cosine " << cosine << " eta " << eta << " k " << k);
                const std::complex<double> n = {double(eta), double(k)};
                CHECK(std::fabs(double(fresnel_conductor(cosine, eta, k)) - reflectance(double(cosine), n)) < 1e-4);
            }
    CHECK(fresnel_conductor(0.3f, 0, 2) == doctest::Approx(1));
}

TEST_CASE("average reflectances agree with their integrals") {
    for (const float eta : {1.0f / 2.5f, 1.0f / 1.5f, 1.1f, 1.33f, 1.5f, 2.5f}) {
        INFO("eta " << eta);
        const double exact = cosine_average([eta](double mu) { return reflectance(mu, double(eta)); });
        CHECK(std::fabs(double(fresnel_dielectric_average(eta)) - exact) < 7e-3);
    }
    for (const float k : {2.0f, 4.0f}) {
        const double exact =
            cosine_average([k](double mu) { return reflectance(mu, std::complex<double>(0.9, double(k))); });
        CHECK(std::fabs(double(fresnel_conductor_average(grey(0.9f), grey(k)).g) - exact) < 7e-3);
    }
    CHECK(fresnel_schlick_average(0.04f) ==
          doctest::Approx(cosine_average([](double mu) { return 0.04 + 0.96 * std::pow(1 - mu, 5); })));
}

TEST_CASE("Schlick's approximation is exact at normal and grazing incidence") {
    CHECK(fresnel_schlick(1.0f, Rgb{0.04f, 0.5f, 1}) == Rgb{0.04f, 0.5f, 1});
    CHECK(fresnel_schlick(0.0f, Rgb{0.04f, 0.5f, 1}) == Rgb{1, 1, 1});
    CHECK(f0_from_ior(1.5f) == doctest::Approx(0.04));
}
