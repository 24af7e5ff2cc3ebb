// Samples of a pixel are stratified over lights, points on them and the sky. The test compares the variance of a
// light's estimate with the low-discrepancy sampler and with independent samples. A table that scrambles the order of
// the numbers reduces the variance by a factor of 2 or 3, an ordered one by 10 and more.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>

#include "integrators/path/path_state.h"
#include "tests/support/lit_scenes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

constexpr uint32_t kPixels = 2048, kSamples = 64;

/// Returns the variance of a pixel's mean of `draw` over kSamples samples, relative to the squared mean.
double relative_variance_of(const std::function<double(SampleKey)>& draw) {
    double sum = 0, squares = 0;
    for (uint32_t pixel = 0; pixel < kPixels; ++pixel) {
        double mean = 0;
        for (uint32_t i = 0; i < kSamples; ++i) mean += draw({pixel, i, 1}) / kSamples;
        sum += mean / kPixels;
        squares += mean * mean / kPixels;
    }
    return squares / (sum * sum) - 1;
}

/// Returns the factor by which stratification reduces the variance of the irradiance at the origin, facing +y.
double gain(const LightSetView& view) {
    const auto variance = [&](SamplerKind kind) {
        return relative_variance_of([&](SampleKey key) {
            LightSample sample;
            if (!sample_light(view, Vec3{0, 0, 0}, sample_bits(kind, key, kGroupCamera, Pair::Last), sample))
                return 0.0;
            return static_cast<double>(max(sample.wi.y, 0.0f)) * static_cast<double>(sample.radiance.g / sample.pdf);
        });
    };
    return variance(SamplerKind::Independent) / variance(SamplerKind::Sobol);
}

/// A square emitter of side `side` about `centre` that faces down, divided into 2 n^2 triangles.
void add_square_emitter(Scene& scene, Vec3 centre, float side, uint32_t n, float radiance) {
    add_emitter(scene, make_square(n), grey(radiance),
                compose(make_translation(centre), make_scale({0.5f * side, 1, 0.5f * side})));
}

/// A smooth sky, brightest towards (1, 1, 0).
Environment make_sky(uint32_t height) {
    Environment sky;
    sky.image = {2 * height, height, 3, std::vector<float>(std::size_t(6) * height * height)};
    for (uint32_t y = 0; y < height; ++y) {
        for (uint32_t x = 0; x < 2 * height; ++x) {
            const double theta = 3.141592653589793 * (y + 0.5) / height, phi = 3.141592653589793 * (x + 0.5) / height;
            const double towards = -std::sin(theta) * std::sin(phi) + std::cos(theta);
            for (int c = 0; c < 3; ++c) sky.image.at(x, y)[c] = static_cast<float>(std::exp(3 * towards));
        }
    }
    return sky;
}

} // namespace

TEST_CASE("stratified light samples reduce the variance of a square emitter of few or many triangles") {
    for (const uint32_t n : {1u, 8u}) {
        Scene scene;
        add_square_emitter(scene, {0.3f, 1, 0}, 1.5f, n, 1);
        const double times = gain(Lights(scene).view);
        MESSAGE((2 * n * n), " triangles: ", times, " times less variance");
        CHECK(times > (n == 1 ? 60 : 20));
    }
}

TEST_CASE("stratified light samples reduce the variance of a row of emitters of different power") {
    Scene scene;
    for (int i = 0; i < 16; ++i) {
        const float x = static_cast<float>(i) - 7.5f;
        add_square_emitter(scene, {0.5f * x, 2, 0.2f * x}, 0.2f, 1, 1 + 0.1f * x);
    }
    const double times = gain(Lights(scene).view);
    MESSAGE(times, " times less variance");
    CHECK(times > 100);
}

TEST_CASE("stratified light samples reduce the variance of a spherical emitter, and of emitters on a square grid") {
    Scene ball, square;
    add_square_emitter(ball, {0, 0, 0}, 2, 24, 1);
    ball.materials[0].two_sided_emission = true; // in either winding
    for (Vec3& p : ball.meshes[0].positions) {   // maps the square of side 2 to a ball by height and angle
        const double angle = 3.141592653589793 * (static_cast<double>(p.x) + 1),
                     height = 0.95 * static_cast<double>(p.z);
        const double ring = std::sqrt(std::max(0.0, 1 - height * height));
        p = {static_cast<float>(ring * std::cos(angle)), static_cast<float>(3 + height),
             static_cast<float>(ring * std::sin(angle))};
    }
    for (int i = 0; i < 64; ++i) {
        const int k = 29 * i % 64; // a file may have any order
        add_square_emitter(square, {static_cast<float>(k % 8) - 3.5f, 2, static_cast<float>(k / 8) - 3.5f}, 0.2f, 1, 1);
    }
    const double on_ball = gain(Lights(ball).view), in_square = gain(Lights(square).view);
    MESSAGE("ball: ", on_ball, " times less variance, square: ", in_square);
    CHECK(on_ball > 2.5); // it is 1.6 in the order of the file
    CHECK(in_square > 100);
}

TEST_CASE("stratified light samples reduce the variance of a sky, alone and with an emitter") {
    Scene scene;
    scene.environment = make_sky(64);
    const double alone = gain(Lights(scene).view);
    add_square_emitter(scene, {0, 3, 0}, 1, 1, 30);
    const double beside = gain(Lights(scene).view);
    MESSAGE(alone, " times less variance, ", beside, " with an emitter");
    CHECK(alone > 10);
    CHECK(beside > 5);
}

TEST_CASE("a path's directions and light samples are stratified together from the pixel on") {
    for (const uint32_t depth : {0u, 1u, 4u}) {
        const auto variance = [&](SamplerKind kind) {
            return relative_variance_of([&](SampleKey key) {
                PathState before, after;
                before.depth = depth - 1;
                after.depth = depth;
                const Vec2 way =
                    sample_2d(kind, key, depth == 0 ? kGroupCamera : vertex_group(before.depth, kGroupScatter));
                const Vec2 light = sample_2d(kind, key, vertex_light_group(after.depth), Pair::Last);
                return static_cast<double>(way.x * way.y) * static_cast<double>(light.x * light.y);
            });
        };
        const double times = variance(SamplerKind::Independent) / variance(SamplerKind::Sobol);
        MESSAGE("depth ", depth, ": ", times, " times less variance");
        CHECK(times > 20); // the variance falls by 4 for pairs of two groups
    }
}
