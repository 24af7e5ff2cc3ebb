// Every BSDF's sample() follows its pdf(), its weight is eval / pdf, and the mean weight is the integral of eval.
// Directions are counted in a chart about the mirror direction, so that narrow lobes cover many cells.

#include <doctest/doctest.h>

#include <algorithm>
#include <span>
#include <type_traits>
#include <vector>

#include "base/parallel_for.h"
#include "tests/statistical/bsdf_cases.h"
#include "tests/support/chi_square.h"
#include "tests/support/direction_chart.h"
#include "tests/support/options.h"

using namespace pertev;
using namespace pertev::test;

namespace {

struct SamplingReport {
    ChiSquareResult chi_square;
    double weight_error = 0;    // largest |weight pdf - eval| / |eval|
    double pdf_error = 0;       // largest |sample's pdf - pdf()| / pdf()
    double mean_deviations = 0; // |mean weight - integral of eval| in standard errors, the worst channel
    double unreachable = 0;     // the largest eval() where pdf() is 0
};

/// Evaluates a BSDF's value and density together. BSDFs with a deliberate fault have their own eval() and pdf().
template <class AnyBsdf>
BsdfValue value_of(const AnyBsdf& bsdf, Vec3 wo, Vec3 wi) {
    if constexpr (std::is_same_v<AnyBsdf, Bsdf>) {
        return bsdf.evaluate(wo, wi);
    } else {
        return {bsdf.eval(wo, wi), bsdf.pdf(wo, wi)};
    }
}

/// The numbers of cells of the chart, away from its axis and around it. A fault spread over the chart needs samples in
/// proportion to the square root of the number of cells.
struct ChartGrid {
    int across = 12, around = 8;
};

template <class AnyBsdf>
SamplingReport test_sampling(const AnyBsdf& bsdf, Vec3 wo, const DirectionChart& chart, std::span<const double> jumps,
                             uint32_t samples, uint32_t seed, ChartGrid grid = {}) {
    const int across = grid.across, around = grid.around, cells = across * around;
    std::vector<double> observed(cells + 1), expected(cells + 1);
    SamplingReport report;
    double sum[3] = {}, squares[3] = {};
    for (uint32_t i = 0; i < samples; i++) {
        const SamplePoint p = random_point(i, seed);
        const BsdfSample s = bsdf.sample(wo, p.lobe, p.u);
        if (!(s.pdf > 0) || s.is_delta()) {
            observed[cells] += 1;
            continue;
        }
        const auto at = chart.point_of(s.wi);
        const int x = std::min(static_cast<int>(at.x * across), across - 1);
        const int y = std::min(static_cast<int>(at.y * around), around - 1);
        observed[static_cast<size_t>(y * across + x)] += 1;

        const double weight[3] = {static_cast<double>(s.weight.r), static_cast<double>(s.weight.g),
                                  static_cast<double>(s.weight.b)};
        for (int c = 0; c < 3; c++) {
            sum[c] += weight[c];
            squares[c] += weight[c] * weight[c];
        }
        if (i % 4 != 0) continue; // checking a sample takes as long as drawing it
        const BsdfValue value = value_of(bsdf, wo, s.wi);
        const double pdf = static_cast<double>(value.pdf), drawn = static_cast<double>(s.pdf);
        const Rgb f = value.f;
        report.pdf_error = std::max(report.pdf_error, std::fabs(drawn - pdf) / pdf);
        report.weight_error = std::max(report.weight_error, std::fabs(weight[1] * drawn - static_cast<double>(f.g)) /
                                                                static_cast<double>(f.g));
    }

    double total[4] = {};
    for (int k = 0; k < cells; k++) {
        const int x = k % across, y = k / across;
        const ChartRectangle cell = {double(x) / across, double(x + 1) / across, double(y) / around,
                                     double(y + 1) / around};
        const auto value_and_density = [&](Vec3 wi) {
            const BsdfValue v = value_of(bsdf, wo, wi);
            if (!(v.pdf > 0)) {
                report.unreachable = std::max(report.unreachable, static_cast<double>(max_component(v.f)));
            }
            return ChartIntegral{{static_cast<double>(v.f.r), static_cast<double>(v.f.g), static_cast<double>(v.f.b),
                                  static_cast<double>(v.pdf)}};
        };
        const ChartIntegral part = integrate_over(chart, cell, 1.5e-6, value_and_density, jumps);
        expected[static_cast<size_t>(k)] = samples * part.value[3];
        for (int c = 0; c < 4; c++) total[c] += part.value[c];
    }
    // Failed samples have their own cell.
    expected[cells] = samples * (1 - total[3]);
    // Rounding may put a sample next to the horizon into a cell behind it. With so small a count that cell is pooled
    // with other rare cells.
    for (double& count : expected) count = std::max(count, 1e-3);
    report.chi_square = chi_square(observed, expected);
    report.chi_square.integral = total[3];
    if (total[3] > 1 + 1e-4) report.chi_square.p_value = 0;
    for (int c = 0; c < 3; c++) {
        const double mean = sum[c] / samples, variance = std::max(squares[c] / samples - mean * mean, 0.0);
        const double error = std::sqrt(variance / samples) + 2e-5; // the second is for the integration
        report.mean_deviations = std::max(report.mean_deviations, std::fabs(mean - total[c]) / error);
    }
    return report;
}

/// Returns the chart about the mirror direction of wo, with the width of a GGX lobe of roughness alpha.
DirectionChart chart_for(Vec3 wo, float alpha) {
    if (alpha > 0.3f || alpha < kSmoothAlpha) return {make_frame(Vec3{0, 0, 1}), 1.0};
    return {make_frame(normalize(Vec3{-wo.x, -wo.y, wo.z})), static_cast<double>(alpha)};
}

/// Index of the far side over that of the near side.
float eta_from(const Bsdf& bsdf, Vec3 wo) { return wo.z > 0 ? bsdf.inner_ior() : 1.0f / bsdf.inner_ior(); }

/// Returns the chart about the refracted direction.
DirectionChart chart_through(Vec3 wo, const Bsdf& glass) {
    const float eta = eta_from(glass, wo), across = std::sqrt(1.0f - wo.z * wo.z);
    const float down = std::sqrt(std::max(1.0f - square(across / eta), 0.0f));
    const Vec3 wi = normalize(Vec3{-wo.x / eta, -wo.y / eta, wo.z > 0 ? -down : down});
    return {make_frame(wi), std::max(0.5 * static_cast<double>(narrowest_alpha(glass)), 0.02)};
}

/// Returns the heights of wi at which eval() and pdf() may be discontinuous: the horizon and, for glass, the direction
/// whose half vector lies in the surface, in each channel. No microfacet refracts beyond that.
std::vector<double> jumps_of(const Bsdf& bsdf, Vec3 wo) {
    std::vector<double> jumps = {0};
    const Rgb iors = inner_iors(bsdf);
    for (const float ior : {iors.r, iors.g, iors.b}) {
        const double height = -static_cast<double>(wo.z) / static_cast<double>(wo.z > 0 ? ior : 1.0f / ior);
        if (ior != 1 && height != jumps.back()) jumps.push_back(height);
    }
    return jumps;
}

/// Numbers of tested lobes by kind and parameter, so that a kind without a test is noticed.
struct TestedLobes {
    int kinds[static_cast<int>(LobeKind::Fuzz) + 1] = {};
    int dispersed = 0, filmed = 0, filmed_glass = 0, tinted_metal = 0, bent_coats = 0, stretched_bent_coats = 0;
    int beckmann[3] = {}, single[3] = {}, stretched[3] = {}; // reflections and metals, glass, thin walls
    int stacks_of_three_or_more = 0;

    void count(const Microfacets& widths, int what) {
        beckmann[what] += widths.is_beckmann ? 1 : 0;
        single[what] += widths.is_single ? 1 : 0;
        stretched[what] += widths.x != widths.y ? 1 : 0;
    }
    void count(const Lobe& lobe) {
        ++kinds[static_cast<int>(lobe.kind)];
        if (lobe.kind == LobeKind::Metal) count(lobe.metal.unpacked().widths, 0);
        if (lobe.kind == LobeKind::Thin) count(lobe.thin.widths, 2);
        if (lobe.kind == LobeKind::Filmed) {
            const FilmedLobe reflection = lobe.filmed.unpacked();
            count(reflection.widths, 0);
            filmed += reflection.film.weight > 0 ? 1 : 0;
            tinted_metal += reflection.tint == Rgb{1, 1, 1} ? 0 : 1;
        }
        if (lobe.kind == LobeKind::Glass) {
            const GlassLobe glass = lobe.glass.unpacked();
            count(glass.widths, 1);
            dispersed += glass.spread > 0 ? 1 : 0;
            filmed_glass += glass.film.weight > 0 ? 1 : 0;
        }
        if (lobe.kind == LobeKind::Coat && lobe.coat.normal.z < 1) {
            ++bent_coats;
            stretched_bent_coats += lobe.coat.wide_and_turn.bits != 0 ? 1 : 0;
        }
    }
};

} // namespace

TEST_CASE("the bsdfs whose sampling is tested have every kind of lobe, every parameter of one, and stacks of three") {
    TestedLobes all;
    for (const BsdfCase& c : rough_bsdf_cases()) {
        all.count(c.bsdf.base);
        for (int i = 0; i < c.bsdf.layer_count; ++i) all.count(c.bsdf.layers[i]);
        all.stacks_of_three_or_more += c.bsdf.layer_count + (c.bsdf.base.kind == LobeKind::None ? 0 : 1) >= 3 ? 1 : 0;
    }
    for (std::size_t kind = 1; kind < std::size(all.kinds); ++kind) {
        INFO("LobeKind " << kind);
        CHECK(all.kinds[kind] > 0);
    }
    for (const int what : {0, 1, 2}) {
        CAPTURE(what);
        CHECK(all.beckmann[what] > 0);
        CHECK(all.single[what] > 0);
        CHECK(all.stretched[what] > 0);
    }
    CHECK(all.dispersed > 0);
    CHECK(all.filmed > 0);
    CHECK(all.filmed_glass > 0);
    CHECK(all.tinted_metal > 0);
    CHECK(all.bent_coats > all.stretched_bent_coats);
    CHECK(all.stretched_bent_coats > 0);
    CHECK(all.stacks_of_three_or_more >= 8);
}

TEST_CASE("every bsdf samples directions by its pdf, with the weight eval over pdf") {
    const auto samples = static_cast<uint32_t>(effort(60'000, 10'000'000));
    const auto angles = effort(0, 1) != 0 ? std::vector<float>{1, 0.9f, 0.5f, 0.2f, 0.03f, -0.03f, -0.3f, -0.8f}
                                          : std::vector<float>{0.85f, -0.25f};
    const ChartGrid grid = effort(0, 1) != 0 ? ChartGrid{30, 20} : ChartGrid{};
    const std::vector<BsdfCase> cases = rough_bsdf_cases();
    const int tests = static_cast<int>(2 * cases.size() * angles.size());
    std::vector<SamplingReport> reports(cases.size() * angles.size());
    parallel_for(reports.size(), 1, [&](uint64_t i) {
        const Bsdf& bsdf = cases[i / angles.size()].bsdf;
        const Vec3 wo = direction_at(angles[i % angles.size()]);
        const float alpha = narrowest_alpha(bsdf);
        const bool through = bsdf.base.kind == LobeKind::Dielectric && alpha < 0.3f;
        const DirectionChart chart = through ? chart_through(wo, bsdf) : chart_for(wo, alpha);
        const auto seed = static_cast<uint32_t>(i + 1);
        reports[i] = test_sampling(bsdf, wo, chart, jumps_of(bsdf, wo), samples, seed, grid);
    });
    for (std::size_t i = 0; i < reports.size(); ++i) {
        const SamplingReport& report = reports[i];
        INFO(cases[i / angles.size()].name << " from cos(wo) = " << angles[i % angles.size()] << ": "
                                           << report.chi_square.describe());
        CHECK(report.chi_square.passes(tests));
        CHECK(report.mean_deviations < 5);
        CHECK(report.weight_error < 1e-4);
        CHECK(report.pdf_error < 1e-4);
        CHECK(report.unreachable == 0);
    }
}

TEST_CASE("sheen of all widths samples directions by its pdf, seen from the horizon to the zenith") {
    const auto samples = static_cast<uint32_t>(effort(40'000, 4'000'000));
    const std::vector<double> horizon = {0};
    uint32_t seed = 500;
    for (const float roughness : {0.1f, 0.35f, 1.0f})
        for (const float cosine : {1.0f, 0.4f, -0.08f, 0.004f}) {
            const Vec3 wo = direction_at(cosine);
            const SamplingReport report =
                test_sampling(make_sheen(Bsdf{}, grey(1), roughness), wo, chart_for(wo, 1), horizon, samples, ++seed);
            INFO("roughness " << roughness << ", cos(wo) " << cosine << ": " << report.chi_square.describe());
            CHECK(report.chi_square.passes(12));
            CHECK(report.mean_deviations < 5);
            CHECK(report.weight_error < 1e-4);
            CHECK(report.pdf_error < 1e-4);
            CHECK(report.unreachable == 0);
        }
}

namespace {

/// A diffuse BSDF whose pdf lacks the cosine.
struct NoCosineInPdf : Bsdf {
    float pdf(Vec3 wo, Vec3 wi) const { return wo.z * wi.z > 0 ? 0.5f * kInvPi : 0.0f; }
};

/// A diffuse BSDF whose value lacks the cosine.
struct NoCosineInEval : Bsdf {
    Rgb eval(Vec3 wo, Vec3 wi) const { return wo.z * wi.z > 0 ? kInvPi * base.diffuse.albedo : Rgb{}; }
};

/// Rough metal whose pdf lacks the energy compensation lobe.
struct ForgottenLobe : Bsdf {
    float pdf(Vec3 wo, Vec3 wi) const {
        return wi.z > 0 ? evaluate_ggx_reflection(wo, wi, base.conductor.alpha).pdf : 0.0f;
    }
};

/// Rough metal whose samples have weights that are 2 % too large.
struct BrightWeights : Bsdf {
    BsdfSample sample(Vec3 wo, float u_lobe, Vec2 u) const {
        BsdfSample s = Bsdf::sample(wo, u_lobe, u);
        s.weight = 1.02f * s.weight;
        return s;
    }
};

} // namespace

TEST_CASE("the sampling test detects a missing cosine, a missing lobe and weights that are too large") {
    const Vec3 wo = direction_at(0.7f);
    const DirectionChart chart = chart_for(wo, 1);
    const std::vector<double> horizon = {0};
    const NoCosineInPdf pdf = {make_diffuse(grey(0.5f))};
    CHECK_FALSE(test_sampling(pdf, wo, chart, horizon, 100'000, 1).chi_square.passes(1000));
    const NoCosineInEval eval = {make_diffuse(grey(0.5f))};
    const SamplingReport of_eval = test_sampling(eval, wo, chart, horizon, 100'000, 1);
    CHECK(of_eval.chi_square.passes(1));
    CHECK(of_eval.mean_deviations > 5);
    CHECK(of_eval.weight_error > 1e-2);
    const ForgottenLobe lobe = {make_conductor(kGoldEta, kGoldK, 0.5f)};
    CHECK_FALSE(test_sampling(lobe, wo, chart, horizon, 100'000, 1).chi_square.passes(1000));
    const BrightWeights bright = {make_conductor(kGoldEta, kGoldK, 0.5f)};
    const SamplingReport of_bright = test_sampling(bright, wo, chart, horizon, 100'000, 1);
    CHECK(of_bright.chi_square.passes(1));
    CHECK(of_bright.mean_deviations > 5);
    CHECK(of_bright.weight_error > 1e-2);
}

TEST_CASE("the integrals over a chart's cells include slivers next to a discontinuity") {
    // Integrates the caps above the horizon and above a circle just below it.
    const std::vector<double> heights = {0, -0.1333};
    const auto caps = [&](Vec3 d) {
        const double z = static_cast<double>(d.z);
        return ChartIntegral{{z > heights[0] ? 1.0 : 0.0, z > heights[1] ? 1.0 : 0.0, 1}};
    };
    for (const float axis : {1.0f, 0.5f, 0.03f, -0.03f, -0.8f})
        for (const double width : {1.0, 0.05}) {
            const DirectionChart chart = {make_frame(direction_at(axis)), width};
            double total[3] = {};
            for (int k = 0; k < 600; k++) {
                const ChartRectangle cell = {(k % 30) / 30.0, (k % 30 + 1) / 30.0, (k / 30) / 20.0,
                                             (k / 30 + 1) / 20.0};
                const ChartIntegral part = integrate_over(chart, cell, 1.5e-6, caps, heights);
                for (int c = 0; c < 3; c++) total[c] += part.value[c];
            }
            const double turn = 2 * 3.141592653589793;
            INFO("axis at height " << axis << ", width " << width);
            CHECK(std::fabs(total[0] - turn) < 1e-5);
            CHECK(std::fabs(total[1] - turn * (1 - heights[1])) < 1e-5);
            CHECK(std::fabs(total[2] - turn * 2) < 1e-5);
        }
}
