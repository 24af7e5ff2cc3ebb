// Exact sums of what a denoiser gathers: their order does not affect the result, their values come back with the
// precision that their kind promises, and values out of range are clamped.

#include <algorithm>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "denoise/exact_sums.h"
#include "math/scalar.h"

using namespace pertev;

namespace {

template <class Sum>
struct OneSum {
    std::vector<int64_t> numbers = std::vector<int64_t>(2 * Sum::kArrays);
    ExactSums sums() { return {numbers.data(), 2}; }
    void add(float x) { Sum::add(sums(), 0, 1, x); } // There are two pixels; the second gets it.
    double get() { return Sum::get(sums(), 0, 1); }
};

template <class Sum>
double sum_of(std::initializer_list<float> values) {
    OneSum<Sum> sum;
    for (const float x : values) sum.add(x);
    CHECK(Sum::get(sum.sums(), 0, 0) == 0);
    return sum.get();
}

template <class Sum>
void check_order(float least, float most) {
    std::mt19937 random(3);
    std::vector<float> values(500);
    for (float& x : values) x = least * std::exp2(std::log2(most / least) * static_cast<float>(random()) * 0x1p-32f);
    OneSum<Sum> forwards, backwards, parts[2];
    for (std::size_t i = 0; i < values.size(); ++i) {
        forwards.add(values[i]);
        parts[i % 3 == 0].add(values[i]);
    }
    std::ranges::reverse(values);
    for (const float x : values) backwards.add(x);
    CHECK(forwards.numbers == backwards.numbers);
    for (std::size_t i = 0; i < forwards.numbers.size(); ++i)
        CHECK(parts[0].numbers[i] + parts[1].numbers[i] == forwards.numbers[i]);
}

} // namespace

TEST_CASE("exact sums do not depend on the order of their values and add up over parts") {
    check_order<SmallSum<3>>(1e-6f, 8.0f);
    check_order<LightSum>(1e-9f, 1e12f);
    check_order<SquareSum>(1e-12f, 1e16f);
}

TEST_CASE("exact sums give back values of either sign, small and large ones together") {
    CHECK(sum_of<SmallSum<1>>({1.5f, -0.25f, 0x1p-38f}) == 1.25 + 0x1p-38);
    CHECK(sum_of<SmallSum<3>>({7.5f, -8.0f, 0x1p-36f}) == -0.5 + 0x1p-36);
    CHECK(sum_of<LightSum>({3.25f, -1.0f, 0x1p-40f}) == 2.25 + 0x1p-40);
    CHECK(sum_of<LightSum>({0x1p40f, -0x1p40f, -0.375f}) == -0.375);
    CHECK(sum_of<SquareSum>({0x1p-48f}) == 0x1p-48);
    CHECK(sum_of<SquareSum>({0x1p56f, 1.0f, 0x1p-10f}) == 0x1p56 + 1);
    CHECK(sum_of<SquareSum>({1.0f, 0x1p-10f, 0x1p-40f}) == 1 + 0x1p-10 + 0x1p-40);
}

TEST_CASE("exact sums clamp what is out of their range, and light that is not a number is none") {
    CHECK(sum_of<SmallSum<1>>({5.0f, -3.0f}) == 0);
    CHECK(sum_of<LightSum>({0x1p50f}) == 0x1p40);
    CHECK(sum_of<LightSum>({kInfinity, -kInfinity, 2.0f}) == 2);
    CHECK(sum_of<LightSum>({kInfinity - kInfinity}) == 0);
    CHECK(sum_of<SquareSum>({0x1p100f}) == 0x1p56);
}

TEST_CASE("exact sums take the largest values as often as a pixel takes samples") {
    const auto most = [](FixedSum one, int limb) {
        return limb == 0 ? static_cast<int64_t>(one.low >> 24) : static_cast<int64_t>(one.high);
    };
    const FixedSum largest = LightSum::fixed_within(0x1p40f);
    const FixedSum fullest = LightSum::fixed_within(0x1.fffffep39f);
    for (const int limb : {0, 1}) {
        for (const FixedSum& one : {largest, fullest})
            CHECK(static_cast<double>(most(one, limb)) * static_cast<double>(kMaxSamplesPerPixel) < 0x1p63);
    }
    CHECK(static_cast<double>(int64_t(1) << 40) * static_cast<double>(kMaxSamplesPerPixel) < 0x1p63); // a whole limb
}
