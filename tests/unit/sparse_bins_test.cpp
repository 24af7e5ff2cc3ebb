// Cuts between bins, of which few are occupied, as in most nodes of a tree.

#include <doctest/doctest.h>

#include <array>
#include <utility>
#include <vector>

#include "accel/bvh/binned_cut.h"
#include "tests/support/random.h"

using namespace pertev;
using namespace pertev::test;

TEST_CASE("the cheapest cut of bins, of which few are occupied, is the first of the least cost among all") {
    Random random(4);
    for (int round = 0; round < 300; ++round) {
        const int count = round % 2 == 0 ? 16 : kMaxBins;
        Bins bins(count), parts[2] = {Bins(count), Bins(count)};
        std::vector<std::pair<std::array<int, 3>, Box4>> boxes;
        for (uint32_t i = 0; i < 2 + random.below(9); ++i) {
            const Vec3 lo = random.point(-1, 1), hi = lo + random.point(0, 1);
            const Box4 box = {_mm_setr_ps(lo.x, lo.y, lo.z, 0), _mm_setr_ps(hi.x, hi.y, hi.z, 0)};
            std::array<int, 3> at;
            for (int axis = 0; axis < 3; ++axis) {
                const uint32_t most = axis == round % 3 ? 1 : static_cast<uint32_t>(count);
                at[static_cast<std::size_t>(axis)] = static_cast<int>(random.below(most));
                parts[i % 2].add(axis, at[static_cast<std::size_t>(axis)], box, 1);
            }
            boxes.emplace_back(at, box);
        }
        for (const Bins& part : parts) add_bins(part, bins);
        BinnedCut expected;
        for (int axis = 0; axis < 3; ++axis) {
            for (int bin = 1; bin < count; ++bin) {
                Box4 left, right;
                float lefts = 0, rights = 0;
                for (const auto& [at, box] : boxes) {
                    const bool is_left = at[static_cast<std::size_t>(axis)] < bin;
                    (is_left ? left : right).extend(box);
                    (is_left ? lefts : rights) += 1;
                }
                if (lefts == 0 || rights == 0) continue;
                const float cost = half_area(left) * lefts + half_area(right) * rights;
                if (cost < expected.cost) expected = {axis, bin, cost, left, right};
            }
        }
        const BinnedCut found = find_cheapest_cut(bins);
        CHECK(found.axis == expected.axis);
        CHECK(found.bin == expected.bin);
        CHECK(found.cost == expected.cost);
        if (expected.axis < 0) continue;
        CHECK(half_area(found.left) == half_area(expected.left));
        CHECK(half_area(found.right) == half_area(expected.right));
    }
}
