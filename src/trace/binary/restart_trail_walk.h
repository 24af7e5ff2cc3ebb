#pragma once

// Restart trail: a walk without a stack. Two bits a level tell which child the way down takes and whether the other one
// still waits; when a leaf is done, the walk starts again at the root, repeats its way down to the deepest level at
// which a child waits, and takes that one.
//
// Source: Laine, "Restart Trail for Stackless BVH Traversal", HPG 2010, where one bit a level says "far child" and the
// order is computed anew on the way. That is ambiguous once a box on the way has come to lie beyond the nearest hit (as
// it may with spatial splits, where a hit can lie outside its leaf's box), so here the way itself is kept.
// Where the way is blocked by now, all that waits beneath is done with.

#include <cstdint>

#include "base/limits.h"
#include "math/bits.h"
#include "trace/binary/walk_stack.h"
#include "trace/intersect/test_leaf.h"
#include "trace/traversal/walk_options.h"

namespace pertev {

static_assert(kMaxBvhDepth <= 64); // a bit a level

/// Nothing but the trail: every pop is a restart. (ShortStackWalk keeps a few entries instead.)
struct NoShortStack {
    HD void push(uint32_t, float) {}
    HD bool pop(WalkStackEntry&) { return false; }
};

/// Bit i is of level i, the root being level 0. A level above the current one is set, deeper ones do not count.
struct RestartTrail {
    uint64_t taken = 0;   // child 1 is on the way
    uint64_t waiting = 0; // the other child is still to be walked; never set at the current level or deeper
    int level = 0;        // of the current node
    int repeated = 0;     // levels before this one follow `taken`

    /// Turns to what waits deepest, by the stack where that has it, else from the root. kNoLink at the end.
    template <class ShortStack>
    HD uint32_t pop(uint32_t root, float limit, ShortStack& stack) {
        while (waiting != 0) {
            const int deepest = static_cast<int>(highest_bit(waiting));
            waiting ^= uint64_t(1) << deepest;
            taken ^= uint64_t(1) << deepest;
            WalkStackEntry top;
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

/// One step from an inner node; the link to go on with.
template <bool kNearFirst, class ShortStack>
HD inline uint32_t step_by_trail(const BvhNode& node, const RayBoxes& boxes, float t_min, float limit, uint32_t root,
                                 RestartTrail& trail, ShortStack& stack) {
    const uint64_t bit = uint64_t(1) << trail.level;
    float entry0, entry1;
    const bool enters0 = enters_child(boxes, node, 0, t_min, limit, entry0);
    const bool enters1 = enters_child(boxes, node, 1, t_min, limit, entry1);
    bool second; // child 1 is the one to go on with
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
    trail.waiting &= (bit << 1) - 1; // on a repeated way: what waited beneath
    return trail.pop(root, limit, stack);
}

template <WalkOptions kOptions, class ShortStack, class Visitor, class Counter>
HD inline bool walk_by_trail(const BvhView& bvh, const Ray& ray, uint32_t instance, Visitor& visitor,
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

template <WalkOptions kOptions>
struct RestartTrailWalk {
    using Tree = BvhView;

    template <class Visitor, class Counter>
    HD static bool walk(const BvhView& bvh, const Ray& ray, uint32_t instance, Visitor& visitor,
                        const Counter& counter) {
        return walk_by_trail<kOptions, NoShortStack>(bvh, ray, instance, visitor, counter);
    }
};

} // namespace pertev
