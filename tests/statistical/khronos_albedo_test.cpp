// The table of docs/materials.md: albedo by our lobes and by the formulas of Khronos's specifications, which are not
// reciprocal or lose energy, for directions at 0, 45 and 75 degrees.

#include <doctest/doctest.h>

#include <numbers>
#include <string>

#include "tests/statistical/bsdf_cases.h"

using namespace pertev;
using namespace pertev::test;

namespace {

constexpr double kAngles[] = {0, 45, 75};

/// Integral of f cos over the hemisphere for a direction at `angle` degrees, by midpoints in wi.
template <class Brdf>
double khronos_albedo(double angle, const Brdf& brdf) {
    constexpr int kAcross = 600, kAround = 240;
    const Vec3 wo = direction_at(static_cast<float>(std::cos(angle * std::numbers::pi / 180)), 0);
    double sum = 0;
    for (int i = 0; i < kAcross; ++i)
        for (int j = 0; j < kAround; ++j) {
            const Vec3 wi =
                direction_at((static_cast<float>(i) + 0.5f) / kAcross, (static_cast<float>(j) + 0.5f) / kAround);
            sum += brdf(wo, wi) * static_cast<double>(wi.z);
        }
    return sum * 2 * std::numbers::pi / (kAcross * kAround);
}

double schlick(double cosine) { return 0.04 + 0.96 * std::pow(1 - cosine, 5); }

/// D V of a roughness, as evaluate_ggx_reflection without the cosine.
double microfacets(Vec3 wo, Vec3 wi, float roughness) {
    return static_cast<double>(evaluate_ggx_reflection(wo, wi, roughness * roughness).f / wi.z);
}
double half_cosine(Vec3 wo, Vec3 wi) { return static_cast<double>(dot(wo, normalize(wo + wi))); }

double ours(const Bsdf& bsdf, double angle) {
    return mean_weight(bsdf, direction_at(static_cast<float>(std::cos(angle * std::numbers::pi / 180)), 0), 1 << 16).g;
}

struct Row {
    float roughness;
    double ours[3], khronos[3];
};

/// Prints a row of the document's table (tools/measure_tests.py).
void print_albedos(const std::string& lobe, float roughness, const double (&here)[3], const double (&there)[3]) {
    MESSAGE(lobe, ", ", roughness, ": Pertev at 0 ", here[0], ", Pertev at 45 ", here[1], ", Pertev at 75 ", here[2],
            ", formula at 0 ", there[0], ", formula at 45 ", there[1], ", formula at 75 ", there[2]);
}

template <class Make, class Brdf>
void check(const char* lobe, std::initializer_list<Row> rows, const Make& make, const Brdf& brdf) {
    for (const Row& row : rows) {
        double all_here[3] = {}, all_there[3] = {};
        for (int k = 0; k < 3; ++k) {
            const double here = ours(make(row.roughness), kAngles[k]);
            const double there =
                khronos_albedo(kAngles[k], [&](Vec3 wo, Vec3 wi) { return brdf(wo, wi, row.roughness); });
            CAPTURE(lobe);
            CAPTURE(row.roughness);
            CAPTURE(kAngles[k]);
            CHECK(here == doctest::Approx(row.ours[k]).epsilon(0.006));
            CHECK(there == doctest::Approx(row.khronos[k]).epsilon(0.006));
            all_here[k] = here, all_there[k] = there;
        }
        print_albedos(lobe, row.roughness, all_here, all_there);
    }
}

} // namespace

TEST_CASE("albedos of fuzz are those of the document, near those that MaterialX's formulas give") {
    const struct {
        float roughness;
        double ours[3], materialx[3];
    } rows[] = {{0.3f, {0.001, 0.005, 0.155}, {0.002, 0.004, 0.161}},
                {1, {0.341, 0.421, 0.616}, {0.345, 0.417, 0.613}}};
    for (const auto& row : rows) {
        double all[3] = {};
        for (int k = 0; k < 3; ++k) {
            const auto cosine = static_cast<float>(std::cos(kAngles[k] * std::numbers::pi / 180));
            const double here = mean_weight(make_fuzz(Bsdf{}, grey(1), row.roughness), direction_at(cosine), 1 << 16).g;
            CHECK(here == doctest::Approx(row.ours[k]).epsilon(0.006).scale(0.1));
            CHECK(std::abs(here - row.materialx[k]) < 0.01);
            all[k] = here;
        }
        print_albedos("Zeltner's sheen (beside MaterialX)", row.roughness, all, row.materialx);
    }
}

TEST_CASE("albedos of lobes and of Khronos's formulas are those of the document") {
    constexpr double kGrey = 0.5 / std::numbers::pi;
    check(
        "dielectric on 0.5",
        {{0.3f, {0.520, 0.521, 0.601}, {0.520, 0.522, 0.675}}, {1, {0.507, 0.509, 0.517}, {0.492, 0.495, 0.508}}},
        [](float r) { return make_metallic_roughness(grey(0.5f), 0, r, 1.5f); },
        [&](Vec3 wo, Vec3 wi, float r) {
            const double f = schlick(half_cosine(wo, wi));
            return (1 - f) * kGrey + f * microfacets(wo, wi, r);
        });
    check(
        "metal of 0.5",
        {{0.3f, {0.498, 0.498, 0.570}, {0.495, 0.494, 0.552}}, {1, {0.266, 0.290, 0.367}, {0.153, 0.189, 0.301}}},
        [](float r) { return make_metallic_roughness(grey(0.5f), 1, r, 1.5f); },
        [&](Vec3 wo, Vec3 wi, float r) {
            return (0.5 + 0.5 * std::pow(1 - half_cosine(wo, wi), 5)) * microfacets(wo, wi, r);
        });
    const auto widths = [](float r) { return anisotropic_widths(r * r, 0.7f, {1, 0}); };
    check(
        "brushed metal of 0.5 (anisotropy 0.7)",
        {{0.3f, {0.409, 0.411, 0.466}, {0.398, 0.394, 0.435}}, {0.6f, {0.380, 0.398, 0.450}, {0.326, 0.339, 0.405}}},
        [](float r) {
            return make_reflection({.base_color = grey(0.5f), .metallic = 1, .roughness = r, .anisotropy = 0.7f});
        },
        [&](Vec3 wo, Vec3 wi, float r) {
            return (0.5 + 0.5 * std::pow(1 - half_cosine(wo, wi), 5)) *
                   static_cast<double>(widths(r).evaluate_reflection(wo, wi).f / wi.z);
        });
    check(
        "coat on 0.5",
        {{0.3f, {0.503, 0.505, 0.598}, {0.520, 0.520, 0.611}}, {1, {0.504, 0.507, 0.517}, {0.492, 0.495, 0.523}}},
        [](float r) { return make_coated(make_diffuse(grey(0.5f)), 1, r, 1.5f); },
        [&](Vec3 wo, Vec3 wi, float r) {
            const double f = schlick(static_cast<double>(wo.z));
            return (1 - f) * kGrey + f * microfacets(wo, wi, r);
        });
    check(
        "sheen of 1 alone",
        {{0.3f, {0.000, 0.043, 0.403}, {0.000, 0.043, 0.404}}, {1, {0.141, 0.221, 0.389}, {0.141, 0.221, 0.389}}},
        [](float r) { return make_sheen(Bsdf{}, grey(1), r); },
        [&](Vec3 wo, Vec3 wi, float r) {
            const double alpha = static_cast<double>(r * r), cosine = static_cast<double>(normalize(wo + wi).z);
            const double d = (2 + 1 / alpha) * std::pow(1 - cosine * cosine, 0.5 / alpha) / (2 * std::numbers::pi);
            const double o = static_cast<double>(wo.z), i = static_cast<double>(wi.z);
            return d / (4 * (o + i - o * i));
        });
}
