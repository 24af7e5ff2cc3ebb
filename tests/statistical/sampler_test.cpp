// The samplers behave like random numbers: one sample is uniform over pixels; neighbouring pixels, dimensions and
// seeds are independent; dimensions are not correlated over the samples of one pixel.

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "math/sampler.h"
#include "tests/support/chi_square.h"

using namespace pertev;

namespace {

constexpr SamplerKind kKinds[] = {SamplerKind::Sobol, SamplerKind::Independent};
constexpr int kSamplerTests = 90; // more tests than this file has
constexpr uint32_t kPairs = 1u << 19;

/// Tests by 16 x 16 boxes that the points (first, second) are uniform in the square. From half as many points, these
/// notice deviations wider than a box that 32 x 32 boxes notice.
template <class PairOf>
void check_uniform(const PairOf& pair, const char* what) {
    constexpr uint32_t n = 16;
    std::vector<double> observed(n * n), expected(n * n, static_cast<double>(kPairs) / (n * n));
    for (uint32_t i = 0; i < kPairs; i++) {
        const Vec2 p = pair(i);
        observed[static_cast<uint32_t>(p.x * n) * n + static_cast<uint32_t>(p.y * n)] += 1;
    }
    const test::ChiSquareResult result = test::chi_square(observed, expected);
    CHECK_MESSAGE(result.passes(kSamplerTests), what << ": " << result.describe());
}

} // namespace

TEST_CASE("samples of different pixels, dimensions and seeds are independent") {
    for (const SamplerKind kind : kKinds) {
        for (const uint32_t sample : {0u, 1u, 77u}) {
            const auto one = [&](uint32_t pixel, uint32_t group, uint32_t seed) {
                return sample_1d(kind, {pixel, sample, seed}, group);
            };
            check_uniform([&](uint32_t i) { return sample_2d(kind, {i, sample, 0}, 5); }, "one pair, over pixels");
            check_uniform([&](uint32_t i) { return sample_2d(kind, {7, sample, i}, 5); }, "one pair, over seeds");
            check_uniform([&](uint32_t i) { return sample_2d(kind, {7, sample, 0}, i); }, "one pair, over groups");
            check_uniform([&](uint32_t i) { return sample_2d(kind, {i, sample, 0}, 5, Pair::Last); }, "the last pair");
            for (const auto& [a, b] : {std::pair{0u, 2u}, {0u, 3u}, {1u, 2u}, {1u, 3u}}) {
                check_uniform(
                    [&](uint32_t i) {
                        const SampleKey key = {i, sample, 0};
                        return Vec2{sample_1d(kind, key, 5, a), sample_1d(kind, key, 5, b)};
                    },
                    "numbers of different pairs");
            }
            check_uniform([&](uint32_t i) { return Vec2{one(2 * i, 0, 0), one(2 * i + 1, 0, 0)}; }, "next pixel");
            check_uniform([&](uint32_t i) { return Vec2{one(i, 2, 0), one(i, 3, 0)}; }, "next group");
            check_uniform([&](uint32_t i) { return Vec2{one(i, 2, 8), one(i, 2, 9)}; }, "next seed");
            check_uniform([&](uint32_t i) { return Vec2{one(i, 1, 0), one(i + 1920, 1, 0)}; }, "next row");
            check_uniform([&](uint32_t i) { return Vec2{one(i, 4, 5), one(i, 5, 4)}; }, "group and seed exchanged");
        }
    }
}

TEST_CASE("samples of one pixel are uncorrelated in different dimensions and in the two components") {
    constexpr uint32_t pixels = 4096, samples = 64;
    for (const SamplerKind kind : kKinds) {
        for (const uint32_t other : {1u, 2u, 8u}) {
            double sum[3] = {};
            for (uint32_t pixel = 0; pixel < pixels; pixel++) {
                for (uint32_t i = 0; i < samples; i++) {
                    const Vec2 a = sample_2d(kind, {pixel, i, 0}, 0), b = sample_2d(kind, {pixel, i, 0}, other);
                    const double ax = static_cast<double>(a.x) - 0.5, ay = static_cast<double>(a.y) - 0.5;
                    const double bx = static_cast<double>(b.x) - 0.5, by = static_cast<double>(b.y) - 0.5;
                    sum[0] += ax * bx;
                    sum[1] += ay * by;
                    sum[2] += ax * ay;
                }
            }
            // The variance of a term is at most 1/144; the bound is 4 standard deviations.
            for (const double s : sum) CHECK(std::fabs(s) < 4 * std::sqrt(1.0 / 144 * pixels * samples));
        }
    }
}

TEST_CASE("successive samples of white noise are independent") {
    const auto one = [](uint32_t sample) { return sample_1d(SamplerKind::Independent, {3, sample, 0}, 6); };
    check_uniform([&](uint32_t i) { return Vec2{one(2 * i), one(2 * i + 1)}; }, "next sample");
    check_uniform([&](uint32_t i) { return Vec2{one(i), one(i + (1u << 20))}; }, "sample 2^20 later");
}

TEST_CASE("for a smooth product of two pairs the variance of a group is a thirtieth of white noise") {
    // The relative variance of the mean of x y z w over 64 samples.
    double error[2] = {};
    for (const SamplerKind kind : kKinds) {
        for (uint32_t pixel = 0; pixel < 2048; pixel++) {
            double mean = 0;
            for (uint32_t i = 0; i < 64; i++) {
                const Vec2 a = sample_2d(kind, {pixel, i, 0}, 3), b = sample_2d(kind, {pixel, i, 0}, 3, Pair::Last);
                mean += static_cast<double>(a.x) * static_cast<double>(a.y) * static_cast<double>(b.x) *
                        static_cast<double>(b.y) / 64;
            }
            error[kind == SamplerKind::Sobol ? 0 : 1] += (16 * mean - 1) * (16 * mean - 1) / 2048;
        }
    }
    MESSAGE("relative errors: ", std::sqrt(error[0]), ", white noise ", std::sqrt(error[1]));
    CHECK(std::sqrt(error[0]) < std::sqrt(error[1]) / 5); // two independent pairs give half
}

TEST_CASE("a stratified sequence integrates better than white noise") {
    double error[2] = {};
    for (const SamplerKind kind : kKinds) {
        for (uint32_t pixel = 0; pixel < 512; pixel++) {
            double mean = 0;
            for (uint32_t i = 0; i < 256; i++) {
                const Vec2 p = sample_2d(kind, {pixel, i, 0}, 2);
                mean += (p.x * p.x + p.y * p.y <= 1 ? 1.0 : 0.0) / 256;
            }
            error[kind == SamplerKind::Sobol ? 0 : 1] +=
                (mean - 0.7853981633974483) * (mean - 0.7853981633974483) / 512;
        }
    }
    CHECK(std::sqrt(error[0]) < 0.35 * std::sqrt(error[1])); // for a discontinuous integrand N^-3/4 against N^-1/2
}
