// Selection of one item of many by weight, with a single random number (restir/ris_selection.h).

#include <doctest/doctest.h>

#include <array>
#include <vector>

#include "math/sampler.h"
#include "restir/ris_selection.h"

using namespace pertev;

namespace {

/// Returns how often each item of `weights` is selected by `draws` evenly spaced numbers.
std::vector<double> shares_selected(const std::vector<float>& weights, uint32_t draws) {
    std::vector<double> shares(weights.size());
    for (uint32_t k = 0; k < draws; ++k) {
        RisSelection selection = {(static_cast<float>(k) + 0.5f) / static_cast<float>(draws)};
        std::size_t selected = weights.size();
        for (std::size_t i = 0; i < weights.size(); ++i) {
            if (selection.takes(weights[i])) selected = i;
        }
        if (selected < weights.size()) shares[selected] += 1.0 / draws;
    }
    return shares;
}

} // namespace

TEST_CASE("each item is selected in proportion to its weight") {
    const std::vector<float> weights = {1, 0, 3, 0.5f, 0, 2, 10, 0.001f};
    const std::vector<double> shares = shares_selected(weights, 1u << 20);
    double sum = 0;
    for (const float weight : weights) sum += static_cast<double>(weight);
    for (std::size_t i = 0; i < weights.size(); ++i) {
        CAPTURE(i);
        CHECK(shares[i] == doctest::Approx(static_cast<double>(weights[i]) / sum).epsilon(0.01));
    }
}

TEST_CASE("items whose weight is 0 or NaN are never selected") {
    RisSelection selection = {0.5f};
    CHECK_FALSE(selection.takes(0));
    CHECK_FALSE(selection.takes(-1));
    CHECK_FALSE(selection.takes(float_of(0x7fc00000u)));
    CHECK_FALSE(selection.takes(kInfinity));
    CHECK(selection.sum == 0);
    CHECK(selection.takes(2));
    CHECK(selection.sum == 2);
}

TEST_CASE("resampled draws estimate an integral without bias") {
    // The integral of x^2 over (0, 1) is 1/3. Uniform candidates are resampled for the target x.
    constexpr uint32_t kDraws = 1u << 16, kCandidates = 4;
    double mean = 0;
    for (uint32_t draw = 0; draw < kDraws; ++draw) {
        RisSelection selection = {sample_1d(SamplerKind::Independent, {draw, 0, 1}, 100)};
        float x = 0;
        for (uint32_t k = 0; k < kCandidates; ++k) {
            const float candidate = sample_1d(SamplerKind::Independent, {draw, k, 1}, 200);
            if (selection.takes(candidate / kCandidates)) x = candidate;
        }
        mean += static_cast<double>(x * x * (selection.sum / x)) / kDraws;
    }
    CHECK(mean == doctest::Approx(1.0 / 3).epsilon(0.01));
}
