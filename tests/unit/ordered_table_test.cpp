#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "math/sampler.h"
#include "shading/alias_table.h"

using namespace pertev;

namespace {

/// How many of all numbers draw each index, by the thresholds.
std::vector<uint64_t> drawn_numbers(std::span<const AliasEntry> entries) {
    const uint64_t slot = (uint64_t(1) << 32) / entries.size();
    std::vector<uint64_t> drawn(entries.size());
    for (std::size_t i = 0; i < entries.size(); ++i) {
        REQUIRE(entries[i].threshold <= slot);
        REQUIRE(entries[i].alias < entries.size());
        drawn[i] += entries[i].threshold;
        drawn[entries[i].alias] += slot - entries[i].threshold;
    }
    return drawn;
}

/// Weights over many orders of magnitude, every third one zero.
std::vector<float> random_weights(std::size_t count, uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> exponent(-20, 10);
    std::vector<float> weights(count);
    for (std::size_t i = 0; i < count; ++i) weights[i] = i % 3 == 1 ? 0.0f : std::exp2(exponent(random));
    return weights;
}

double sum_of(std::span<const float> weights) {
    double sum = 0;
    for (const float weight : weights) sum += static_cast<double>(weight);
    return sum;
}

std::vector<AliasEntry> build(std::span<const float> weights, AliasNumbers numbers) {
    std::vector<AliasEntry> entries(std::size_t(1) << alias_slot_bits(weights.size()));
    build_alias_entries(weights, numbers, entries);
    return entries;
}

constexpr AliasNumbers kBothNumbers[] = {AliasNumbers::Bits32, AliasNumbers::Floats};

} // namespace

TEST_CASE("alias table: what is drawn has just the probability that is stored, which is the weight's") {
    for (const AliasNumbers numbers : kBothNumbers) {
        for (const std::size_t count : {1u, 2u, 3u, 7u, 64u, 1000u, 4096u, 100'000u}) {
            const std::vector<float> weights = random_weights(count, static_cast<uint32_t>(count));
            const std::vector<AliasEntry> entries = build(weights, numbers);
            const std::vector<uint64_t> drawn = drawn_numbers(entries);
            const double total = sum_of(weights), least = std::ldexp(1.0, -static_cast<int>(numbers));
            double worst = 0;
            uint64_t wrong = 0, not_floats = 0;
            for (std::size_t i = 0; i < entries.size(); ++i) {
                const double weight = i < count ? static_cast<double>(weights[i]) : 0.0;
                if (entries[i].pmf != static_cast<float>(std::ldexp(static_cast<double>(drawn[i]), -32))) ++wrong;
                if ((weight > 0) != (drawn[i] > 0)) ++wrong;
                if (numbers == AliasNumbers::Floats && entries[i].threshold % 512 != 0) ++not_floats;
                // One number each, the others by weight.
                const double by_weight = weight / total * (1 - least * static_cast<double>(count));
                worst = std::max(worst, std::abs(static_cast<double>(entries[i].pmf) - by_weight) - 1e-7 * by_weight);
            }
            CAPTURE(count);
            CAPTURE(static_cast<int>(numbers));
            CHECK(wrong == 0);
            CHECK(not_floats == 0);
            CHECK(worst <= (count > 1 ? 2 * least + least * static_cast<double>(count) : least));
        }
    }
}

TEST_CASE("alias table: all 2^23 floats of the sampler draw each index as often as its probability says") {
    // Lights of four decades of power: with 4096 slots, 11 bits of a float are left for the threshold.
    for (const std::size_t count : {5u, 700u, 4096u}) {
        std::vector<float> weights(count);
        for (std::size_t i = 0; i < count; ++i) weights[i] = i % 2 == 0 ? 1.0f : 1e-4f;
        const std::vector<AliasEntry> entries = build(weights, AliasNumbers::Floats);
        const AliasTableView table = view_of(entries);
        std::vector<uint32_t> drawn(count);
        for (uint32_t k = 0; k < 1u << 23; ++k) ++drawn[sample_alias(table, alias_number(unit_interval(k << 9))).index];
        uint64_t wrong = 0;
        for (uint32_t i = 0; i < count; ++i) {
            if (alias_pmf(table, i) * 0x1p23f != static_cast<float>(drawn[i]) || drawn[i] == 0) ++wrong;
        }
        CAPTURE(count);
        CHECK(wrong == 0);
    }
}

TEST_CASE("alias table: equal weights give equal probabilities without a detour") {
    const std::vector<AliasEntry> entries = build_alias_table(std::vector<float>(1024, 0.1f));
    for (const AliasEntry& entry : entries) {
        CHECK(entry.threshold == 1u << 22);
        CHECK(entry.pmf == 0x1p-10f);
    }
}

TEST_CASE("alias table: an even grid of numbers draws each index by its weight and leaves even numbers behind") {
    const std::vector<float> weights = {1, 0, 5, 2, 0.5f, 1.5f};
    const std::vector<AliasEntry> entries = build_alias_table(weights);
    const AliasTableView table = view_of(entries);
    constexpr uint32_t draws = 1 << 20;
    std::vector<double> count(weights.size()), moment(weights.size()), square_moment(weights.size());
    for (uint32_t k = 0; k < draws; ++k) {
        const AliasSample sample = sample_alias(table, (k << 12) + (1 << 11));
        REQUIRE(sample.index < weights.size());
        CHECK(sample.pmf == alias_pmf(table, sample.index));
        REQUIRE(sample.u >= 0);
        REQUIRE(sample.u < 1);
        count[sample.index] += 1;
        moment[sample.index] += static_cast<double>(sample.u);
        square_moment[sample.index] += static_cast<double>(sample.u) * static_cast<double>(sample.u);
    }
    for (std::size_t i = 0; i < weights.size(); ++i) {
        CHECK(count[i] / draws == doctest::Approx(static_cast<double>(weights[i]) / 10.0).epsilon(1e-4));
        if (count[i] == 0) continue;
        CHECK(moment[i] / count[i] == doctest::Approx(0.5).epsilon(1e-3));
        CHECK(square_moment[i] / count[i] == doctest::Approx(1.0 / 3).epsilon(1e-3));
    }
}

TEST_CASE("alias table: the least and the largest random number, and 1 itself, stay in range") {
    for (const AliasNumbers numbers : kBothNumbers) {
        for (const std::size_t count : {1u, 3u, 1000u, 4095u, 1u << 20}) {
            const std::vector<AliasEntry> entries = build(std::vector<float>(count, 1.0f), numbers);
            for (const uint32_t number :
                 {0u, 0xffffffffu, alias_number(0), alias_number(0x1.fffffep-1f), alias_number(1)}) {
                const AliasSample sample = sample_alias(view_of(entries), number);
                CHECK(sample.index < count);
                CHECK(sample.pmf > 0);
                CHECK(sample.u >= 0);
                CHECK(sample.u < 1);
            }
        }
    }
}

TEST_CASE("alias table: weights that are no weights are never drawn, the least one is") {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const std::vector<float> weights = {nan, 1, -3, 1e-45f, kInfinity, 3};
    const std::vector<AliasEntry> entries = build_alias_table(weights);
    const std::vector<uint64_t> drawn = drawn_numbers(entries);
    CHECK(static_cast<double>(entries[1].pmf) == doctest::Approx(0.25));
    CHECK(static_cast<double>(entries[5].pmf) == doctest::Approx(0.75));
    for (const std::size_t i : {0u, 2u, 4u, 6u, 7u}) CHECK(drawn[i] == 0);
    CHECK(drawn[3] == 1);

    for (const std::vector<float>& none : {std::vector<float>{}, {0, 0, 0}, std::vector<float>(9000), {nan, -1}}) {
        CHECK(build_alias_table(none).empty());
        CHECK(view_of(build_alias_table(none)).entries == nullptr);
    }
}
