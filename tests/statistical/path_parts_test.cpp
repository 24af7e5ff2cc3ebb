// Path = Direct + Indirect: the same random numbers, so the parts of each sample add up to rounding. And light that is
// found by next-event estimation alone, by BSDF sampling alone, or by both weighted is the same light.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

/// The mixed scene without lights that only one of the techniques can find, and without lobes so narrow that light
/// sampling alone meets them once in a million draws: a mean without that draw looks certain, and is off.
Scene make_area_lit_scene() {
    Scene scene = test::make_mixed_scene();
    scene.lights.clear();
    for (Material& material : scene.materials) {
        if (material.kind != MaterialKind::Dielectric) material.roughness = max(material.roughness, 0.6f);
    }
    return scene;
}

/// Of every channel of every pixel, and last of the whole picture: its mean and the variance of that, from independent
/// renders of independent samples.
struct PathEstimate {
    std::vector<double> mean, variance_of_mean;
};

constexpr uint32_t kWidth = 24, kHeight = 16, kPartsPixels = kWidth * kHeight;
constexpr uint32_t kRenders = 64; // the fewer, the less a variance is known: hence Student's t below

PathEstimate estimate(LightStrategy strategy, uint32_t first_seed) {
    RenderSettings settings;
    settings.width = kWidth;
    settings.height = kHeight;
    settings.samples = static_cast<uint32_t>(test::effort(64, 1024));
    settings.path.strategy = strategy;
    settings.path.sampler = SamplerKind::Independent;
    settings.path.max_depth = 5;
    const Scene scene = make_area_lit_scene();
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = test::queue_asked_for();
    const std::size_t count = std::size_t(3) * kPartsPixels + 3;
    std::vector<double> sum(count), square_sum(count);
    for (uint32_t seed = 0; seed < kRenders; ++seed) {
        settings.path.seed = first_seed + seed;
        const RenderResult result = render_picture(queue, prepared, test::mixed_scene_camera(), settings);
        std::vector<double> values(result.picture.pixels.begin(), result.picture.pixels.end());
        values.resize(count);
        for (std::size_t i = 0; i < 3 * kPartsPixels; ++i) values[3 * kPartsPixels + i % 3] += values[i] / kPartsPixels;
        for (std::size_t i = 0; i < count; ++i) {
            const double value = values[i];
            sum[i] += value;
            square_sum[i] += value * value;
        }
    }
    PathEstimate result;
    for (std::size_t i = 0; i < count; ++i) {
        const double mean = sum[i] / kRenders;
        result.mean.push_back(mean);
        result.variance_of_mean.push_back(std::max(0.0, square_sum[i] / kRenders - mean * mean) / (kRenders - 1));
    }
    return result;
}

/// Chance of |T| >= t where T is Student's, by its integral over atan(t / sqrt(degrees)).
double student_p_value(double t, double degrees) {
    constexpr int kSteps = 1000; // Simpson's rule
    const double from = std::atan(t / std::sqrt(degrees)), step = (1.5707963267948966 - from) / kSteps;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
        const double weight = i == 0 ? 1 : i % 2 == 1 ? 4 : 2;
        sum += weight * std::pow(std::cos(from + i * step), degrees - 1);
    }
    const double log_scale = std::lgamma(0.5 * (degrees + 1)) - std::lgamma(0.5 * degrees);
    return std::min(1.0, 2 * std::exp(log_scale) / std::sqrt(3.141592653589793) * sum * step / 3);
}

/// Two-sided p-value of the largest deviation of all, Sidak corrected; of two means by Welch's test.
double p_value(const PathEstimate& a, const PathEstimate& b) {
    double smallest = 1;
    for (std::size_t i = 0; i < a.mean.size(); ++i) {
        const double deviation = std::fabs(a.mean[i] - b.mean[i]);
        const double va = a.variance_of_mean[i], vb = b.variance_of_mean[i], variance = va + vb;
        if (deviation == 0) continue;
        if (variance == 0) return 0;
        const double degrees = (kRenders - 1) * variance * variance / (va * va + vb * vb);
        smallest = std::min(smallest, student_p_value(deviation / std::sqrt(variance), degrees));
    }
    return -std::expm1(static_cast<double>(a.mean.size()) * std::log1p(-smallest));
}

/// Brighter in those pixels whose means are off by more than `least_error`, as those of the background are not.
PathEstimate brightened(PathEstimate e, double factor, double least_error) {
    for (std::size_t i = 0; i < 3 * kPartsPixels; ++i) {
        if (!(std::sqrt(e.variance_of_mean[i]) > least_error * e.mean[i])) continue;
        e.mean[3 * kPartsPixels + i % 3] += (factor - 1) * e.mean[i] / kPartsPixels;
        e.mean[i] *= factor;
    }
    return e;
}

} // namespace

TEST_CASE("direct and indirect light add up to the whole picture") {
    Queue queue = test::queue_asked_for();
    RenderSettings settings;
    settings.width = 48;
    settings.height = 27;
    settings.samples = 4;
    const Scene scene = test::make_mixed_scene();
    std::vector<Image> parts;
    for (const PathLight light : {PathLight::Path, PathLight::Direct, PathLight::Indirect}) {
        settings.path.light = light;
        parts.push_back(test::render(queue, scene, test::mixed_scene_camera(), settings).picture);
    }
    double direct = 0, indirect = 0;
    for (std::size_t i = 0; i < parts[0].pixels.size(); ++i) {
        const float whole = parts[0].pixels[i];
        CHECK(parts[1].pixels[i] + parts[2].pixels[i] == doctest::Approx(static_cast<double>(whole)).epsilon(1e-5));
        direct += static_cast<double>(parts[1].pixels[i]);
        indirect += static_cast<double>(parts[2].pixels[i]);
    }
    CHECK(direct > 0);
    CHECK(indirect > 0.02 * direct); // most of the picture is sky
}

TEST_CASE("next-event estimation, BSDF sampling and both weighted converge to one picture") {
    const PathEstimate mis = estimate(LightStrategy::Mis, 1);
    const PathEstimate nee = estimate(LightStrategy::NeeOnly, 100'000);
    const PathEstimate bsdf = estimate(LightStrategy::BsdfOnly, 200'000);
    CHECK(p_value(mis, nee) > 0.001);
    CHECK(p_value(mis, bsdf) > 0.001);
    // The test can see, on a picture 2 % brighter where means are off by 0.2 % or more, and on one 5 % brighter where
    // they are off by 1 % or more, which is what light transport does to most pixels here. (1 % and 2 % it cannot.)
    const double error = static_cast<double>(test::effort(4, 1)) / 4; // sixteen times the samples in the long setting
    for (const PathEstimate& brighter : {brightened(mis, 1.02, 2e-3 * error), brightened(mis, 1.05, 1e-2 * error)}) {
        CHECK(p_value(brighter, nee) < 1e-6);
        CHECK(p_value(brighter, bsdf) < 1e-6);
    }
}

TEST_CASE("a white sphere in a white furnace cannot be seen") {
    Queue queue = test::queue_asked_for();
    RenderSettings settings;
    settings.width = settings.height = 24;
    settings.samples = 64;
    settings.path.max_depth = 64;
    Camera camera;
    camera.world_from_camera = look_at({0, 0, 3}, {0, 0, 0}, {0, 1, 0});
    for (const LightStrategy strategy : {LightStrategy::Mis, LightStrategy::BsdfOnly}) {
        settings.path.strategy = strategy;
        const RenderResult white = test::render(queue, test::make_furnace_scene(1.0f), camera, settings);
        const RenderResult half = test::render(queue, test::make_furnace_scene(0.5f), camera, settings);
        double sum = 0, covered = 0, grey_sum = 0;
        for (uint32_t y = 8; y < 16; ++y) {
            for (uint32_t x = 8; x < 16; ++x) { // within the sphere
                sum += static_cast<double>(white.picture.at(x, y)[0]);
                grey_sum += static_cast<double>(half.picture.at(x, y)[0]);
                covered += 1;
            }
        }
        CHECK(sum / covered == doctest::Approx(1.0).epsilon(0.01));
        CHECK(grey_sum / covered == doctest::Approx(0.5).epsilon(0.01));
    }
}
