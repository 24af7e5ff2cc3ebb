// Path = Direct + Indirect: the same random numbers, so the parts of each sample add up to rounding. And light that is
// found by next-event estimation alone, by BSDF sampling alone, or by both weighted is the same light.

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "tests/support/chi_square.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

/// The mixed scene without lights that only one of the techniques can find.
Scene make_area_lit_scene() {
    Scene scene = test::make_mixed_scene();
    scene.lights.clear();
    return scene;
}

struct Estimate {
    std::vector<double> mean, variance_of_mean; // of blocks of pixels, one a channel
};

/// Means over blocks of 8 x 8 pixels, and how sure they are, from independent renders of independent samples.
Estimate estimate(LightStrategy strategy, uint32_t first_seed, uint32_t renders) {
    constexpr uint32_t width = 48, height = 32, block = 8, blocks = width / block * (height / block) * 3;
    const Scene scene = make_area_lit_scene();
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = Queue::make_cpu();
    std::vector<double> sum(blocks), square_sum(blocks);
    for (uint32_t seed = 0; seed < renders; ++seed) {
        RenderSettings settings;
        settings.width = width;
        settings.height = height;
        settings.samples = 8;
        settings.path.strategy = strategy;
        settings.path.sampler = SamplerKind::Independent;
        settings.path.seed = first_seed + seed;
        settings.path.max_depth = 5;
        const RenderResult result = render_picture(queue, prepared, test::mixed_scene_camera(), settings);
        std::vector<double> means(blocks);
        for (uint32_t i = 0; i < width * height; ++i) {
            const uint32_t at = (i / width / block * (width / block) + i % width / block) * 3;
            for (uint32_t c = 0; c < 3; ++c) {
                means[at + c] += static_cast<double>(result.picture.pixels[i * 3 + c]) / (block * block);
            }
        }
        for (uint32_t b = 0; b < blocks; ++b) {
            sum[b] += means[b];
            square_sum[b] += means[b] * means[b];
        }
    }
    Estimate result;
    for (uint32_t b = 0; b < blocks; ++b) {
        const double mean = sum[b] / renders;
        result.mean.push_back(mean);
        result.variance_of_mean.push_back((square_sum[b] / renders - mean * mean) / (renders - 1));
    }
    return result;
}

/// Two-sided p-value of the largest deviation of all, Sidak corrected.
double p_value(const Estimate& a, const Estimate& b) {
    double smallest = 1;
    for (std::size_t i = 0; i < a.mean.size(); ++i) {
        const double deviation = std::fabs(a.mean[i] - b.mean[i]);
        const double variance = a.variance_of_mean[i] + b.variance_of_mean[i];
        if (deviation == 0) continue;
        smallest = std::min(smallest, std::erfc(deviation / std::sqrt(2 * variance)));
    }
    return 1 - std::pow(1 - smallest, static_cast<double>(a.mean.size()));
}

} // namespace

TEST_CASE("direct and indirect light add up to the whole picture") {
    Queue queue = Queue::make_cpu();
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
    const auto renders = static_cast<uint32_t>(test::effort(48, 1000));
    const Estimate mis = estimate(LightStrategy::Mis, 1, renders);
    const Estimate nee = estimate(LightStrategy::NeeOnly, 100'000, renders);
    const Estimate bsdf = estimate(LightStrategy::BsdfOnly, 200'000, renders);
    CHECK(p_value(mis, nee) > 0.001);
    CHECK(p_value(mis, bsdf) > 0.001);
    // The test can see: another light, one part in twenty brighter, is another picture.
    Estimate brighter = mis;
    for (double& mean : brighter.mean) mean *= 1.05;
    CHECK(p_value(brighter, nee) < 1e-6);
}

TEST_CASE("a white sphere in a white furnace cannot be seen") {
    Queue queue = Queue::make_cpu();
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
