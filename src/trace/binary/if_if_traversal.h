#pragma once

// If-if traversal: in each turn a ray tests one node if it is at a node, and then one triangle if it is at a leaf. No
// lane of a warp waits for another's loop, but a turn costs both tests as soon as lanes differ.
//
// Source: Aila, Laine, "Understanding the Efficiency of Ray Traversal on GPUs", HPG 2009, section 3.

#include "base/limits.h"
#include "trace/binary/traversal_stack.h"
#include "trace/intersect/test_leaf.h"
#include "trace/traversal/traversal_options.h"

namespace pertev {

template <TraversalOptions kOptions>
struct IfIfTraversal {
    using Tree = BvhView;

    template <class Visitor, class Counter>
    HD static bool traverse(const BvhView& bvh, const Ray& ray, uint32_t instance, Visitor& visitor,
                            const Counter& counter) {
        using Tests = TestsOf<kOptions>;
        const auto boxes = Tests::make_boxes(ray, bvh.bounds_max_abs);
        const auto prepared = Tests::make_triangles(ray);
        typename TraversalStack<kOptions.rta>::Slot slots[kMaxBvhDepth];
        TraversalStack<kOptions.rta> stack = {slots};
        uint32_t link = bvh.root; // at a leaf: kLeafBit | the next triangle to test
        while (link != kNoLink) {
            if (!(link & kLeafBit)) {
                counter.add_node(bvh.nodes + link);
                const BvhNode node = load_aligned(bvh.nodes + link);
                link =
                    step_down<kOptions.near_first>(node, boxes, ray.t_min, skip_beyond<kOptions>(visitor, ray), stack);
            }
            if (link != kNoLink && (link & kLeafBit)) {
                bool last;
                const BvhTriangle* at = bvh.triangles + (link & ~kLeafBit);
                if (test_triangle<Tests>(at, ray, prepared, instance, visitor, counter, last)) return true;
                link = last ? stack.pop(skip_beyond<kOptions>(visitor, ray)) : link + 1;
            }
        }
        return false;
    }
};

} // namespace pertev
