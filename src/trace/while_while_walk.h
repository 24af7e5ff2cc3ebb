#pragma once

// While-while: one loop goes down to a leaf, another tests its triangles, and a warp's lanes wait for each other
// between the two. It is StackWalk with the laboratory's switches; with all of them on it tests the very same nodes.
//
// Source: Aila, Laine, "Understanding the Efficiency of Ray Traversal on GPUs", HPG 2009, section 3.

#include "trace/test_leaf.h"
#include "trace/walk_options.h"
#include "trace/walk_stack.h"

namespace pertev {

template <WalkOptions kOptions>
struct WhileWhileWalk {
    using Tree = BvhView;

    template <class Visitor, class Counter>
    HD static bool walk(const BvhView& bvh, const Ray& ray, uint32_t instance, Visitor& visitor,
                        const Counter& counter) {
        using Tests = TestsOf<kOptions>;
        constexpr bool kNear = kOptions.near_first && Visitor::kNearestFirst;
        const auto boxes = Tests::make_boxes(ray, bvh.bounds_max_abs);
        const auto prepared = Tests::make_triangles(ray);
        WalkStack<kOptions.rta> stack;
        uint32_t link = bvh.root;
        for (;;) {
            while (!(link & kLeafBit)) {
                counter.add_node(bvh.nodes + link);
                const BvhNode node = load_aligned(bvh.nodes + link);
                link = step_down<kNear>(node, boxes, ray.t_min, skip_beyond<kOptions>(visitor, ray), stack);
            }
            if (link == kNoLink) return false;
            if (test_leaf<Tests>(bvh.triangles, link, ray, prepared, instance, visitor, counter)) return true;
            link = stack.pop(skip_beyond<kOptions>(visitor, ray));
        }
    }
};

} // namespace pertev
