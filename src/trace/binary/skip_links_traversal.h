#pragma once

// Skip-link traversal: forwards through the list of nodes, past a subtree whose box is missed. All rays follow the
// builder's order, so near_first has no effect.
//
// Source: Smits, "Efficiency Issues for Ray Tracing", Journal of Graphics Tools 3(2), 1998.

#include <cstdint>

#include "accel/bvh/skip_bvh.h"
#include "trace/intersect/test_leaf.h"
#include "trace/traversal/traversal_options.h"

namespace pertev {

template <TraversalOptions kOptions>
struct SkipLinksTraversal {
    using Tree = SkipBvhView;

    template <class Visitor, class Counter>
    HD static bool traverse(const SkipBvhView& bvh, const Ray& ray, uint32_t instance, Visitor& visitor,
                            const Counter& counter) {
        using Tests = TestsOf<kOptions>;
        const auto boxes = Tests::make_boxes(ray, bvh.bounds_max_abs);
        const auto prepared = Tests::make_triangles(ray);
        for (uint32_t at = 0; at < bvh.count;) {
            counter.add_node(bvh.nodes + at);
            const SkipNode node = load_aligned(bvh.nodes + at);
            float entry;
            if (!enters_box(boxes, node.lo, node.hi, ray.t_min, skip_beyond<kOptions>(visitor, ray), entry)) {
                at = node.next;
                continue;
            }
            if (node.leaf != kNoLink &&
                test_leaf<Tests>(bvh.triangles, node.leaf, ray, prepared, instance, visitor, counter)) {
                return true;
            }
            ++at;
        }
        return false;
    }
};

} // namespace pertev
