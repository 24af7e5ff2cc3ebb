// The sequences follow math/sampler.h to the bit: stratified over the samples of each pixel, strictly inside (0, 1),
// and the same numbers on every machine.

#include <array>
#include <cstdint>
#include <vector>

#include <doctest/doctest.h>

#include "math/sampler.h"

using namespace pertev;

namespace {

constexpr uint32_t kPixels[] = {0, 1, 2, 1919, 1920, 2'073'599, 0xffffffffu};
constexpr uint32_t kGroups[] = {0, 1, 2, 3, 17, 255, 4096};
constexpr SamplerKind kSamplerKinds[] = {SamplerKind::Sobol, SamplerKind::Independent};

/// Returns whether each box 2^-a x 2^-(k-a), 0 <= a <= k, contains one of the 2^k points.
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

std::vector<Vec2> points_of(uint32_t pixel, uint32_t group, Pair pair, uint32_t seed, uint32_t first, int k) {
    std::vector<Vec2> points;
    for (uint32_t i = 0; i < (1u << k); i++) {
        points.push_back(sample_2d(SamplerKind::Sobol, {pixel, first + i, seed}, group, pair));
    }
    return points;
}

/// Returns whether each box with sides 4^-a, 4^-b, 4^-c, 4^-d, a + b + c + d = k, contains one of the 4^k points of a
/// group.
bool is_four_dimensional_net(uint32_t pixel, uint32_t group, uint32_t first, int k) {
    const uint32_t count = 1u << (2 * k);
    std::vector<std::array<float, 4>> points;
    for (uint32_t i = 0; i < count; i++) {
        const SampleKey key = {pixel, first + i, 5};
        const Vec2 a = sample_2d(SamplerKind::Sobol, key, group),
                   b = sample_2d(SamplerKind::Sobol, key, group, Pair::Last);
        points.push_back({a.x, a.y, b.x, b.y});
    }
    for (int split = 0; split < (k + 1) * (k + 1) * (k + 1); split++) {
        const std::array<int, 3> sides = {split % (k + 1), split / (k + 1) % (k + 1), split / ((k + 1) * (k + 1))};
        const int last = k - sides[0] - sides[1] - sides[2];
        if (last < 0) continue;
        std::vector<bool> taken(count);
        for (const auto& p : points) {
            uint32_t box = 0;
            for (std::size_t d = 0; d < 4; d++) {
                const int side = d < 3 ? sides[d] : last;
                box = box << (2 * side) | static_cast<uint32_t>(p[d] * static_cast<float>(1u << (2 * side)));
            }
            if (taken[box]) return false;
            taken[box] = true;
        }
    }
    return true;
}

} // namespace

TEST_CASE("the first 2^k samples of a pixel have one point in each elementary box") {
    for (const uint32_t pixel : kPixels) {
        for (const uint32_t group : kGroups) {
            for (const Pair pair : {Pair::First, Pair::Last}) {
                for (int k = 0; k <= 11; k++) CHECK(is_net(points_of(pixel, group, pair, 3, 0, k), k));
            }
        }
    }
}

TEST_CASE("each aligned run of 2^k samples has one point in each elementary box") {
    for (const uint32_t pixel : kPixels) {
        for (const uint32_t run : {1u, 2u, 5u, 1000u}) {
            CHECK(is_net(points_of(pixel, 4, Pair::First, 0, run * 256, 8), 8));
            CHECK(is_net(points_of(pixel, 4, Pair::Last, 0, run * 256, 8), 8));
        }
    }
}

TEST_CASE("the first 4^k samples of a pixel have one point in each box of four dimensions") {
    for (const uint32_t pixel : kPixels) {
        for (const uint32_t group : kGroups) {
            for (int k = 0; k <= 4; k++) CHECK(is_four_dimensional_net(pixel, group, 0, k));
        }
        CHECK(is_four_dimensional_net(pixel, 3, 7 * 4096, 6));
    }
}

TEST_CASE("digits are multiplied in the field of four elements") {
    const uint32_t all = 0x9c3fu << 3 ^ 0xa5071b6du;
    const auto times_w = [](uint32_t x) { return multiply_digits(FieldElement::W, x); };
    CHECK(times_w(times_w(all)) == multiply_digits(FieldElement::WSquared, all));
    CHECK(times_w(times_w(times_w(all))) == all);
    CHECK((times_w(times_w(all)) ^ times_w(all)) == all); // w^2 + w = 1
    for (uint32_t digit = 1; digit < 4; digit++) CHECK(times_w(digit) != digit);
}

TEST_CASE("white noise is not stratified") { // is_net() can fail
    std::vector<Vec2> points;
    for (uint32_t i = 0; i < 256; i++) points.push_back(sample_2d(SamplerKind::Independent, {0, i, 0}, 0));
    CHECK(!is_net(points, 8));
}

TEST_CASE("single numbers are stratified over the samples of a pixel") {
    for (const uint32_t pixel : kPixels) {
        for (const uint32_t group : kGroups) {
            for (uint32_t number = 0; number < 4; number++) {
                for (const uint32_t count : {2u, 32u, 1024u}) {
                    std::vector<bool> taken(count);
                    for (uint32_t i = 0; i < count; i++) {
                        const float u = sample_1d(SamplerKind::Sobol, {pixel, i, 9}, group, number);
                        taken[static_cast<uint32_t>(u * static_cast<float>(count))] = true;
                    }
                    for (const bool t : taken) CHECK(t);
                }
            }
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

TEST_CASE("the scrambling of a digit depends only on earlier digits and is a permutation") {
    uint32_t wrong = 0;
    for (const uint32_t key : {0u, 1u, 0x9e3779b9u, 0xffffffffu}) {
        for (uint32_t i = 0; i < 2000; i++) {
            const uint32_t x = hash_word(i), a = owen_scramble_reversed(x, key);
            for (uint32_t k = 0; k < 32; k++) {
                const uint32_t difference = a ^ owen_scramble_reversed(x ^ (1u << k), key);
                wrong += (difference & ((2u << k) - 1)) != 1u << k; // bit k changes, and the lower bits do not
            }
        }
    }
    CHECK(wrong == 0);
}

TEST_CASE("the numbers match the recorded ones") {
    uint64_t sum = 0;
    for (const SamplerKind kind : kSamplerKinds) {
        for (uint32_t i = 0; i < 20'000; i++) {
            const SampleKey key{.stream = hash_word(i), .sample = i, .seed = i / 1000};
            const Vec2 p = sample_2d(kind, key, i % 50), q = sample_2d(kind, key, i % 50, Pair::Last);
            CHECK(sample_1d(kind, key, i % 50, 1) == p.y);
            CHECK(sample_1d(kind, key, i % 50, 2) == q.x);
            for (const float u : {p.x, p.y, q.x, q.y}) sum = (sum ^ bits_of(u)) * 0x100000001b3u;
        }
    }
    CHECK(sum == 11121450520421290937u);
}
