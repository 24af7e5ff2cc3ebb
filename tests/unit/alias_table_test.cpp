#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "base/parallel_for.h"
#include "shading/alias_table.h"

using namespace pertev;

namespace {

/// Probability of each index as the thresholds give it, which is what sample_alias does.
std::vector<double> drawn_probabilities(std::span<const AliasEntry> entries) {
    std::vector<double> probability(entries.size());
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const double own = static_cast<double>(entries[i].threshold);
        probability[i] += own / static_cast<double>(entries.size());
        probability[entries[i].alias] += (1 - own) / static_cast<double>(entries.size());
    }
    return probability;
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

} // namespace

TEST_CASE("alias table: what is drawn, what is stored and the weights are one distribution") {
    for (const std::size_t count : {1u, 2u, 3u, 7u, 64u, 1000u, 4096u, 100000u}) {
        const std::vector<float> weights = random_weights(count, static_cast<uint32_t>(count));
        std::vector<AliasEntry> entries(count);
        const double total = build_alias_entries(weights, entries);
        CHECK(total == doctest::Approx(sum_of(weights)).epsilon(1e-12));
        const std::vector<double> drawn = drawn_probabilities(entries);
        double worst = 0, worst_pmf = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const double want = static_cast<double>(weights[i]) / total;
            worst = std::max(worst, std::abs(drawn[i] - want) / (want + 1e-4 / static_cast<double>(count)));
            worst_pmf = std::max(worst_pmf, std::abs(static_cast<double>(entries[i].pmf) - want) / (want + 1e-30));
            if (weights[i] == 0) CHECK(drawn[i] == 0);
        }
        CAPTURE(count);
        CHECK(worst < 1e-3);
        CHECK(worst_pmf < 1e-7);
    }
}

TEST_CASE("alias table: equal weights give equal probabilities without a detour") {
    std::vector<AliasEntry> entries(1000);
    build_alias_entries(std::vector<float>(1000, 0.1f), entries);
    for (const AliasEntry& entry : entries) {
        CHECK(entry.threshold == 1);
        CHECK(entry.pmf == 1e-3f);
    }
}

TEST_CASE("alias table: an even grid of numbers draws each index by its weight and leaves even numbers behind") {
    const std::vector<float> weights = {1, 0, 5, 2, 0.5f, 1.5f};
    const AliasTable table = build_alias_table(weights);
    const AliasTableView view = view_of(table);
    constexpr uint32_t draws = 1 << 20;
    std::vector<double> count(weights.size()), moment(weights.size()), square_moment(weights.size());
    for (uint32_t k = 0; k < draws; ++k) {
        const float u = (static_cast<float>(k) + 0.5f) / static_cast<float>(draws);
        const BlockAliasSample sample = sample_alias(view, {u, 0.625f});
        REQUIRE(sample.index < weights.size());
        CHECK(sample.pmf == alias_pmf(view, sample.index));
        CHECK(sample.u.y == 0.625f); // few weights: the second number is not touched
        REQUIRE(sample.u.x >= 0);
        REQUIRE(sample.u.x < 1);
        count[sample.index] += 1;
        moment[sample.index] += static_cast<double>(sample.u.x);
        square_moment[sample.index] += static_cast<double>(sample.u.x) * static_cast<double>(sample.u.x);
    }
    for (std::size_t i = 0; i < weights.size(); ++i) {
        CHECK(count[i] / draws == doctest::Approx(static_cast<double>(weights[i]) / 10.0).epsilon(1e-4));
        if (count[i] == 0) continue;
        CHECK(moment[i] / count[i] == doctest::Approx(0.5).epsilon(1e-3));
        CHECK(square_moment[i] / count[i] == doctest::Approx(1.0 / 3).epsilon(1e-3));
    }
}

TEST_CASE("alias table: two levels draw what one level would, and the pmf sums to 1") {
    const std::vector<float> weights = random_weights(50'000, 11);
    const double total = sum_of(weights);
    for (const uint32_t block_size : {0u, 1u, 7u, 256u, 50'000u}) {
        const AliasTable table = build_alias_table(weights, block_size);
        const AliasTableView view = view_of(table);
        const std::vector<double> blocks = drawn_probabilities(table.blocks);
        double sum = 0, worst = 0;
        for (uint32_t i = 0; i < view.count; ++i) {
            const double want = static_cast<double>(weights[i]) / total, pmf = static_cast<double>(alias_pmf(view, i));
            sum += pmf;
            worst = std::max(worst, std::abs(pmf - want) / (want + 1e-30));
        }
        double worst_block = 0;
        for (std::size_t b = 0; b < blocks.size(); ++b) {
            const double want = static_cast<double>(table.blocks[b].pmf);
            worst_block = std::max(worst_block, std::abs(blocks[b] - want) / (want + 1e-8));
        }
        CAPTURE(block_size);
        CHECK(sum == doctest::Approx(1).epsilon(1e-6));
        CHECK(worst < 3e-7);
        CHECK(worst_block < 1e-3);
    }
}

TEST_CASE("alias table: a last block that is shorter is drawn from within its bounds") {
    std::vector<float> weights(10'001, 1.0f);
    const AliasTable table = build_alias_table(weights);
    REQUIRE(table.block_size > 1);
    REQUIRE(table.count % table.block_size != 0);
    const AliasTableView view = view_of(table);
    std::vector<bool> seen(weights.size());
    for (int i = 0; i < 1024; ++i) {
        for (int j = 0; j < 1024; ++j) {
            const Vec2 u = {(static_cast<float>(i) + 0.5f) / 1024, (static_cast<float>(j) + 0.5f) / 1024};
            const BlockAliasSample sample = sample_alias(view, u);
            REQUIRE(sample.index < weights.size());
            seen[sample.index] = true;
        }
    }
    CHECK(std::count(seen.begin(), seen.end(), false) == 0);
}

TEST_CASE("alias table: the largest random number below 1, and 1 itself, stay in range") {
    for (const std::size_t count : {1u, 3u, 1000u, 4095u, 1u << 20}) {
        const AliasTable table = build_alias_table(std::vector<float>(count, 1.0f));
        for (const float u : {0.0f, 0x1.fffffep-1f, 1.0f}) {
            const BlockAliasSample sample = sample_alias(view_of(table), {u, u});
            CHECK(sample.index == (u == 0 ? 0 : count - 1));
            CHECK(sample.u.x < 1);
            CHECK(sample.u.y <= 1);
        }
    }
}

TEST_CASE("alias table: weights that are no weights are never drawn") {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const std::vector<float> weights = {nan, 1, -3, 1e-45f, kInfinity, 3};
    std::vector<AliasEntry> entries(weights.size());
    CHECK(build_alias_entries(weights, entries) == doctest::Approx(4));
    const std::vector<double> drawn = drawn_probabilities(entries);
    CHECK(drawn[1] == doctest::Approx(0.25));
    CHECK(drawn[5] == doctest::Approx(0.75));
    for (const std::size_t i : {0u, 2u, 4u}) CHECK(drawn[i] == 0);
    CHECK(drawn[3] < 1e-30);

    for (const std::vector<float>& none : {std::vector<float>{}, {0, 0, 0}, std::vector<float>(9000), {nan, -1}}) {
        const AliasTable table = build_alias_table(none);
        CHECK(table.count == 0);
        CHECK(sample_alias(view_of(table), {0.5f, 0.5f}).pmf == 0);
    }
}

TEST_CASE("alias table: the build gives the same bits on any number of threads") {
    const std::vector<float> weights = random_weights(300'000, 12);
    set_thread_count(1);
    const AliasTable one = build_alias_table(weights);
    set_thread_count(7);
    const AliasTable seven = build_alias_table(weights);
    set_thread_count(0);
    const auto same = [](const std::vector<AliasEntry>& a, const std::vector<AliasEntry>& b) {
        return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](AliasEntry x, AliasEntry y) {
                   return x.threshold == y.threshold && x.alias == y.alias && x.pmf == y.pmf;
               });
    };
    CHECK(same(one.blocks, seven.blocks));
    CHECK(same(one.entries, seven.entries));
    CHECK(one.total == seven.total);
}
