#pragma once

// While-while: one loop goes down to a leaf, another tests its triangles, and a warp's lanes wait for each other
// between the two. It is StackWalk with the laboratory's switches; with all of them on it tests the very same nodes.
//
// Source: Aila, Laine, "Understanding the Efficiency of Ray Traversal on GPUs", HPG 2009, section 3.

#include "trace/test_leaf.h"
#include "trace/walk_options.h"
#include "trace/walk_stack.h"

namespace pertev {

/// Where a walk with a stack stands between two turns; dynamic fetch (trace/dynamic_fetch.h) may leave it there.
template <WalkOptions kOptions>
struct WalkPlace {
    using Slot = typename WalkStack<kOptions.rta>::Slot;
    WalkStack<kOptions.rta> stack;
    uint32_t link; // where to go on; kNoLink: done
};

template <WalkOptions kOptions>
struct WhileWhileWalk {
    using Tree = BvhView;
    using Tests = TestsOf<kOptions>;
    using Place = WalkPlace<kOptions>;

    template <class Visitor, class Counter>
    HD static bool walk(const BvhView& bvh, const Ray& ray, uint32_t instance, Visitor& visitor,
                        const Counter& counter) {
        const auto boxes = Tests::make_boxes(ray, bvh.bounds_max_abs);
        const auto prepared = Tests::make_triangles(ray);
        typename Place::Slot slots[kMaxBvhDepth];
        Place place = {{slots}, bvh.root};
        while (place.link != kNoLink) {
            if (turn(bvh, ray, boxes, prepared, instance, place, visitor, counter)) return true;
        }
        return false;
    }

    /// Down to the next leaf, and its triangles. True when the visitor ended the walk.
    template <class Visitor, class Counter>
    HD static bool turn(const BvhView& bvh, const Ray& ray, const typename Tests::Boxes& boxes,
                        const typename Tests::Triangles& prepared, uint32_t instance, Place& place, Visitor& visitor,
                        const Counter& counter) {
        constexpr bool kNear = kOptions.near_first && Visitor::kNearestFirst;
        uint32_t link = place.link;
        while (!(link & kLeafBit)) {
            counter.add_node(bvh.nodes + link);
            const BvhNode node = load_aligned(bvh.nodes + link);
            link = step_down<kNear>(node, boxes, ray.t_min, skip_beyond<kOptions>(visitor, ray), place.stack);
        }
        if (link != kNoLink) {
            if (test_leaf<Tests>(bvh.triangles, link, ray, prepared, instance, visitor, counter)) return true;
            link = place.stack.pop(skip_beyond<kOptions>(visitor, ray));
        }
        place.link = link;
        return false;
    }
};

} // namespace pertev
