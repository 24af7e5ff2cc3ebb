// The sequences are what math/sampler.h says, to the bit: stratified over the samples of each pixel, strictly inside
// (0, 1), and the same numbers on every machine.

#include <cstdint>
#include <vector>

#include <doctest/doctest.h>

#include "math/sampler.h"

using namespace pertev;

namespace {

constexpr uint32_t kPixels[] = {0, 1, 2, 1919, 1920, 2'073'599, 0xffffffffu};
constexpr uint32_t kDimensions[] = {0, 1, 2, 3, 17, 255, 4096};
constexpr SamplerKind kKinds[] = {SamplerKind::Sobol, SamplerKind::Independent};

/// True where each box 2^-a x 2^-(k-a), 0 <= a <= k, holds one of the 2^k points.
bool is_net(const std::vector<Vec2>& points, int k) {
    for (int a = 0; a <= k; a++) {
        std::vector<bool> taken(points.size());
        for (const Vec2 p : points) {
            const auto x = static_cast<uint32_t>(p.x * static_cast<float>(1u << a));
            const auto y = static_cast<uint32_t>(p.y * static_cast<float>(1u << (k - a)));
            const uint32_t box = x << (k - a) | y;
            if (box >= taken.size() || taken[box]) return false;
            taken[box] = true;
        }
    }
    return true;
}

std::vector<Vec2> points_of(uint32_t pixel, uint32_t dimension, uint32_t seed, uint32_t first, int k) {
    std::vector<Vec2> points;
    for (uint32_t i = 0; i < (1u << k); i++) {
        points.push_back(sample_2d(SamplerKind::Sobol, {pixel, first + i, seed}, dimension));
    }
    return points;
}

} // namespace

TEST_CASE("the first 2^k samples of a pixel have one point in each elementary box") {
    for (const uint32_t pixel : kPixels) {
        for (const uint32_t dimension : kDimensions) {
            for (int k = 0; k <= 11; k++) CHECK(is_net(points_of(pixel, dimension, 3, 0, k), k));
        }
    }
}

TEST_CASE("each aligned run of 2^k samples has one point in each elementary box") {
    for (const uint32_t pixel : kPixels) {
        for (const uint32_t run : {1u, 2u, 5u, 1000u}) CHECK(is_net(points_of(pixel, 4, 0, run * 256, 8), 8));
    }
}

TEST_CASE("white noise is not stratified") { // is_net() can fail
    std::vector<Vec2> points;
    for (uint32_t i = 0; i < 256; i++) points.push_back(sample_2d(SamplerKind::Independent, {0, i, 0}, 0));
    CHECK(!is_net(points, 8));
}

TEST_CASE("single numbers are stratified over the samples of a pixel") {
    for (const uint32_t pixel : kPixels) {
        for (const uint32_t dimension : kDimensions) {
            std::vector<bool> taken(1024);
            for (uint32_t i = 0; i < 1024; i++) {
                const float u = sample_1d(SamplerKind::Sobol, {pixel, i, 9}, dimension);
                taken[static_cast<uint32_t>(u * 1024)] = true;
            }
            for (const bool t : taken) CHECK(t);
        }
    }
}

TEST_CASE("numbers are strictly between 0 and 1") {
    CHECK(unit_interval(0) == 0x1p-24f);
    CHECK(unit_interval(0xffffffffu) == 1 - 0x1p-24f);
    for (const uint32_t bits : {0u, 511u, 512u, 0x12345678u, 0x7fffffffu, 0x80000000u, 0xffffffffu}) {
        CHECK(static_cast<double>(unit_interval(bits)) == (static_cast<double>(bits >> 9) + 0.5) * 0x1p-23);
    }
}

TEST_CASE("the scrambling of a digit depends on earlier digits alone, and keeps apart what differs") {
    uint32_t wrong = 0;
    for (const uint32_t key : {0u, 1u, 0x9e3779b9u, 0xffffffffu}) {
        for (uint32_t i = 0; i < 2000; i++) {
            const uint32_t x = hash_word(i), a = owen_scramble_reversed(x, key);
            for (uint32_t k = 0; k < 32; k++) {
                const uint32_t difference = a ^ owen_scramble_reversed(x ^ (1u << k), key);
                wrong += (difference & ((2u << k) - 1)) != 1u << k; // bit k changes, the lower ones do not
            }
        }
    }
    CHECK(wrong == 0);
}

TEST_CASE("the numbers are the ones recorded") {
    uint64_t sum = 0;
    for (const SamplerKind kind : kKinds) {
        for (uint32_t i = 0; i < 20'000; i++) {
            const SampleKey key{.pixel = hash_word(i), .sample = i, .seed = i / 1000};
            const Vec2 p = sample_2d(kind, key, i % 50);
            const float q = sample_1d(kind, key, i % 50);
            for (const float u : {p.x, p.y, q}) sum = (sum ^ bits_of(u)) * 0x100000001b3u;
        }
    }
    CHECK(sum == 1909277206089536745u);
}
