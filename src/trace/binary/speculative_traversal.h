#pragma once

// Speculative while-while traversal: a ray that has found a leaf postpones it and continues as long as another lane
// of its warp has none, because it would idle otherwise. Its tests meanwhile may turn out to be unnecessary.
//
// Source: Aila, Laine, "Understanding the Efficiency of Ray Traversal on GPUs", HPG 2009, section 4 (one postponed
// leaf). How far lanes run ahead depends on their warp; the hits do not. On the host, where a warp is one ray,
// nothing is postponed and the nodes tested are those of WhileWhileTraversal.

#include "trace/binary/while_while_traversal.h"
#include "trace/traversal/traverse_by_steps.h"
#include "trace/warps/warp_vote.h"

namespace pertev {

template <TraversalOptions kOptions>
struct SpeculativeTraversal {
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
        return traverse_by_steps<SpeculativeTraversal>(bvh, ray, instance, visitor, counter);
    }

    /// Descends until all lanes that run together have found a leaf, then tests the leaves. Returns true if the
    /// visitor ended it.
    template <class Visitor, class Counter>
    HD static bool step(const Tree& bvh, const Ray& ray, uint32_t instance, State& state, Visitor& visitor,
                        const Counter& counter, LaneMask, int) {
        uint32_t link = state.link, postponed = kNoLink;
        while (!(link & kLeafBit)) {
            counter.add_node(bvh.nodes + link);
            const BvhNode node = load_aligned(bvh.nodes + link);
            const float limit = skip_beyond<kOptions>(visitor, ray);
            link = step_down<kOptions.near_first>(node, state.boxes, ray.t_min, limit, state.stack);
            const bool ends = (link & kLeafBit) != 0; // at a leaf, or at the end
            if (all_lanes_here(ends || postponed != kNoLink)) break;
            if (ends && link != kNoLink && postponed == kNoLink) {
                postponed = link;
                link = state.stack.pop(limit);
            }
        }
        for (;;) { // the postponed leaf, then the one at which the loop above ended
            const bool was_postponed = postponed != kNoLink;
            const uint32_t leaf = was_postponed ? postponed : link;
            if (!(leaf & kLeafBit) || leaf == kNoLink) break;
            if (test_leaf<Tests>(bvh, leaf, ray, state.prepared, instance, visitor, counter)) return true;
            postponed = kNoLink;
            if (!was_postponed) link = state.stack.pop(skip_beyond<kOptions>(visitor, ray));
        }
        state.link = link;
        return false;
    }
};

} // namespace pertev
