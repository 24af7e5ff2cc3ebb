// Particles from the lights scatter like paths from the camera: for any light and camera the transported power is the
// same number, summed over paths or over particles (render/particle_scatter.h).

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/parallel_for.h"
#include "render/particle_scatter.h"
#include "tests/statistical/bsdf_cases.h"
#include "tests/statistical/tilted_surface.h"
#include "tests/support/chi_square.h"
#include "tests/support/estimate.h"
#include "tests/support/options.h"

using namespace pertev;
using namespace pertev::test;

namespace {

/// The radiance over n^2 that arrives along w, and the importance of a camera along w: two smooth functions. Both are
/// small near the triangle's plane, where delta directions are folded back.
double light_at(const Surface& surface, Vec3 w) {
    const float height = std::fabs(dot(w, surface.geometric_normal));
    return static_cast<double>(square(max(height - 0.25f, 0.0f)) * (1.2f + w.x - 0.5f * w.y));
}
double camera_at(const Surface& surface, Vec3 w) {
    const float height = std::fabs(dot(w, surface.geometric_normal));
    return static_cast<double>(max(height - 0.3f, 0.0f) * (1.3f - 0.7f * w.x + 0.4f * w.y));
}

/// n^2 |w . Ng|
double etendue(const Surface& surface, Vec3 w) {
    const double n = dot(w, surface.geometric_normal) < 0 ? static_cast<double>(surface.bsdf.inner_ior()) : 1.0;
    return n * n * std::fabs(static_cast<double>(dot(w, surface.geometric_normal)));
}

constexpr uint32_t kSequences = 96; // independent stratified sequences, whose means differ by the error

/// Returns the power from the light to the camera. Paths start in evenly distributed directions from the camera,
/// particles from the light. Each sequence has `count` points.
Estimate transported(const Surface& surface, bool particles, uint32_t count) {
    double sum = 0, squares = 0;
    for (uint32_t sequence = 0; sequence < kSequences; ++sequence) {
        double of_sequence = 0;
        for (uint32_t i = 0; i < count; ++i) {
            const SampleKey key = {.stream = sequence, .sample = i, .seed = particles ? 31u : 32u};
            const Vec3 start = sample_uniform_sphere(sample_2d(SamplerKind::Sobol, key, 0));
            const double at_start = particles ? light_at(surface, start) : camera_at(surface, start);
            if (at_start == 0) continue; // applies to any scattered direction
            const float lobe = sample_1d(SamplerKind::Sobol, key, 1);
            const Vec2 u = sample_2d(SamplerKind::Sobol, key, 0, Pair::Last);
            const BsdfSample s = particles ? sample_adjoint(surface, start, lobe, u) : surface.sample(start, lobe, u);
            if (!(s.pdf > 0)) continue;
            const double at_end = particles ? camera_at(surface, s.wi) : light_at(surface, s.wi);
            of_sequence += at_start * at_end * etendue(surface, start) * static_cast<double>(s.weight.g) / count;
        }
        sum += of_sequence;
        squares += of_sequence * of_sequence;
    }
    const double mean = sum / kSequences;
    return {mean, std::sqrt(std::max(squares / kSequences - mean * mean, 0.0) / (kSequences - 1))};
}

std::vector<BsdfCase> cases_with_deltas() {
    std::vector<BsdfCase> cases = rough_bsdf_cases();
    cases.push_back({"smooth glass", make_dielectric(1.5f, 0, {1.0f, 0.9f, 0.7f})});
    const Vec3 bent = normalize(Vec3{0.5f, -0.3f, 1});
    cases.push_back({"rough varnish with a bent normal", make_coated(Bsdf{}, 1, 0.7f, 3, bent)});
    cases.push_back({"smooth varnish with a bent normal", make_coated(Bsdf{}, 1, 0, 3, bent)});
    cases.push_back(
        {"clear pane", make_reflection({.base_color = {0.9f, 0.6f, 0.2f}, .roughness = 0, .through = 0.6f})});
    cases.push_back({"mirror", make_conductor(kGoldEta, kGoldK, 0)});
    cases.push_back({"rough varnish on a mirror", make_coated(make_conductor(kGoldEta, kGoldK, 0), 1, 0.4f, 1.5f)});
    cases.push_back({"smooth varnish on smooth glass", make_coated(make_dielectric(1.5f, 0, grey(1)), 1, 0, 1.5f)});
    return cases;
}

} // namespace

TEST_CASE("particles carry the power of paths for every BSDF, with geometric and interpolated normals") {
    const std::vector<BsdfCase> cases = cases_with_deltas();
    const auto tilts = effort(0, 1) != 0 ? std::vector<float>{0, 0.1f, 0.3f} : std::vector<float>{0, 0.3f};
    const auto count = static_cast<uint32_t>(effort(512, 1 << 17));
    std::vector<Estimate> by_path(cases.size() * tilts.size()), by_particle(by_path.size());
    parallel_for(by_path.size(), 1, [&](uint64_t i) {
        const Surface surface = tilted_surface(cases[i / tilts.size()].bsdf, tilts[i % tilts.size()]);
        by_path[i] = transported(surface, false, count);
        by_particle[i] = transported(surface, true, count);
    });
    for (std::size_t i = 0; i < by_path.size(); ++i) {
        const Estimate &a = by_path[i], &b = by_particle[i];
        INFO(cases[i / tilts.size()].name << ", tilt " << tilts[i % tilts.size()] << ": " << a.mean << " +- " << a.error
                                          << " by paths, " << b.mean << " +- " << b.error);
        CHECK(a.mean > 0);
        CHECK(std::fabs(a.mean - b.mean) < 4.5 * std::sqrt(a.error * a.error + b.error * b.error));
        CHECK(a.error < 0.02 * a.mean);
    }
}

TEST_CASE("a particle's index changes in glass and not beyond a thin wall") {
    const Vec3 above = {0, 0, 1}, below = {0, 0, -1};
    const Surface glass = tilted_surface(make_dielectric(1.5f, 0, grey(1)), 0);
    CHECK(squared_index_beyond(glass, above, 1) == doctest::Approx(2.25));
    CHECK(squared_index_beyond(glass, below, 2.25f) == doctest::Approx(1));
    for (const float through : {0.5f, 1.0f}) {
        const Surface pane = tilted_surface(make_reflection({.base_color = grey(1), .through = through}), 0);
        CHECK(squared_index_beyond(pane, above, 2.25f) == 2.25f);
        CHECK(squared_index_along(pane, above, below, 1) == 1.0f);
    }
}

TEST_CASE("the particle test detects missing cosines of both normals") {
    const Surface surface = tilted_surface(make_diffuse(grey(1)), 0.3f);
    const Estimate by_path = transported(surface, false, 2048);
    double bare = 0; // the BSDF's own adjoint about the shading normal
    for (uint32_t i = 0; i < 100'000; ++i) {
        const SamplePoint p = random_point(i, 35), q = random_point(i, 36);
        const Vec3 wi = sample_uniform_sphere(q.u);
        const BsdfSample s = surface.bsdf.sample(wi, p.lobe, p.u);
        if (!(s.pdf > 0)) continue;
        bare += light_at(surface, wi) * camera_at(surface, s.wi) * etendue(surface, wi) *
                static_cast<double>(s.weight.g) / 100'000;
    }
    CHECK(std::fabs(bare - by_path.mean) > 10 * by_path.error);
}

TEST_CASE("a particle's direction is sampled by the adjoint's density, and its weight is value over density") {
    const std::vector<BsdfCase> cases = rough_bsdf_cases();
    constexpr float tilts[] = {0, 0.3f};
    const int tests = static_cast<int>(cases.size() * std::size(tilts));
    for (const BsdfCase& c : cases) {
        const float alpha = narrowest_alpha(c.bsdf);
        if (!(alpha > 0.05f)) continue; // too narrow for an even grid
        for (const float tilt : tilts) {
            const Surface surface = tilted_surface(c.bsdf, tilt);
            const Vec3 wi = direction_at(0.45f, 0.45f); // within the range of the raise
            const auto [result, weight_error] =
                test_tilted_sampling([&](float lobe, Vec2 u) { return sample_adjoint(surface, wi, lobe, u); },
                                     [&](Vec3 wo) { return evaluate_adjoint(surface, wi, wo); });
            INFO(c.name << ", tilt " << tilt << ", weight off by " << weight_error);
            CHECK_MESSAGE(result.passes(tests), result.describe());
            CHECK(weight_error < 0.02);
        }
    }
}

TEST_CASE("on a flat surface the adjoint is the BSDF with exchanged directions") {
    for (const BsdfCase& c : rough_bsdf_cases()) {
        const Surface surface = tilted_surface(c.bsdf, 0);
        for (uint32_t i = 0; i < 200; ++i) {
            const SamplePoint p = random_point(i, 41), q = random_point(i, 42);
            const Vec3 wi = direction_at(2.0f * p.u.x - 1.0f, p.u.y), wo = direction_at(2.0f * q.u.x - 1.0f, q.u.y);
            const BsdfValue value = evaluate_adjoint(surface, wi, wo), exchanged = c.bsdf.evaluate(wi, wo);
            CHECK(value.f.g == doctest::Approx(exchanged.f.g).epsilon(1e-4));
            CHECK(value.pdf == doctest::Approx(exchanged.pdf).epsilon(1e-4));
        }
    }
}
