#pragma once

// The walk of the compressed 8-wide tree: what is left to do is kept in groups, one 8-byte entry for all the children
// of a node that are still to be entered, nearest octant first (or farthest, below) without any sorting.
//
// Source: Ylitie, Karras, Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG 2017,
// section 4, with its postponing of triangles: a warp tests them only while enough of its lanes have some, and goes on
// down otherwise. Unlike theirs, the triangles that are put off stay in registers until the ray finds more,
// and only those go to the stack. How long they are put off is a matter of the warp; the hits are not. On the host,
// where a warp is one ray, nothing is put off.
//
// RTA: a hit shortens the segment that boxes are tested against, and a group carries where the ray enters
// the nearest of its waiting children, so that it is dropped at a pop when that lies beyond. That saves 7 to
// 8 % of the nodes in Sponza and costs more instructions than it saves: rta_at_pops off is without it. Triangles that
// were put off carry no distance: they are tested whatever was hit meanwhile.
// near_first off: in the order of slots. On: a search for any hit may ask for far children first (trace_any.h).

#include <cstddef>
#include <cstdint>

#include "accel/bvh/compressed_bvh.h"
#include "base/host_device.h"
#include "base/limits.h"
#include "math/bits.h"
#include "trace/intersect/compressed_boxes.h"
#include "trace/intersect/load_bvh.h"
#include "trace/traversal/walk_by_turns.h"
#include "trace/traversal/walk_options.h"
#include "trace/warps/warp_vote.h"

namespace pertev {

/// Triangles are tested while at least this many of `working` lanes have some: 13 of 32, about 40 %; theirs is 20 %.
/// Counted for warps of 32, not timed, on the second diffuse bounce in Sponza: 2.7 lanes test a triangle together where
/// none are put off, 7.4 by their rule at 20 %, 13 by this one at 40 %, while 25 of 32 test a node. From 35 to 50 % the
/// instructions a ray takes change by 2 %. At least 1.
HD inline int lanes_for_triangles(int working) { return (13 * working + 31) / 32; }

/// The children of one node that are still to be entered.
struct NodeGroup {
    uint32_t base; // CompressedBvhNode::child_base
    uint32_t left; // bits 0 to 7: slots to be entered; 8 to 23: with RTA at pops, the upper half of a float that no
                   // entry of those after the first is less than; 24 to 31: all inner slots, at least one

    HD bool is_empty() const { return (left & 0xffu) == 0; }
    HD float entry() const { return float_of((left & 0xffff00u) << 8); }
};

/// The triangles of one node that are still to be tested.
struct TriangleGroup {
    uint32_t base; // CompressedBvhNode::triangle_base
    uint32_t all;  // CompressedBvhNode::triangles
    uint32_t left; // of these

    HD bool is_empty() const { return left == 0; }
};

/// Where a walk stands between two turns.
template <WalkOptions kOptions>
struct CompressedPlace {
    using Tests = TestsOf<kOptions>;
    static constexpr bool kRtaAtPops = kOptions.rta && kOptions.rta_at_pops;
    // Searches for the closest hit go by the signs of 1/direction: with a register for an order they are 5 % slower.
    static constexpr bool kEitherWay = kOptions.any_hit && kOptions.near_first;
    // One store, where a struct would become two. Upper half from 2^24: a NodeGroup, whose base is the lower half;
    // less: the `left` of triangles, and the lower half is their node.
    using Slot = uint64_t;
    // Of each node on the way down at most its children and its triangles; what lies above them is of nodes beneath it.
    static constexpr int kSlots = 2 * kMaxBvhDepth;
    static constexpr int kRefillBelow = 24; // for dynamic fetch

    // [kSlots], an array of its own: see WalkStack. In local memory on the device: pushes are few, and more of the
    // stack in shared memory, as theirs, would be taken from the L1 cache that all nodes are gathered through. Its top
    // is held in registers, so that no lane waits for one that it pops: [k] lies below entry k, [0] below the first.
    Slot* slots;
    Slot top = 0;
    int size = 0;
    NodeGroup nodes = {0, 0};
    TriangleGroup triangles = {0, 0, 0}; // found, and put off
    RaySegment segment = {};
    uint32_t order = 0; // of slots, for searches that may go either way
    typename Tests::Triangles prepared = {};

    HD explicit CompressedPlace(Slot* memory) : slots(memory) {}

    HD bool is_done() const { return nodes.is_empty() && triangles.is_empty() && size == 0; }
    HD void stop() {
        size = 0;
        nodes.left = triangles.left = 0;
    }
    /// Which triangles a node has, of which none is left; one load of 8 bytes.
    HD static TriangleGroup load_triangles(const CompressedBvhNode* node) {
#if PERTEV_ON_DEVICE
        static_assert(offsetof(CompressedBvhNode, triangle_base) % 8 == 0);
        static_assert(offsetof(CompressedBvhNode, triangles) == offsetof(CompressedBvhNode, triangle_base) + 4);
        const uint2 pair = __ldg(reinterpret_cast<const uint2*>(&node->triangle_base));
        return {pair.x, pair.y, 0};
#else
        return {node->triangle_base, node->triangles, 0};
#endif
    }
    HD void push(uint32_t lower, uint32_t left) {
        slots[size++] = top;
        top = uint64_t(left) << 32 | lower;
    }

    /// Takes one entry from the stack, where there is need of it; a node entered beyond `limit` is dropped. Triangles
    /// that meet others which are put off stay there, and the ray waits. One a turn: the next turn takes another one
    /// sooner than a loop would bring a warp's lanes together again.
    HD void refill(const CompressedBvhView& bvh, float limit) {
        if (!nodes.is_empty() || size == 0) return;
        const uint32_t lower = static_cast<uint32_t>(top), left = static_cast<uint32_t>(top >> 32);
        const bool has_nodes = left >= 1u << 24;
        if (!has_nodes && !triangles.is_empty()) return;
        if (has_nodes) {
            const NodeGroup group = {lower, left};
            if (!kRtaAtPops || group.entry() <= limit) nodes = group;
        } else {
            triangles = load_triangles(bvh.nodes + lower);
            triangles.left = left;
        }
        top = slots[--size];
    }
};

template <WalkOptions kOptions>
struct CompressedWalk {
    using Tree = CompressedBvhView;
    using Tests = TestsOf<kOptions>;
    using Place = CompressedPlace<kOptions>;

    template <class Visitor, class Counter>
    HD static bool walk(const CompressedBvhView& bvh, const Ray& ray, uint32_t instance, Visitor& visitor,
                        const Counter& counter) {
        return walk_by_turns<CompressedWalk>(bvh, ray, instance, visitor, counter);
    }

    /// Puts the ray at the root.
    template <class Visitor>
    HD static void start(const CompressedBvhView& bvh, const Ray& ray, const Visitor& visitor, Place& place) {
        place.segment = make_ray_segment<Tests>(ray, bvh.bounds_max_abs, skip_beyond<kOptions>(visitor, ray));
        if (Place::kEitherWay) place.order = slot_order(place.segment.inv, visitor.goes_far_first());
        place.prepared = Tests::make_triangles(ray);
        place.size = 0;
        place.nodes = {0, 1u << 24 | (bvh.nodes == nullptr ? 0u : 1u)}; // slot 0 of a node above
        place.triangles.left = 0;
    }

    /// One node, and the triangles that were put off, where enough of the lanes that run together have some. True when
    /// the visitor ended the walk.
    template <class Visitor, class Counter>
    HD static bool turn(const CompressedBvhView& bvh, const Ray& ray, uint32_t instance, Place& place, Visitor& visitor,
                        const Counter& counter, LaneMask lanes, int working) {
        if (!place.nodes.is_empty()) step_down(bvh, ray, place, counter);
        const int enough = lanes_for_triangles(working);
        bool ended = false;
        const auto are_enough = [&] { return count_lanes(ballot(lanes, !place.triangles.is_empty())) >= enough; };
        if (are_enough()) { // all of `lanes` come to each vote
            do {            // so written, it is 1 % faster than one loop that votes first
                if (!place.triangles.is_empty() && test_triangle(bvh, ray, instance, place, visitor, counter)) {
                    ended = true;
                    place.stop();
                }
            } while (are_enough());
            if (kOptions.rta && visitor.limit() < place.segment.end) place.segment.shorten(visitor.limit());
        }
        place.refill(bvh, skip_beyond<kOptions>(visitor, ray));
        return ended;
    }

private:
    /// Of slots the one to enter first; 0 of none.
    HD static uint32_t first_slot(uint32_t slots, const Place& place) {
        if (!kOptions.near_first) return slots & (0u - slots);
        return Place::kEitherWay ? first_of_slots(slots, place.order) : nearest_slot(slots, place.segment.inv);
    }

    /// Tests the boxes of the next node. Its children come before what is left of its group.
    template <class Counter>
    HD static void step_down(const CompressedBvhView& bvh, const Ray& ray, Place& place, const Counter& counter) {
        NodeGroup group = place.nodes;
        const uint32_t slot = first_slot(group.left & 0xffu, place); // one bit
        const uint32_t index = group.base + count_ones(group.left & (slot * (1u << 24) - (1u << 24)));
        group.left ^= slot;
        if (!group.is_empty()) place.push(group.base, group.left);
        counter.add_node(bvh.nodes + index);
        const CompressedBvhNode node = load_aligned(bvh.nodes + index);
        float entries[8];
        const uint32_t entered = enters_slots(ray.origin, place.segment, node, entries);
        const uint32_t found = triangles_of_slots(node, entered);
        const bool waits = !place.triangles.is_empty(); // selects, not branches, which would part the lanes
        if (waits & (found != 0)) place.push(index, found);
        place.triangles.base = waits ? place.triangles.base : node.triangle_base;
        place.triangles.all = waits ? place.triangles.all : node.triangles;
        place.triangles.left = waits ? place.triangles.left : found;
        const uint32_t inner = entered & inner_slots(node);
        place.nodes = {node.child_base, (node.exponents_and_inner & 0xff000000u) | inner};
        if (Place::kRtaAtPops) {
            const uint32_t others = inner ^ first_slot(inner, place);
            place.nodes.left |= least_entry(entries, others, place.segment.end) << 8;
        }
    }

    template <class Visitor, class Counter>
    HD static bool test_triangle(const CompressedBvhView& bvh, const Ray& ray, uint32_t instance, Place& place,
                                 Visitor& visitor, const Counter& counter) {
        const uint32_t lowest = place.triangles.left & (0u - place.triangles.left);
        place.triangles.left ^= lowest;
        const BvhTriangle* at = bvh.triangles + (place.triangles.base + count_ones(place.triangles.all & (lowest - 1)));
        counter.add_triangle(at);
        const BvhTriangle triangle = load_aligned(at);
        TriangleHit hit;
        if (!Tests::intersect(ray, place.prepared, triangle.a, triangle.b, triangle.c, hit)) return false;
        return visitor.visit(instance == kNoHit ? triangle.instance : instance, triangle.primitive, hit);
    }
};

} // namespace pertev
