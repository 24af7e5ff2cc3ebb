#pragma once

// Traversal of the compressed 8-wide tree: pending work is stored in groups, one 8-byte entry for all pending
// children of a node, in octant order, nearest (or farthest, see below) first, without sorting.
//
// Source: Ylitie, Karras, Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG 2017,
// section 4, with its postponing of triangles: a warp tests triangles only while enough of its lanes have some, and
// descends otherwise. Unlike theirs, postponed triangles stay in registers until the ray finds more, and only those
// go to the stack. How long they are postponed depends on the warp; the hits do not. On the host, where a warp is one
// ray, nothing is postponed.
//
// RTA: a hit shortens the segment against which boxes are tested, and a group stores the entry parameter of the
// nearest of its pending children, so that it is dropped at a pop if that is beyond the hit. That saves 7 to 8 % of
// the nodes in Sponza and costs more instructions than it saves; rta_at_pops switches it. Postponed triangles carry
// no distance and are always tested.
//
// near_first off means the order of slots. With it on, an any-hit search may visit far children first (trace_any.h).

#include <cstddef>
#include <cstdint>

#include "accel/bvh/compressed_bvh.h"
#include "base/host_device.h"
#include "base/limits.h"
#include "math/bits.h"
#include "trace/intersect/compressed_boxes.h"
#include "trace/intersect/load_bvh.h"
#include "trace/traversal/traversal_options.h"
#include "trace/traversal/traverse_by_steps.h"
#include "trace/warps/warp_vote.h"

namespace pertev {

/// Minimum number of the `working` lanes that must have triangles for a test, at least 1: 13 of 32, about 40 %; the
/// paper's is 20 %. Counted for warps of 32, not timed, on the second diffuse bounce in Sponza: 2.7 lanes test a
/// triangle together without postponing, 7.4 with 20 %, 13 with 40 %, while 25 of 32 test a node. From 35 to 50 % the
/// number of instructions per ray changes by 2 %.
HD inline int lanes_for_triangles(int working) { return (13 * working + 31) / 32; }

/// Pending children of one node.
struct NodeGroup {
    uint32_t base; // CompressedBvhNode::child_base
    uint32_t left; // bits 0 to 7: slots to enter; 8 to 23: with RTA at pops, the upper half of a float that is a
                   // lower bound of the entries of all but the first; 24 to 31: all inner slots, at least one

    HD bool is_empty() const { return (left & 0xffu) == 0; }
    HD float entry() const { return float_of((left & 0xffff00u) << 8); }
};

/// Pending triangles of one node.
struct TriangleGroup {
    uint32_t base; // CompressedBvhNode::triangle_base
    uint32_t all;  // CompressedBvhNode::triangles
    uint32_t left; // subset of `all` to be tested

    HD bool is_empty() const { return left == 0; }
};

/// State of a traversal between two turns.
template <TraversalOptions kOptions>
struct CompressedTraversalState {
    using Tests = TestsOf<kOptions>;
    static constexpr bool kRtaAtPops = kOptions.rta && kOptions.rta_at_pops;
    // Closest-hit searches use the signs of 1/direction, because with a register for an order they are 5 % slower.
    static constexpr bool kEitherWay = kOptions.any_hit && kOptions.near_first;
    // A single store, where a struct would take two. If the upper half is at least 2^24, it is a NodeGroup whose base
    // is the lower half; otherwise it is the `left` of triangles, and the lower half is their node.
    using Slot = uint64_t;
    // Each node on the path has at most one entry for its children and one for its triangles; entries above belong to
    // nodes below.
    static constexpr int kSlots = 2 * kMaxBvhDepth;
    static constexpr int kRefillBelow = 24; // for dynamic fetch

    // [kSlots] in a separate array: see TraversalStack. It is in local memory on the device: pushes are few, and using
    // more shared memory, as they do, would shrink the L1 cache for nodes. The top is held in registers, so that no
    // lane waits for a pop: [k] is below entry k, [0] below the first.
    Slot* slots;
    Slot top = 0;
    int size = 0;
    NodeGroup nodes = {0, 0};
    TriangleGroup triangles = {0, 0, 0}; // found and postponed
    RaySegment segment = {};
    uint32_t order = 0; // order of slots, for searches in either direction
    typename Tests::Triangles prepared = {};

    HD explicit CompressedTraversalState(Slot* memory) : slots(memory) {}

    HD bool is_done() const { return nodes.is_empty() && triangles.is_empty() && size == 0; }
    HD void stop() {
        size = 0;
        nodes.left = triangles.left = 0;
    }
    /// The triangles of a node, none of them pending; one load of 8 bytes.
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

    /// Pops one entry if needed; a node entered beyond `limit` is dropped. If popped triangles meet postponed ones,
    /// they stay on the stack, and the ray waits. It pops one per turn, because the next turn comes sooner than a
    /// loop would reconverge a warp's lanes.
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

template <TraversalOptions kOptions>
struct CompressedTraversal {
    using Tree = CompressedBvhView;
    using Tests = TestsOf<kOptions>;
    using State = CompressedTraversalState<kOptions>;

    template <class Visitor, class Counter>
    HD static bool traverse(const CompressedBvhView& bvh, const Ray& ray, uint32_t instance, Visitor& visitor,
                            const Counter& counter) {
        return traverse_by_steps<CompressedTraversal>(bvh, ray, instance, visitor, counter);
    }

    /// Puts the ray at the root.
    template <class Visitor>
    HD static void start(const CompressedBvhView& bvh, const Ray& ray, const Visitor& visitor, State& state) {
        state.segment = make_ray_segment<Tests>(ray, bvh.bounds_max_abs, skip_beyond<kOptions>(visitor, ray));
        if (State::kEitherWay) state.order = slot_order(state.segment.inv, visitor.visits_far_first());
        state.prepared = Tests::make_triangles(ray);
        state.size = 0;
        state.nodes = {0, 1u << 24 | (bvh.nodes == nullptr ? 0u : 1u)}; // slot 0 of a node above the root
        state.triangles.left = 0;
    }

    /// Tests one node, and the postponed triangles if enough of the lanes that run together have some. Returns true
    /// if the visitor ended the traversal.
    template <class Visitor, class Counter>
    HD static bool step(const CompressedBvhView& bvh, const Ray& ray, uint32_t instance, State& state, Visitor& visitor,
                        const Counter& counter, LaneMask lanes, int working) {
        if (!state.nodes.is_empty()) step_down(bvh, ray, state, counter);
        const int enough = lanes_for_triangles(working);
        bool ended = false;
        const auto are_enough = [&] { return count_lanes(ballot(lanes, !state.triangles.is_empty())) >= enough; };
        if (are_enough()) { // all of `lanes` take part in each vote
            do {            // 1 % faster than one loop that votes first
                if (!state.triangles.is_empty() && test_triangle(bvh, ray, instance, state, visitor, counter)) {
                    ended = true;
                    state.stop();
                }
            } while (are_enough());
            if (kOptions.rta && visitor.limit() < state.segment.end) state.segment.shorten(visitor.limit());
        }
        state.refill(bvh, skip_beyond<kOptions>(visitor, ray));
        return ended;
    }

private:
    /// Bit of the slot to enter first; 0 for no slots.
    HD static uint32_t first_slot(uint32_t slots, const State& state) {
        if (!kOptions.near_first) return slots & (0u - slots);
        return State::kEitherWay ? first_of_slots(slots, state.order) : nearest_slot(slots, state.segment.inv);
    }

    /// Tests the boxes of the next node. Its children come before the rest of its group.
    template <class Counter>
    HD static void step_down(const CompressedBvhView& bvh, const Ray& ray, State& state, const Counter& counter) {
        NodeGroup group = state.nodes;
        const uint32_t slot = first_slot(group.left & 0xffu, state); // one bit
        const uint32_t index = group.base + count_ones(group.left & (slot * (1u << 24) - (1u << 24)));
        group.left ^= slot;
        if (!group.is_empty()) state.push(group.base, group.left);
        counter.add_node(bvh.nodes + index);
        const CompressedBvhNode node = load_aligned(bvh.nodes + index);
        float entries[8];
        const uint32_t entered = enters_slots(ray.origin, state.segment, node, entries);
        const uint32_t found = triangles_of_slots(node, entered);
        const bool waits = !state.triangles.is_empty(); // selects instead of branches, which would diverge the lanes
        if (waits & (found != 0)) state.push(index, found);
        state.triangles.base = waits ? state.triangles.base : node.triangle_base;
        state.triangles.all = waits ? state.triangles.all : node.triangles;
        state.triangles.left = waits ? state.triangles.left : found;
        const uint32_t inner = entered & inner_slots(node);
        state.nodes = {node.child_base, (node.exponents_and_inner & 0xff000000u) | inner};
        if (State::kRtaAtPops) {
            const uint32_t others = inner ^ first_slot(inner, state);
            state.nodes.left |= min_entry(entries, others, state.segment.end) << 8;
        }
    }

    template <class Visitor, class Counter>
    HD static bool test_triangle(const CompressedBvhView& bvh, const Ray& ray, uint32_t instance, State& state,
                                 Visitor& visitor, const Counter& counter) {
        const uint32_t lowest = state.triangles.left & (0u - state.triangles.left);
        state.triangles.left ^= lowest;
        const BvhTriangle* at = bvh.triangles + (state.triangles.base + count_ones(state.triangles.all & (lowest - 1)));
        counter.add_triangle(at);
        const BvhTriangle triangle = load_aligned(at);
        TriangleHit hit;
        if (!Tests::intersect(ray, state.prepared, triangle.a, triangle.b, triangle.c, hit)) return false;
        return visitor.visit(instance == kNoHit ? triangle.instance : instance, triangle.primitive, hit);
    }
};

} // namespace pertev
