#pragma once

// Restart trail: stackless traversal. Two bits per level store which child the path takes and whether the other one
// is pending. After a leaf, the traversal restarts at the root, repeats its path down to the deepest level with a
// pending child, and visits that one.
//
// Source: Laine, "Restart Trail for Stackless BVH Traversal", HPG 2010, where one bit per level says "far child" and
// the order is recomputed on the way. That is ambiguous once a box on the path is beyond the nearest hit (possible
// with spatial splits, where a hit can lie outside its leaf's box), so the path itself is stored here. If the path is
// blocked by then, everything pending below is done.

#include <cstdint>

#include "base/limits.h"
#include "math/bits.h"
#include "trace/binary/traversal_stack.h"
#include "trace/intersect/test_leaf.h"
#include "trace/traversal/traversal_options.h"

namespace pertev {

static_assert(kMaxBvhDepth <= 64); // one bit per level

/// A stack without entries, so that every pop restarts. (ShortStackTraversal keeps a few entries instead.)
struct NoShortStack {
    HD void push(uint32_t, float) {}
    HD bool pop(TraversalStackEntry&) { return false; }
};

/// The trail as bits. Bit i belongs to level i; the root is level 0. Levels deeper than the current one are ignored.
struct RestartTrail {
    uint64_t taken = 0;   // child 1 is on the path
    uint64_t waiting = 0; // the other child is pending; never set at the current level or deeper
    int level = 0;        // level of the current node
    int repeated = 0;     // levels before this one follow `taken`

    /// Continues with the deepest pending child, from the stack if that has it, else from the root. Returns kNoLink
    /// at the end.
    template <class ShortStack>
    HD uint32_t pop(uint32_t root, float limit, ShortStack& stack) {
        while (waiting != 0) {
            const int deepest = static_cast<int>(highest_bit(waiting));
            waiting ^= uint64_t(1) << deepest;
            taken ^= uint64_t(1) << deepest;
            TraversalStackEntry top;
            if (!stack.pop(top)) {
                level = 0;
                repeated = deepest + 1;
                return root;
            }
            if (top.entry <= limit) {
                level = deepest + 1;
                repeated = 0;
                return top.link;
            }
        }
        return kNoLink;
    }
};

/// Takes one step from an inner node and returns the next link.
template <bool kNearFirst, class ShortStack>
HD inline uint32_t step_by_trail(const BvhNode& node, const RayBoxes& boxes, float t_min, float limit, uint32_t root,
                                 RestartTrail& trail, ShortStack& stack) {
    const uint64_t bit = uint64_t(1) << trail.level;
    float entry0, entry1;
    const bool enters0 = enters_child(boxes, node, 0, t_min, limit, entry0);
    const bool enters1 = enters_child(boxes, node, 1, t_min, limit, entry1);
    bool second; // continue with child 1
    bool waits = enters0 && enters1;
    if (trail.level < trail.repeated) {
        second = (trail.taken & bit) != 0;
        waits = (trail.waiting & bit) != 0 && (second ? enters0 : enters1);
        if (!waits) trail.waiting &= ~bit; // it may be beyond the nearest hit by now
    } else {
        second = waits ? kNearFirst && entry1 <= entry0 : enters1;
        trail.taken = second ? trail.taken | bit : trail.taken & ~bit;
        if (waits) trail.waiting |= bit;
    }
    if (waits) stack.push(second ? node.child[0] : node.child[1], second ? entry0 : entry1);
    if (second ? enters1 : enters0) {
        ++trail.level;
        return second ? node.child[1] : node.child[0];
    }
    trail.waiting &= (bit << 1) - 1; // on a repeated path: clears pending children below
    return trail.pop(root, limit, stack);
}

template <TraversalOptions kOptions, class ShortStack, class Visitor, class Counter>
HD inline bool traverse_by_trail(const BvhView& bvh, const Ray& ray, uint32_t instance, Visitor& visitor,
                                 const Counter& counter) {
    using Tests = TestsOf<kOptions>;
    const auto boxes = Tests::make_boxes(ray, bvh.bounds_max_abs);
    const auto prepared = Tests::make_triangles(ray);
    RestartTrail trail;
    ShortStack stack;
    uint32_t link = bvh.root;
    for (;;) {
        while (!(link & kLeafBit)) {
            counter.add_node(bvh.nodes + link);
            const BvhNode node = load_aligned(bvh.nodes + link);
            const float limit = skip_beyond<kOptions>(visitor, ray);
            link = step_by_trail<kOptions.near_first>(node, boxes, ray.t_min, limit, bvh.root, trail, stack);
        }
        if (link == kNoLink) return false;
        if (test_leaf<Tests>(bvh.triangles, link, ray, prepared, instance, visitor, counter)) return true;
        link = trail.pop(bvh.root, skip_beyond<kOptions>(visitor, ray), stack);
    }
}

template <TraversalOptions kOptions>
struct RestartTrailTraversal {
    using Tree = BvhView;

    template <class Visitor, class Counter>
    HD static bool traverse(const BvhView& bvh, const Ray& ray, uint32_t instance, Visitor& visitor,
                            const Counter& counter) {
        return traverse_by_trail<kOptions, NoShortStack>(bvh, ray, instance, visitor, counter);
    }
};

} // namespace pertev
