// The skipping rule: a node is skipped only if the ray misses its box or enters it beyond the limit. Equal is entered,
// in binary and wide traversals and when a node is popped from the stack.

#include "trace/binary/traverse_tree.h"

#include <doctest/doctest.h>

#include <cmath>

#include "accel/builders/build_bvh.h"
#include "accel/bvh/wide_bvh.h"
#include "tests/support/meshes.h"
#include "trace/wide/traverse_wide.h"

using namespace pertev;
using namespace pertev::test;

TEST_CASE("a box whose entry equals the limit is entered, but not with a limit one ulp less") {
    Random random(6);
    const Bvh bvh = build_bvh(triangles_of(make_torus(16, 12)));
    const std::vector<WideBvhNode<8>> wide = make_wide_bvh<8>(bvh, kSimdCollapse).nodes;
    uint64_t tried = 0, wide_tried = 0, wrong = 0;
    for (int i = 0; i < 20000; ++i) {
        const Vec3 origin = random.point(-4, 4), direction = random.point(-1, 1) - origin;
        const RayBoxes boxes = make_ray_boxes(origin, direction, bvh.bounds.max_abs());
        const BvhNode& node = bvh.nodes[random.below(static_cast<uint32_t>(bvh.nodes.size()))];
        float entry, again;
        if (enters_child(boxes, node, i % 2, 0, kInfinity, entry) && entry > 0) {
            ++tried;
            wrong += !enters_child(boxes, node, i % 2, 0, entry, again) || again != entry ? 1 : 0;
            wrong += enters_child(boxes, node, i % 2, 0, std::nextafterf(entry, 0), again) ? 1 : 0;
        }
        const WideRay wide_ray = make_wide_ray<TraversalOptions{}>({origin, 0, direction}, bvh.bounds.max_abs());
        const WideBvhNode<8>& wide_node = wide[random.below(static_cast<uint32_t>(wide.size()))];
        alignas(32) float entries[kWideChildren];
        const __m256 zero = _mm256_setzero_ps();
        const EnteredChildren children = enters_children(wide_ray, wide_node, zero, _mm256_set1_ps(kInfinity));
        const unsigned entered = children.mask();
        _mm256_store_ps(entries, children.entries);
        for (unsigned k = 0; k < kWideChildren; ++k) {
            if (!(entered >> k & 1) || !(entries[k] > 0)) continue;
            ++wide_tried;
            const auto enters = [&](float limit) {
                return (enters_children(wide_ray, wide_node, zero, _mm256_set1_ps(limit)).mask() >> k & 1) != 0;
            };
            wrong += !enters(entries[k]) || enters(std::nextafterf(entries[k], 0)) ? 1 : 0;
        }
    }
    CHECK(tried > 500);
    CHECK(wide_tried > 1000);
    CHECK(wrong == 0);
}

TEST_CASE("a node on the stack is visited if its entry equals the limit and dropped if it is greater") {
    TreeStack::Slot slots[3];
    TreeStack stack = {slots};
    stack.push(7, 1.0f), stack.push(8, 2.0f), stack.push(9, 2.0000002f);
    TreeTraversal traversal = {kNoLink, stack.size};
    finish_leaf(traversal, slots, 2.0f);
    CHECK(traversal.link == 8);
    CHECK(traversal.size == 1);
    finish_leaf(traversal, slots, 0.5f);
    CHECK(traversal.link == kNoLink);
    CHECK(traversal.size == 0);
}

TEST_CASE("an inner node without a box on the ray continues with the stack, including equal entries") {
    // One node far from the ray, and a leaf on the stack.
    BvhNode node = {};
    set_child(node, 0, {{100, 100, 100}, {101, 101, 101}}, kLeafBit | 1u);
    set_child(node, 1, {{200, 200, 200}, {201, 201, 201}}, kLeafBit | 2u);
    const RayBoxes boxes = make_ray_boxes({0, 0, 0}, {1, 0, 0}, 201);
    for (const float limit : {2.0f, std::nextafterf(2.0f, 0)}) {
        TreeStack::Slot slots[4];
        TreeStack stack = {slots};
        stack.push(kLeafBit | 5u, 2.0f);
        TreeTraversal traversal = {0, stack.size};
        CHECK(next_leaf(traversal, &node, boxes, 0, limit, slots, NoTraversalCounter{}) ==
              (limit == 2.0f ? (kLeafBit | 5u) : kNoLink));
    }
}
