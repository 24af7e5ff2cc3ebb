#include <doctest/doctest.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "math/hilbert_curve.h"

using namespace pertev;

TEST_CASE("the Hilbert curve visits every cell once, each adjacent to the previous one") {
    // The first 8^4 points of the curve fill the first 16 x 16 x 16 cells.
    constexpr uint32_t side = 16, count = side * side * side;
    std::vector<std::array<int, 3>> cells(count, {-1, -1, -1});
    for (uint32_t i = 0; i < count; ++i) {
        const std::array<uint32_t, 3> cell = {i % side, i / side % side, i / (side * side)};
        const uint32_t position = hilbert_position(cell);
        REQUIRE(position < count);
        CHECK(cells[position][0] == -1);
        cells[position] = {static_cast<int>(cell[0]), static_cast<int>(cell[1]), static_cast<int>(cell[2])};
    }
    for (uint32_t i = 1; i < count; ++i) {
        int steps = 0;
        for (std::size_t d = 0; d < 3; ++d) steps += std::abs(cells[i][d] - cells[i - 1][d]);
        CHECK(steps == 1);
    }
}

TEST_CASE("a point's index on the curve is that of its cell, even in a box without extent") {
    const Bounds3 bounds = {{-1, 0, 2}, {1, 2, 4}};
    CHECK(hilbert_position(bounds.lo, bounds) == hilbert_position({0, 0, 0}));
    CHECK(hilbert_position(bounds.hi, bounds) == hilbert_position({1023, 1023, 1023}));
    CHECK(hilbert_position({3, 3, 3}, Bounds3{{3, 3, 3}, {3, 3, 3}}) == 0);
}
