// One item of many by weight, by a single number.

#include <doctest/doctest.h>

#include <array>
#include <vector>

#include "math/sampler.h"
#include "restir/ris_selection.h"

using namespace pertev;

namespace {

/// How often each item of `weights` is picked, of `draws` evenly spread numbers.
std::vector<double> shares_picked(const std::vector<float>& weights, uint32_t draws) {
    std::vector<double> shares(weights.size());
    for (uint32_t k = 0; k < draws; ++k) {
        RisSelection pick = {(static_cast<float>(k) + 0.5f) / static_cast<float>(draws)};
        std::size_t picked = weights.size();
        for (std::size_t i = 0; i < weights.size(); ++i) {
            if (pick.takes(weights[i])) picked = i;
        }
        if (picked < weights.size()) shares[picked] += 1.0 / draws;
    }
    return shares;
}

} // namespace

TEST_CASE("each item is selected in proportion to its weight") {
    const std::vector<float> weights = {1, 0, 3, 0.5f, 0, 2, 10, 0.001f};
    const std::vector<double> shares = shares_picked(weights, 1u << 20);
    double sum = 0;
    for (const float weight : weights) sum += static_cast<double>(weight);
    for (std::size_t i = 0; i < weights.size(); ++i) {
        CAPTURE(i);
        CHECK(shares[i] == doctest::Approx(static_cast<double>(weights[i]) / sum).epsilon(0.01));
    }
}

TEST_CASE("items whose weight is 0 or NaN are never selected") {
    RisSelection pick = {0.5f};
    CHECK_FALSE(pick.takes(0));
    CHECK_FALSE(pick.takes(-1));
    CHECK_FALSE(pick.takes(float_of(0x7fc00000u)));
    CHECK_FALSE(pick.takes(kInfinity));
    CHECK(pick.sum == 0);
    CHECK(pick.takes(2));
    CHECK(pick.sum == 2);
}

TEST_CASE("resampled draws estimate an integral without bias") {
    // f = x^2 over (0, 1) is 1/3, by uniform candidates resampled for the target x.
    constexpr uint32_t kDraws = 1u << 16, kCandidates = 4;
    double mean = 0;
    for (uint32_t draw = 0; draw < kDraws; ++draw) {
        RisSelection pick = {sample_1d(SamplerKind::Independent, {draw, 0, 1}, 100)};
        float x = 0;
        for (uint32_t k = 0; k < kCandidates; ++k) {
            const float candidate = sample_1d(SamplerKind::Independent, {draw, k, 1}, 200);
            if (pick.takes(candidate / kCandidates)) x = candidate;
        }
        mean += static_cast<double>(x * x * (pick.sum / x)) / kDraws;
    }
    CHECK(mean == doctest::Approx(1.0 / 3).epsilon(0.01));
}
