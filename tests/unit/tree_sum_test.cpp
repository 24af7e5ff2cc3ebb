// The rounding error of sums in a fixed tree, and the tree itself.

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "math/tree_sum.h"
#include "tests/support/random.h"

using namespace pertev;

namespace {

/// A sum that records its additions.
struct Text {
    std::string text;
};

Text operator+(const Text& a, const Text& b) { return {"(" + a.text + " " + b.text + ")"}; }

std::string tree_of(uint64_t count) {
    return tree_sum(count, [](uint64_t i) { return Text{std::to_string(i)}; }).text;
}

/// The tree sum and the sequential sum, in double for comparison.
struct Sums {
    float tree = 0, in_turn = 0;
    double exact = 0;
};

Sums sums_of(const std::vector<float>& terms) {
    Sums sums;
    sums.tree = tree_sum(terms.size(), [&](uint64_t i) { return terms[i]; });
    for (const float term : terms) sums.in_turn += term, sums.exact += static_cast<double>(term);
    return sums;
}

} // namespace

TEST_CASE("the tree of a sum depends only on the count") {
    CHECK(tree_of(0).empty());
    CHECK(tree_of(1) == "0");
    CHECK(tree_of(2) == "(0 1)");
    CHECK(tree_of(3) == "((0 1) 2)");
    CHECK(tree_of(4) == "((0 1) (2 3))");
    CHECK(tree_of(5) == "(((0 1) (2 3)) 4)");
    CHECK(tree_of(7) == "(((0 1) (2 3)) ((4 5) 6))");
    const std::string eight = "(((0 1) (2 3)) ((4 5) (6 7)))";
    CHECK(tree_of(8) == eight);
    CHECK(tree_of(11) == "(" + eight + " ((8 9) 10))");
    CHECK(tree_of(13) == "(" + eight + " (((8 9) (10 11)) 12))");
    for (const uint64_t count : {17u, 64u, 1000u}) { // the sum of the first terms is a subtree
        CHECK(tree_of(count).find(tree_of(16)) != std::string::npos);
    }
}

TEST_CASE("each term of a sum is requested once and in order") {
    for (uint64_t count = 0; count < 70; ++count) {
        std::vector<uint64_t> requested;
        const uint64_t sum = tree_sum(count, [&](uint64_t i) {
            requested.push_back(i);
            return i + 1;
        });
        REQUIRE(requested.size() == count);
        for (uint64_t i = 0; i < count; ++i) CHECK(requested[i] == i);
        CHECK(sum == count * (count + 1) / 2);
    }
}

TEST_CASE("a tree sum is more exact than a sequential sum") {
    // From 2^24 on a float does not change by 1.
    constexpr uint64_t count = (uint64_t(1) << 25) + 1;
    float in_turn = 0;
    for (uint64_t i = 0; i < count; ++i) in_turn += 1.0f;
    CHECK(in_turn == 0x1p24f);
    CHECK(tree_sum(count - 1, [](uint64_t) { return 1.0f; }) == 0x1p25f);
    CHECK(tree_sum(count, [](uint64_t) { return 1.0f; }) == 0x1p25f); // the nearest float, ties to even

    test::Random random(7);
    for (const std::size_t many : {1000u, 99'999u, 1'000'000u}) {
        std::vector<float> terms;
        for (std::size_t i = 0; i < many; ++i) terms.push_back(random.unit());
        const Sums sums = sums_of(terms);
        const double bound = std::ceil(std::log2(static_cast<double>(many))) * 0x1p-24; // Higham 1993
        CAPTURE(many);
        CHECK(std::abs(static_cast<double>(sums.tree) - sums.exact) <= bound * sums.exact);
        if (many < 1'000'000u) continue;
        CHECK(std::abs(static_cast<double>(sums.in_turn) - sums.exact) > bound * sums.exact);
    }
}
