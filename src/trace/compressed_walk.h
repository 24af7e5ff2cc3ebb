#pragma once

// The walk of the compressed 8-wide tree: what is left to do is kept in groups, one 8-byte entry for all the children
// of a node that are still to be entered, nearest octant first without any sorting.
//
// Source: Ylitie, Karras, Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG 2017,
// section 4. Their pushed triangle groups serve to fill the lanes of a warp; a node's are tested at once here.
//
// RTA: boxes are compared with the nearest hit so far, at the node test. A group carries no distances, so nothing is
// dropped at a pop: what was entered before the hit came near is fetched once more, and there all its boxes fail. On
// Sponza those are 8 to 15 % of all nodes, and only an entry kept for each child, not one a group, would save them.
// near_first off, and any hit: in the order of slots.

#include <cstdint>

#include "accel/bvh/compressed_bvh.h"
#include "base/host_device.h"
#include "base/limits.h"
#include "math/bits.h"
#include "trace/compressed_boxes.h"
#include "trace/load_bvh.h"
#include "trace/walk_options.h"

namespace pertev {

struct NodeGroup {
    uint32_t base;  // CompressedBvhNode::child_base
    uint32_t slots; // bits 24 to 31: to be entered, highest first: bit 24 + (s ^ flip) is slot s; 0 to 7: inner slots
};

template <WalkOptions kOptions>
struct CompressedWalk {
    using Tree = CompressedBvhView;

    template <class Visitor, class Counter>
    HD static bool walk(const CompressedBvhView& bvh, const Ray& ray, uint32_t instance, Visitor& visitor,
                        const Counter& counter) {
        using Tests = TestsOf<kOptions>;
        if (bvh.nodes == nullptr) return false;
        NodeGroup stack[kMaxBvhDepth]; // a group a level
        int size = 0;
        const RayBoxes boxes = Tests::make_boxes(guard_for_compressed(ray), bvh.bounds_max_abs);
        const typename Tests::Triangles prepared = Tests::make_triangles(ray);
        const uint32_t octant = (boxes.inv.x < 0 ? 1u : 0u) | (boxes.inv.y < 0 ? 2u : 0u) | (boxes.inv.z < 0 ? 4u : 0u);
        const uint32_t flip = kOptions.near_first && Visitor::kNearestFirst ? octant ^ 7u : 7u;
        NodeGroup group = {0, 1u << 24}; // the root: slot `flip`, with no inner slot before it
        for (;;) {
            const uint32_t bit = highest_bit(group.slots), slot = (bit - 24) ^ flip;
            group.slots ^= 1u << bit;
            const CompressedBvhNode* at = bvh.nodes + group.base + count_ones(group.slots & 0xffu & ((1u << slot) - 1));
            if (group.slots > 0x00ffffffu) stack[size++] = group;
            counter.add_node(at);
            const CompressedBvhNode node = load_aligned(at);
            const uint32_t entered = enters_slots(boxes, node, ray.t_min, skip_beyond<kOptions>(visitor, ray));
            const uint32_t inner = inner_slots(node);
            for (uint32_t left = spread_slots(entered) & node.triangles; left != 0; left &= left - 1) {
                const uint32_t before = count_ones(node.triangles & ((left & (0u - left)) - 1));
                const BvhTriangle* triangle_at = bvh.triangles + node.triangle_base + before;
                counter.add_triangle(triangle_at);
                const BvhTriangle triangle = load_aligned(triangle_at);
                TriangleHit hit;
                if (Tests::intersect(ray, prepared, triangle.a, triangle.b, triangle.c, hit) &&
                    visitor.visit(instance == kNoHit ? triangle.instance : instance, triangle.primitive, hit)) {
                    return true;
                }
            }
            group = {node.child_base, flip_slots(entered & inner, flip) << 24 | inner};
            if (group.slots <= 0x00ffffffu) {
                if (size == 0) return false;
                group = stack[--size];
            }
        }
    }
};

} // namespace pertev
