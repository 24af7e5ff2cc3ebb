// Parent links lead from every node to the root. They store the axis along which the children are farthest apart, and
// which child is lower.

#include "accel/bvh/parent_links.h"

#include <doctest/doctest.h>

#include <string>

#include "accel/builders/build_bvh.h"
#include "tests/support/stress_meshes.h"

using namespace pertev;
using namespace pertev::test;

TEST_CASE("parent links lead from every node to the root") {
    for (const StressMesh& c : stress_meshes()) {
        CAPTURE(std::string(c.name));
        Bvh bvh = build_bvh(c.triangles);
        for (const BvhNode& node : bvh.nodes)
            CHECK((node.parent == 0 && node.split == 0)); // the tree as the cache stores it
        add_parent_links(bvh);
        if (!(bvh.root & kLeafBit)) CHECK(bvh.nodes[bvh.root].parent == kNoLink);
        uint64_t wrong = 0;
        for (uint32_t i = 0; i < bvh.nodes.size(); ++i) {
            int up = 0;
            for (uint32_t at = i; at != bvh.root && up <= bvh.depth; ++up) {
                const uint32_t parent = bvh.nodes[at].parent & ~kSecondChildBit;
                const int k = (bvh.nodes[at].parent & kSecondChildBit) ? 1 : 0;
                wrong += bvh.nodes[parent].child[k] != at ? 1 : 0;
                at = parent;
            }
            wrong += up > bvh.depth ? 1 : 0;
            const uint32_t split = bvh.nodes[i].split;
            const int axis = static_cast<int>(split & 3), lower = (split & kSecondIsLower) ? 1 : 0;
            const Vec3 apart = abs(child_bounds(bvh.nodes[i], 1).centre() - child_bounds(bvh.nodes[i], 0).centre());
            wrong += component(apart, axis) < max_component(apart) ? 1 : 0;
            wrong += component(child_bounds(bvh.nodes[i], lower).centre(), axis) >
                             component(child_bounds(bvh.nodes[i], 1 - lower).centre(), axis)
                         ? 1
                         : 0;
        }
        CHECK(wrong == 0);
    }
}
