#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "shading/guided_cdf.h"

using namespace pertev;

namespace {

constexpr double kNumbers = 0x1p31;

/// Weights over many orders of magnitude, every third one zero.
std::vector<double> random_weights(std::size_t count, uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> exponent(-20, 10);
    std::vector<double> weights(count);
    for (std::size_t i = 0; i < count; ++i) weights[i] = i % 3 == 1 ? 0.0 : std::exp2(exponent(random));
    return weights;
}

/// Finds the index by testing each interval.
uint32_t owner_of(const GuidedCdf& table, uint32_t number) {
    uint32_t owner = 0;
    for (std::size_t i = 0; i + 1 < table.starts.size(); ++i) {
        if (table.starts[i] <= number && number < table.starts[i + 1]) owner = static_cast<uint32_t>(i);
    }
    return owner;
}

} // namespace

TEST_CASE("guided cdf: intervals are proportional to weights, hold at least one number, and are empty for weight 0") {
    for (const std::size_t count : {1u, 2u, 3u, 7u, 64u, 1000u, 4096u, 100'000u}) {
        const std::vector<double> weights = random_weights(count, static_cast<uint32_t>(count));
        const GuidedCdf table = build_guided_cdf(weights);
        REQUIRE(table.starts.size() == count + 1);
        CHECK(table.starts.front() == 0);
        CHECK(table.starts.back() == 1u << 31);
        double total = 0, positive = 0, worst = 0;
        for (const double weight : weights) total += weight, positive += weight > 0 ? 1 : 0;
        uint64_t wrong = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const double owned = table.starts[i + 1] - table.starts[i]; // unsigned, so a negative length would be huge
            if ((weights[i] > 0) != (owned > 0)) ++wrong;
            worst = std::max(worst, std::abs(owned - weights[i] / total * kNumbers) -
                                        positive * (weights[i] / total)); // the share of numbers that each weight has
                                                                          // for certain
            if (cdf_pmf(view_of(table), static_cast<uint32_t>(i)) != static_cast<float>(owned / kNumbers)) ++wrong;
        }
        CAPTURE(count);
        CHECK(wrong == 0);
        CHECK(worst <= 2); // its guaranteed number, and the rounding of both ends
    }
}

TEST_CASE("guided cdf: a number selects the index of its interval, including the interval's ends") {
    for (const std::size_t count : {1u, 2u, 5u, 33u, 700u}) {
        const GuidedCdf table = build_guided_cdf(random_weights(count, 5));
        const GuidedCdfView view = view_of(table);
        std::vector<uint32_t> numbers = {0, 0x7fffffffu};
        for (const uint32_t start : table.starts) {
            if (start < 1u << 31) numbers.push_back(start);
            if (start > 0) numbers.push_back(start - 1);
        }
        for (uint32_t k = 0; k < 1000; ++k) numbers.push_back(hash_word(k) >> 1);
        uint64_t wrong = 0;
        for (const uint32_t number : numbers) {
            const CdfDraw draw = draw_ordered(view, number << 1 | (number & 1), 0);
            if (draw.index != owner_of(table, number)) ++wrong;
            if (draw.owned != table.starts[draw.index + 1] - table.starts[draw.index]) ++wrong;
            if (draw.rest != number - table.starts[draw.index] || draw.rest >= draw.owned) ++wrong;
        }
        CAPTURE(count);
        CHECK(wrong == 0);
    }
}

TEST_CASE("guided cdf: the order of numbers is kept by the index and the rest") {
    const GuidedCdf table = build_guided_cdf(random_weights(100, 3));
    const GuidedCdfView view = view_of(table);
    double last = -1;
    uint64_t backwards = 0;
    for (uint32_t k = 0; k < 1u << 16; ++k) {
        const CdfDraw draw = draw_ordered(view, k << 16, 1u << 31);
        const double place = draw.index + static_cast<double>(rest_of(draw));
        if (place < last) ++backwards;
        last = place;
    }
    CHECK(backwards == 0);
}

TEST_CASE("guided cdf: the rest of a number is uniform again, and exactly so for a second cdf") {
    // Tries every rest of an index with steps of more: all top bits of the resulting numbers must be equally frequent.
    for (const uint32_t owned : {1u, 3u, 5u, 96u, 1000u}) {
        constexpr uint32_t cells = 64, steps = 1u << 12;
        std::vector<uint64_t> drawn(cells);
        double sum = 0;
        for (uint32_t rest = 0; rest < owned; ++rest) {
            for (uint32_t k = 0; k < steps; ++k) {
                const CdfDraw draw = {0, owned, rest, k << 20 | 1u << 19};
                ++drawn[number_of_rest(draw) >> 26];
                const float u = rest_of(draw);
                REQUIRE(u > 0);
                REQUIRE(u < 1);
                sum += static_cast<double>(u);
            }
        }
        CAPTURE(owned);
        for (const uint64_t n : drawn) CHECK(std::abs(static_cast<double>(n) - owned * (steps / 64.0)) <= 1);
        CHECK(sum / (static_cast<double>(owned) * steps) == doctest::Approx(0.5).epsilon(1e-4));
    }
    const CdfDraw whole = {0, 1u << 31, 0x12345678u, 0x80000000u};
    CHECK(number_of_rest(whole) == 0x2468acf1u);
    CHECK(number_of_rest({0, (1u << 31) - 1, 0x7ffffffeu - 1, 0xffffffffu}) >= 0xfffffffdu);
}

TEST_CASE("guided cdf: the bits of a pair of numbers are a permutation of each of them") {
    constexpr uint32_t count = 1u << 18;
    for (const uint32_t fixed : {0u, 1u, 0x9e3779b9u}) {
        std::vector<uint32_t> by_x, by_y;
        for (uint32_t k = 0; k < count; ++k) {
            by_x.push_back(bits_behind({hash_word(k), fixed}));
            by_y.push_back(bits_behind({fixed, hash_word(k)}));
        }
        for (std::vector<uint32_t>* bits : {&by_x, &by_y}) { // random words would have 8 pairs of equals
            std::ranges::sort(*bits);
            CHECK(std::ranges::adjacent_find(*bits) == bits->end());
        }
    }
}

TEST_CASE("guided cdf: invalid weights are never selected, and the smallest valid weight is") {
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
    const std::vector<double> weights = {nan, 1, -3, 1e-300, infinite, 3, 0};
    const GuidedCdf table = build_guided_cdf(weights);
    const GuidedCdfView view = view_of(table);
    CHECK(static_cast<double>(cdf_pmf(view, 1)) == doctest::Approx(0.25));
    CHECK(static_cast<double>(cdf_pmf(view, 5)) == doctest::Approx(0.75));
    for (const uint32_t i : {0u, 2u, 4u, 6u}) CHECK(cdf_pmf(view, i) == 0);
    CHECK(table.starts[4] - table.starts[3] == 1);
    CHECK(draw_ordered(view, table.starts[3] << 1, 0).index == 3);

    for (const std::vector<double>& none : {std::vector<double>{}, {0, 0, 0}, std::vector<double>(9000), {nan, -1}}) {
        CHECK(build_guided_cdf(none).starts.empty());
        CHECK(view_of(build_guided_cdf(none)).starts == nullptr);
    }
}
