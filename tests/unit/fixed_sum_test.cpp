#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/fixed_sum.h"
#include "tests/support/random.h"

using namespace pertev;

namespace {

/// Returns the value of a fixed-point number, exactly if it has at most 64 significant bits.
long double value_of(FixedSum sum) {
    return std::ldexp(static_cast<long double>(static_cast<int64_t>(sum.high)), 0) +
           std::ldexp(static_cast<long double>(sum.low), -64);
}

/// Computes mean_of with the C library's ldexp, whose result IEEE 754 defines exactly. Only the host has it.
float mean_by_ldexp(FixedSum sum, uint64_t count) {
    __extension__ using Wide = unsigned __int128;
    const bool negative = (sum.high >> 63) != 0;
    Wide magnitude = (Wide(sum.high) << 64) | sum.low;
    if (negative) magnitude = -magnitude;
    int shift = 0;
    while (magnitude != 0 && (magnitude >> 127) == 0) {
        magnitude <<= 1;
        ++shift;
    }
    // 2^127 <= magnitude: with any count below 2^64 the quotient has 63 bits or more.
    Wide quotient = magnitude / count;
    bool sticky = magnitude % count != 0;
    int exponent = -64 - shift;
    for (; (quotient >> 40) != 0; quotient >>= 1, ++exponent) sticky = sticky || (quotient & 1) != 0;
    const double digits = static_cast<double>(static_cast<uint64_t>((quotient << 1) | (sticky ? 1 : 0)));
    const float mean = static_cast<float>(std::ldexp(digits, exponent - 1));
    return negative ? -mean : mean;
}

} // namespace

TEST_CASE("sums of 32 values by limbs equal sums one after the other") {
    test::Random random(5);
    for (int round = 0; round < 200; ++round) {
        FixedSum one_by_one;
        FixedSumLimbs sums = {};
        for (int i = 0; i < 32; ++i) {
            const float magnitude = std::ldexp(1.0f, static_cast<int>(random.below(100)) - 60);
            const float value = (random.below(4) == 0 ? -magnitude : magnitude) * (1 + i / 32.0f);
            const FixedSum fixed = round == 0 ? to_fixed(-kMaxSampleValue) : to_fixed(value);
            one_by_one = one_by_one + fixed;
            const FixedSumLimbs limbs = limbs_of(fixed);
            CHECK(sum_of(limbs) == fixed);
            for (int k = 0; k < 5; ++k) {
                CHECK(sums.limbs[k] + uint64_t(limbs.limbs[k]) <= 0xffffffffu);
                sums.limbs[k] += limbs.limbs[k];
            }
        }
        CHECK(sum_of(sums) == one_by_one);
    }
}

TEST_CASE("a float in fixed point keeps its value, truncated towards zero below 2^-64") {
    for (const float x : {0.0f, -0.0f, 1.0f, -1.0f, 0.1f, -0.3f, 1e-10f, 3e11f, -0x1p40f, 0x1p-64f, 0x1.8p-64f}) {
        CAPTURE(x);
        const long double cut = std::ldexp(std::trunc(std::ldexp(static_cast<long double>(x), 64)), -64);
        CHECK(value_of(to_fixed(x)) == cut);
    }
    CHECK(to_fixed(0x1p-65f) == FixedSum{});
    CHECK(to_fixed(-0x1p-140f) == FixedSum{}); // subnormal
}

TEST_CASE("a sum does not depend on the order, and atomic additions give the same sum") {
    test::Random random(3);
    std::vector<float> values;
    for (int i = 0; i < 2000; ++i) {
        values.push_back(std::ldexp(random.within(-1, 1), static_cast<int>(random.below(80)) - 40));
    }
    const auto sum_of = [&] {
        FixedSum sum;
        for (const float value : values) sum = sum + to_fixed(value);
        return sum;
    };
    const FixedSum forwards = sum_of();
    std::ranges::reverse(values);
    CHECK(sum_of() == forwards);
    FixedSum atomic;
    for (const float value : values) atomic_add(&atomic, to_fixed(value));
    CHECK(atomic == forwards);
}

TEST_CASE("the mean is the correctly rounded quotient") {
    test::Random random(5);
    for (int i = 0; i < 20000; ++i) {
        // Sums of up to 62 bits, so that long double holds the dividend and the divisor exactly.
        const int shift = static_cast<int>(random.below(60));
        const uint64_t low = ((uint64_t(random.bits()) << 32) | random.bits()) >> (2 + shift);
        const uint64_t count = 1 + random.below(i % 2 == 0 ? 7 : 1u << 20);
        const FixedSum sum = {low, 0};
        const float mean = mean_of(sum, count);
        // The error of a correctly rounded result is at most half the distance to each neighbour.
        const auto distance = [&](float x) {
            return std::fabs(std::ldexp(static_cast<long double>(x), 64) * static_cast<long double>(count) -
                             static_cast<long double>(low));
        };
        CAPTURE(low);
        CAPTURE(count);
        CHECK(distance(mean) <= distance(std::nextafter(mean, 0.0f)));
        CHECK(distance(mean) <= distance(std::nextafter(mean, 2.0f)));
        FixedSum negative = {~sum.low + 1, ~sum.high + (sum.low == 0 ? 1u : 0u)};
        CHECK(-sum == negative);
        CHECK(mean_of(negative, count) == -mean);
    }
}

TEST_CASE("the mean has the bits of the C library's division, including the smallest sums and the largest counts") {
    test::Random random(11);
    const auto bits64 = [&] { return (uint64_t(random.bits()) << 32) | random.bits(); };
    int smallest = 0;
    for (int i = 0; i < 200'000; ++i) {
        FixedSum sum = {bits64(), bits64()};
        const auto cut = static_cast<int>(random.below(128)); // leading zeros
        if (cut >= 64) sum = {sum.low >> (cut - 64), 0};
        if (cut < 64) sum.high >>= cut;
        if (i % 5 == 0) sum.low = 0;
        if (i % 7 == 0) sum = {~sum.low + 1, ~sum.high + (sum.low == 0 ? 1u : 0u)};
        uint64_t count = 1 + (bits64() >> (27 + random.below(37)));
        if (i % 11 == 0) count = uint64_t(1) << random.below(38);
        if (i % 3 == 0) { // the smallest sums with the largest counts
            sum = {1 + random.below(40), 0};
            count = (uint64_t(1) << 37) - (bits64() >> 30);
        }
        const float mean = mean_of(sum, count);
        smallest += mean != 0 && std::fabs(mean) < 0x1p-94f ? 1 : 0;
        REQUIRE(bits_of(mean) == bits_of(mean_by_ldexp(sum, count)));
    }
    CHECK(smallest > 1000);
    // Halfway between two floats the even one is taken.
    CHECK(mean_of({0, (1u << 24) + 1}, 1) == 0x1p24f);
    CHECK(mean_of({0, (1u << 24) + 3}, 1) == 0x1p24f + 4);
    CHECK(mean_of({1, (1u << 24) + 1}, 1) == 0x1p24f + 2);
    CHECK(mean_of({0, 3 * ((uint64_t(1) << 24) + 1)}, 3) == 0x1p24f);
    CHECK(mean_of({1, 3 * ((uint64_t(1) << 24) + 1)}, 3) == 0x1p24f + 2);
}

TEST_CASE("a million samples lose nothing") {
    FixedSum sum;
    for (int i = 0; i < 1'000'000; ++i) sum = sum + to_fixed(0.1f);
    CHECK(mean_of(sum, 1'000'000) == 0.1f);
}
