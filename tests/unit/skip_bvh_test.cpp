// The tree as a list with skip links: valid for every mesh, and its checker detects each kind of fault.

#include "accel/bvh/skip_bvh.h"

#include <doctest/doctest.h>

#include <optional>
#include <string>

#include "accel/builders/build_bvh.h"
#include "tests/support/check_wide_bvh.h"
#include "tests/support/split_bvh.h"
#include "tests/support/stress_meshes.h"

using namespace pertev;
using namespace pertev::test;

TEST_CASE("a list with skip links is valid for every mesh") {
    for (const StressMesh& c : stress_meshes()) {
        CAPTURE(std::string(c.name));
        const Bvh bvh = build_bvh(c.triangles);
        const SkipBvh skip = make_skip_bvh(bvh);
        CHECK(skip.nodes.size() == (c.triangles.empty() ? 0 : 2 * bvh.nodes.size() + 1));
        CHECK(find_fault(skip) == std::nullopt);
        const SkipBvh split = make_skip_bvh(build_split_bvh(c.triangles, 6));
        CHECK(find_fault(split, false) == std::nullopt);
    }
}

TEST_CASE("the checker of lists with skip links detects faults") {
    const SkipBvh sound = make_skip_bvh(build_bvh(make_soup(200, 0)));
    const auto fault_after = [&](auto change) {
        SkipBvh broken = sound;
        change(broken);
        return find_fault(broken) != std::nullopt;
    };
    std::size_t leaf = 0;
    while (sound.nodes[leaf].leaf == kNoLink) ++leaf;
    CHECK(fault_after([](SkipBvh& b) { b.nodes[0].next = 1; }));
    CHECK(fault_after([](SkipBvh& b) { b.nodes[0].next += 1; }));
    CHECK(fault_after([](SkipBvh& b) { b.nodes[1].next = 1; }));
    CHECK(fault_after([&](SkipBvh& b) { b.nodes[leaf].next += 1; }));
    CHECK(fault_after([&](SkipBvh& b) { b.nodes[leaf].lo.x = b.nodes[leaf].hi.x; }));
    CHECK(fault_after([&](SkipBvh& b) { b.nodes[leaf].lo.x = b.bounds.lo.x - 1; }));
    CHECK(fault_after([&](SkipBvh& b) { b.nodes[leaf].leaf = kNoLink; }));
    CHECK(fault_after([&](SkipBvh& b) { b.nodes[leaf].leaf &= ~kLeafBit; }));
    CHECK(fault_after([&](SkipBvh& b) { b.nodes[leaf].leaf += 1; }));
    CHECK(fault_after([](SkipBvh& b) { b.triangles.pop_back(); }));
    CHECK(fault_after([](SkipBvh& b) { b.triangles.push_back(b.triangles.back()); }));
    CHECK(fault_after([](SkipBvh& b) { b.triangles.back().flags = 0; }));
}
