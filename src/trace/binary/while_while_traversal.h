#pragma once

// While-while traversal: one loop descends to a leaf, another tests its triangles, and a warp's lanes wait for each
// other between the two.
//
// Source: Aila, Laine, "Understanding the Efficiency of Ray Traversal on GPUs", HPG 2009, section 3.

#include "trace/binary/traversal_stack.h"
#include "trace/intersect/test_leaf.h"
#include "trace/traversal/traversal_options.h"
#include "trace/traversal/traverse_by_steps.h"
#include "trace/warps/warp_vote.h"

namespace pertev {

/// State of a traversal with a stack between two turns; dynamic fetch (trace/dynamic_fetch.h) may suspend it there.
template <TraversalOptions kOptions>
struct TraversalState {
    using Tests = TestsOf<kOptions>;
    using Slot = typename TraversalStack<kOptions.rta>::Slot;
    static constexpr int kSlots = kMaxBvhDepth;
    static constexpr int kRefillBelow = 20; // for dynamic fetch, from the source, of 32 lanes

    TraversalStack<kOptions.rta> stack;
    uint32_t link = kNoLink; // next link; kNoLink: done
    typename Tests::Boxes boxes = {};
    typename Tests::Triangles prepared = {};

    HD explicit TraversalState(Slot* slots) : stack{slots} {}

    HD bool is_done() const { return link == kNoLink; }
    HD void stop() { link = kNoLink; }
    /// Puts the ray at the root.
    HD void start(const BvhView& bvh, const Ray& ray) {
        boxes = Tests::make_boxes(ray, bvh.bounds_max_abs);
        prepared = Tests::make_triangles(ray);
        stack.size = 0;
        link = bvh.root;
    }
};

template <TraversalOptions kOptions>
struct WhileWhileTraversal {
    using Tree = BinaryTreeOf<kOptions>;
    using Tests = TestsOf<kOptions>;
    using State = TraversalState<kOptions>;

    template <class Visitor>
    HD static void start(const Tree& bvh, const Ray& ray, const Visitor&, State& state) {
        state.start(bvh, ray);
    }

    template <class Visitor, class Counter>
    HD static bool traverse(const Tree& bvh, const Ray& ray, uint32_t instance, Visitor& visitor,
                            const Counter& counter) {
        return traverse_by_steps<WhileWhileTraversal>(bvh, ray, instance, visitor, counter);
    }

    /// Descends to the next leaf and tests its triangles. Returns true if the visitor ended the traversal.
    template <class Visitor, class Counter>
    HD static bool step(const Tree& bvh, const Ray& ray, uint32_t instance, State& state, Visitor& visitor,
                        const Counter& counter, LaneMask, int) {
        uint32_t link = state.link;
        while (!(link & kLeafBit)) {
            counter.add_node(bvh.nodes + link);
            const BvhNode node = load_aligned(bvh.nodes + link);
            link = step_down<kOptions.near_first>(node, state.boxes, ray.t_min, skip_beyond<kOptions>(visitor, ray),
                                                  state.stack);
        }
        if (link != kNoLink) {
            if (test_leaf<Tests>(bvh, link, ray, state.prepared, instance, visitor, counter)) return true;
            link = state.stack.pop(skip_beyond<kOptions>(visitor, ray));
        }
        state.link = link;
        return false;
    }
};

} // namespace pertev
