// Environment sampling for multiple importance sampling: samples follow the stated density, pdf() returns the same
// density for a given direction, and value / density averages to the true integral.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "shading/environment_light.h"
#include "tests/support/chi_square.h"
#include "tests/support/estimate.h"
#include "tests/support/lit_scenes.h"
#include "tests/support/options.h"
#include "tests/support/random.h"

using namespace pertev;
using namespace pertev::test;

namespace {

double luminance_in_double(Rgb c) { return as_double(c.r) + as_double(c.g) + as_double(c.b); }

/// Dark noise, a black band and a sun of one texel.
Environment make_sky(uint32_t width, uint32_t height, float rotation) {
    Environment sky;
    sky.image = {width, height, 3, {}};
    sky.rotation = rotation;
    sky.scale = {1, 2, 0.5f};
    Random random(width);
    for (uint32_t y = 0; y < height; ++y) {
        for (uint32_t x = 0; x < 3 * width; ++x) {
            const bool is_black = y > height / 2 && x < width;
            sky.image.pixels.push_back(is_black ? 0.0f : 0.2f * random.unit());
        }
    }
    for (int c = 0; c < 3; ++c) sky.image.at(width / 4, height / 3)[c] = 100;
    return sky;
}

EnvironmentData build(const Environment& environment) {
    Messages messages;
    EnvironmentData data = build_environment_light(environment, messages);
    CHECK(messages.all().empty());
    return data;
}

/// Returns the density of sample_environment at `direction`, 1/sr.
float environment_pdf(const EnvironmentView& view, Vec3 direction) {
    return find_environment(view, direction, true).pdf;
}

/// Returns the direction of a longitude and polar angle by the convention of scene/light.h, in double precision.
Vec3 direction_at_angles(double longitude, double theta) {
    return {static_cast<float>(std::sin(theta) * std::sin(longitude)), static_cast<float>(std::cos(theta)),
            static_cast<float>(-std::sin(theta) * std::cos(longitude))};
}

/// Returns the integral of f(direction) over the sphere, from midpoints of `steps` x 2 `steps` cells of equal angles.
double integrate_sphere(int steps, const std::function<double(Vec3)>& f) {
    double sum = 0;
    const double d = std::numbers::pi / steps;
    for (int i = 0; i < steps; ++i) {
        const double theta = (i + 0.5) * d, weight = (std::cos(i * d) - std::cos((i + 1) * d)) * d;
        for (int j = 0; j < 2 * steps; ++j) sum += weight * f(direction_at_angles((j + 0.5) * d, theta));
    }
    return sum;
}

} // namespace

TEST_CASE("environment: directions, columns, rows and rotation match scene/light.h") {
    Environment sky;
    sky.image = {8, 4, 3, std::vector<float>(8 * 4 * 3)};
    for (uint32_t x = 0; x < 8; ++x) {
        for (uint32_t y = 0; y < 4; ++y) {
            sky.image.at(x, y)[0] = static_cast<float>(x);
            sky.image.at(x, y)[1] = static_cast<float>(y);
        }
    }
    const EnvironmentData data = build(sky);
    const EnvironmentView view = view_of(data);
    const auto column = [](const EnvironmentView& v, Vec3 d) { return as_double(environment_radiance(v, d).r); };
    CHECK(column(view, {0, 0, -1}) == doctest::Approx(3.5)); // between the two middle columns
    CHECK(column(view, {1, 0, 0}) == doctest::Approx(5.5));
    CHECK(column(view, {-1, 0, 0}) == doctest::Approx(1.5));
    CHECK(column(view, {0, 0, 1}) == doctest::Approx(3.5)); // at the seam, the mean of the first and the last column
    CHECK(environment_radiance(view, {0, 1, 0}).g == 0);
    CHECK(environment_radiance(view, {0, -1, 0}).g == 3);
    CHECK(as_double(environment_radiance(view, {0.3f, 0, -0.7f}).g) == doctest::Approx(1.5));

    sky.rotation = kPi / 2; // the middle column goes from -z, counter-clockwise seen from above, to -x
    const EnvironmentData turned = build(sky);
    CHECK(column(view_of(turned), {-1, 0, 0}) == doctest::Approx(3.5));
    CHECK(column(view_of(turned), {0, 0, -1}) == doctest::Approx(5.5));
    sky.rotation = kPi / 2 - 40 * kPi; // rotates by several turns
    CHECK(column(view_of(build(sky)), {-1, 0, 0}) == doctest::Approx(3.5).epsilon(1e-4));
}

TEST_CASE("environment: the density integrates to 1 and is positive wherever there is light") {
    for (const auto& [width, height] : {std::pair{16u, 9u}, {1u, 5u}, {5u, 1u}, {32u, 16u}, {3u, 2u}}) {
        const EnvironmentData data = build(make_sky(width, height, 1.1f));
        const EnvironmentView view = view_of(data);
        bool is_covered = true;
        const double integral = integrate_sphere(720, [&](Vec3 direction) {
            const double pdf = as_double(environment_pdf(view, direction));
            if (!is_black(environment_radiance(view, direction)) && !(pdf > 0)) is_covered = false;
            return pdf;
        });
        CAPTURE(width);
        CHECK(integral == doctest::Approx(1).epsilon(5e-3));
        CHECK(is_covered);
    }
}

TEST_CASE("environment: density and radiance of a direction equal those of its sample") {
    for (const auto& [width, height] : {std::pair{16u, 9u}, {64u, 2048u}}) {
        const EnvironmentData data = build(make_sky(width, height, -2.0f));
        const EnvironmentView view = view_of(data);
        Random random(1);
        int differing = 0, far_off = 0;
        constexpr int draws = 100'000;
        for (int i = 0; i < draws; ++i) {
            EnvironmentSample sample = {};
            REQUIRE(sample_environment(view, random_bits(random), sample));
            CHECK(as_double(length(sample.wi)) == doctest::Approx(1).epsilon(1e-6));
            const float pdf = environment_pdf(view, sample.wi);
            const Rgb radiance = environment_radiance(view, sample.wi);
            // Rounding moves a position, and the density near a dark corner changes fast.
            if (std::abs(pdf - sample.pdf) > 1e-3f * sample.pdf) ++differing;
            // Near the sun of 100, rounding by 2^-12 texels, that of a float at row 2048, contributes 0.025.
            if (std::abs(radiance.r - sample.radiance.r) > 0.02f * sample.radiance.r + 0.025f) ++far_off;
        }
        CAPTURE(height);
        CHECK(differing < draws / 500);
        CHECK(far_off == 0);
    }
}

TEST_CASE("environment: samples follow the density, even within texels") {
    constexpr uint32_t width = 16, height = 9, parts = 4, steps = 6;
    Environment sky = make_sky(width, height, 1.1f);
    const EnvironmentData data = build(sky);
    const EnvironmentView view = view_of(data);
    const uint32_t samples = static_cast<uint32_t>(effort(1'000'000, 10'000'000));
    // Each texel is divided into 4 x 4 cells of equal angles, so that no cell crosses the edge of a patch. A cell's
    // expected count is the density's integral from midpoints, whose positions follow from the convention.
    std::vector<double> observed(width * height * parts * parts), expected(observed.size());
    const double part = 1.0 / (parts * steps);
    for (uint32_t y = 0; y < height * parts * steps; ++y) {
        const double theta = std::numbers::pi * (y + 0.5) * part / height;
        const double around =
            (std::cos(std::numbers::pi * y * part / height) - std::cos(std::numbers::pi * (y + 1) * part / height)) *
            2 * std::numbers::pi * part / width;
        for (uint32_t x = 0; x < width * parts * steps; ++x) {
            const double longitude = 2 * std::numbers::pi * ((x + 0.5) * part / width - 0.5) - 1.1;
            const double density = as_double(environment_pdf(view, direction_at_angles(longitude, theta)));
            expected[y / steps * width * parts + x / steps] += samples * around * density;
        }
    }
    Random random(5);
    for (uint32_t i = 0; i < samples; ++i) {
        EnvironmentSample sample;
        REQUIRE(sample_environment(view, random_bits(random), sample));
        const double longitude = std::atan2(as_double(sample.wi.x), as_double(-sample.wi.z)) + 1.1;
        const double turns = longitude / (2 * std::numbers::pi) + 0.5;
        const double across = std::hypot(as_double(sample.wi.x), as_double(sample.wi.z));
        const double row = std::atan2(across, as_double(sample.wi.y)) / std::numbers::pi * height * parts;
        const uint32_t y = std::min(static_cast<uint32_t>(row), height * parts - 1);
        const uint32_t x =
            std::min(static_cast<uint32_t>((turns - std::floor(turns)) * width * parts), width * parts - 1);
        observed[y * width * parts + x] += 1;
    }
    const ChiSquareResult result = test::chi_square(observed, expected);
    CHECK_MESSAGE(result.passes(1), result.describe());
}

TEST_CASE("environment: radiance over density averages to the integral of radiance, with little noise") {
    for (const auto& [width, height] : {std::pair{16u, 9u}, {48u, 24u}}) {
        const EnvironmentData data = build(make_sky(width, height, 0.4f));
        const EnvironmentView view = view_of(data);
        const double exact = integrate_sphere(
            960, [&](Vec3 direction) { return luminance_in_double(environment_radiance(view, direction)); });
        Random random(2);
        const Estimate power = estimate(200'000, [&] {
            EnvironmentSample sample = {};
            if (!sample_environment(view, random_bits(random), sample)) return 0.0;
            return luminance_in_double(sample.radiance) / as_double(sample.pdf);
        });
        CAPTURE(width);
        CHECK(std::abs(power.mean - exact) < 4 * power.error + 2e-4 * exact);
        // The channels differ, so each has some variance when texels are drawn by the sum. The sum has little.
        CHECK(power.variance < 0.02 * exact * exact);
        CHECK(luminance_in_double(data.mean_radiance) * 4 * std::numbers::pi == doctest::Approx(exact).epsilon(0.02));
    }
}

TEST_CASE("environment: a sun of one texel has hardly more variance than a uniform sky") {
    // Uniform sampling of a texel would have a relative variance of 0.888. The third sun is at the seam, the last at
    // the pole, where the texel is a triangle.
    for (const auto& [x, y] : {std::pair{20u, 10u}, {5u, 31u}, {63u, 16u}, {30u, 1u}, {30u, 0u}}) {
        Environment sky;
        sky.image = {64, 32, 3, std::vector<float>(64 * 32 * 3)};
        for (int c = 0; c < 3; ++c) sky.image.at(x, y)[c] = 1000;
        const EnvironmentData data = build(sky);
        const EnvironmentView view = view_of(data);
        Random random(x + y);
        const Estimate power = estimate(100'000, [&] {
            EnvironmentSample sample = {};
            if (!sample_environment(view, random_bits(random), sample)) return 0.0;
            return luminance_in_double(sample.radiance) / as_double(sample.pdf);
        });
        CAPTURE(y);
        CAPTURE(power.variance / (power.mean * power.mean));
        const bool is_at_pole = y < 2 || y > 30;
        CHECK(power.variance < (is_at_pole ? 0.05 : 0.002) * power.mean * power.mean);
    }
}

TEST_CASE("environment: no image, one pixel and equal pixels are sampled uniformly") {
    Environment none, one, equal;
    none.scale = one.scale = {1, 2, 3};
    one.image = {1, 1, 3, {1, 1, 1}};
    equal.image = {4, 2, 3, std::vector<float>(24, 2.0f)};
    for (const Environment& environment : {none, one, equal}) {
        const EnvironmentData data = build(environment);
        const EnvironmentView view = view_of(data);
        CHECK(view.is_constant);
        Random random(3);
        std::array<double, 3> mean{};
        for (int i = 0; i < 10'000; ++i) {
            EnvironmentSample sample = {};
            REQUIRE(sample_environment(view, random_bits(random), sample));
            CHECK(sample.pdf == 0.25f * kInvPi);
            CHECK(environment_pdf(view, sample.wi) == sample.pdf);
            CHECK(environment_radiance(view, sample.wi) == sample.radiance);
            mean[0] += as_double(sample.wi.x) / 10'000;
            mean[1] += as_double(sample.wi.y) / 10'000;
            mean[2] += as_double(sample.wi.z) / 10'000;
        }
        for (const double m : mean) CHECK(std::abs(m) < 4 / std::sqrt(3.0 * 10'000));
    }
    CHECK(environment_radiance(view_of(build(one)), {0, 1, 0}) == Rgb{1, 2, 3});
}

TEST_CASE("environment: an image with one bright row at the pole is sampled with full precision") {
    Environment sky;
    sky.image = {4, 8192, 3, std::vector<float>(4 * 8192 * 3)};
    for (int i = 0; i < 12; ++i) sky.image.pixels[static_cast<std::size_t>(i)] = 1;
    const EnvironmentData data = build(sky);
    const EnvironmentView view = view_of(data);
    Random random(4);
    // Light extends half a row past the first row: radiance falls from 1 at theta = 1/2 row to 0 at 3/2 rows.
    const double row = std::numbers::pi / 8192;
    const double exact = 2 * std::numbers::pi * row * row * (13.0 / 24.0);
    const Estimate power = estimate(100'000, [&] {
        EnvironmentSample sample;
        return sample_environment(view, random_bits(random), sample) ? as_double(sample.radiance.r / sample.pdf) : 0.0;
    });
    CHECK(std::abs(power.mean - exact) < 4 * power.error + 1e-4 * exact);
}

TEST_CASE("environment: a black image is never sampled, and bad pixels are repaired with a warning") {
    Environment black;
    black.image = {4, 2, 3, std::vector<float>(24)};
    const EnvironmentData data = build(black);
    EnvironmentSample sample;
    CHECK_FALSE(sample_environment(view_of(data), {0x80000000u, 0x80000000u}, sample));
    CHECK(environment_pdf(view_of(data), {0, 1, 0}) == 0);

    Environment bad = make_sky(8, 4, 0);
    bad.image.pixels[5] = std::numeric_limits<float>::quiet_NaN();
    bad.image.pixels[9] = -1;
    bad.image.pixels[12] = kInfinity;
    Messages messages;
    const EnvironmentData repaired = build_environment_light(bad, messages);
    REQUIRE(messages.all().size() == 3);
    for (const Message& message : messages.all()) {
        CHECK(message.is_warning);
        CHECK(message.text.find("environment: 1 pixel value") != std::string::npos);
    }
    CHECK(repaired.pixels[1].b == 0);
    CHECK(repaired.pixels[3].r == 0);
    CHECK(repaired.pixels[4].r == 65504);
}
