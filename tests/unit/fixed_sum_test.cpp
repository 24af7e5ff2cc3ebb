#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/fixed_sum.h"
#include "tests/support/random.h"

using namespace pertev;

namespace {

/// Value of a fixed-point number, exact where it fits 64 significant bits.
long double value_of(FixedSum sum) {
    return std::ldexp(static_cast<long double>(static_cast<int64_t>(sum.high)), 0) +
           std::ldexp(static_cast<long double>(sum.low), -64);
}

} // namespace

TEST_CASE("a float in fixed point is itself, cut towards zero below 2^-64") {
    for (const float x : {0.0f, -0.0f, 1.0f, -1.0f, 0.1f, -0.3f, 1e-10f, 3e11f, -0x1p40f, 0x1p-64f, 0x1.8p-64f}) {
        CAPTURE(x);
        const long double cut = std::ldexp(std::trunc(std::ldexp(static_cast<long double>(x), 64)), -64);
        CHECK(value_of(to_fixed(x)) == cut);
    }
    CHECK(to_fixed(0x1p-65f) == FixedSum{});
    CHECK(to_fixed(-0x1p-140f) == FixedSum{}); // subnormal
}

TEST_CASE("a sum does not depend on the order, and atomic additions give the same") {
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
        CHECK(mean_of(negative, count) == -mean);
    }
}

TEST_CASE("a million samples lose nothing") {
    FixedSum sum;
    for (int i = 0; i < 1'000'000; ++i) sum = sum + to_fixed(0.1f);
    CHECK(mean_of(sum, 1'000'000) == 0.1f);
}
