#pragma once

// While-while traversal whose descent to a leaf is compiled for each octant of ray directions (octant_boxes.h). A
// warp's camera rays nearly all have the same octant; otherwise its lanes use the code for any octant.
//
// Source of the loop: Aila, Laine, "Understanding the Efficiency of Ray Traversal on GPUs", HPG 2009, section 3.

#include <cstdint>

#include "base/limits.h"
#include "trace/binary/traversal_stack.h"
#include "trace/intersect/octant_boxes.h"
#include "trace/intersect/test_leaf.h"
#include "trace/traversal/traversal_options.h"
#include "trace/warps/warp_vote.h"

namespace pertev {

template <TraversalOptions kOptions>
struct OctantTraversal {
    using Tree = BvhView;
    using Tests = TestsOf<kOptions>;

    template <class Visitor, class Counter>
    HD static bool traverse(const BvhView& bvh, const Ray& ray, uint32_t instance, Visitor& visitor,
                            const Counter& counter) {
        RayOctantBoxes boxes =
            make_ray_octant_boxes<Tests>(ray, bvh.bounds_max_abs, skip_beyond<kOptions>(visitor, ray));
        const auto prepared = Tests::make_triangles(ray);
        typename Stack::Slot slots[kMaxBvhDepth];
        Stack stack = {slots};
        const int octant = octant_of_lanes(boxes.segment.inv);
        uint32_t link = bvh.root;
        for (;;) {
            link = descend(octant, bvh, link, boxes, stack, counter);
            if (link == kNoLink) return false;
            const float before = visitor.limit();
            if (test_leaf<Tests>(bvh, link, ray, prepared, instance, visitor, counter)) return true;
            if (kOptions.rta && visitor.limit() < before) {
                boxes.segment.shorten(visitor.limit());
                boxes.set_planes(ray.origin);
            }
            link = stack.pop(skip_beyond<kOptions>(visitor, ray));
        }
    }

private:
    using Stack = TraversalStack<kOptions.rta>; // entries are ray parameters

    /// Common octant of all lanes that run together, or kAnyOctant.
    HD static int octant_of_lanes(Vec3 inv) {
        const LaneMask lanes = lanes_here();
        const int octant = octant_of(inv);
        for (int axis = 0; axis < 3; ++axis) {
            const LaneMask backwards = ballot(lanes, (octant >> axis & 1) != 0);
            if (backwards != 0 && backwards != lanes) return kAnyOctant;
        }
        return octant;
    }

    template <class Counter>
    HD static uint32_t descend(int octant, const BvhView& bvh, uint32_t link, const RayOctantBoxes& boxes, Stack& stack,
                               const Counter& counter) {
        switch (octant) {
        case 0:
            return descend<0>(bvh, link, boxes, stack, counter);
        case 1:
            return descend<1>(bvh, link, boxes, stack, counter);
        case 2:
            return descend<2>(bvh, link, boxes, stack, counter);
        case 3:
            return descend<3>(bvh, link, boxes, stack, counter);
        case 4:
            return descend<4>(bvh, link, boxes, stack, counter);
        case 5:
            return descend<5>(bvh, link, boxes, stack, counter);
        case 6:
            return descend<6>(bvh, link, boxes, stack, counter);
        case 7:
            return descend<7>(bvh, link, boxes, stack, counter);
        default:
            return descend<kAnyOctant>(bvh, link, boxes, stack, counter);
        }
    }

    /// Descends to the next leaf; kNoLink at the end.
    template <int kOctant, class Counter>
    HD static uint32_t descend(const BvhView& bvh, uint32_t link, const RayOctantBoxes& boxes, Stack& stack,
                               const Counter& counter) {
        const float end = boxes.segment.end;
        while (!(link & kLeafBit)) {
            counter.add_node(bvh.nodes + link);
            const BvhNode node = load_aligned(bvh.nodes + link);
            float entry0, entry1;
            const bool enters0 = enters_child<kOctant>(boxes, node, 0, entry0);
            const bool enters1 = enters_child<kOctant>(boxes, node, 1, entry1);
            if (enters0 && enters1) {
                const bool swap = kOptions.near_first && entry1 <= entry0;
                stack.push(swap ? node.child[0] : node.child[1], (swap ? entry0 : entry1) * end);
                link = swap ? node.child[1] : node.child[0];
            } else if (enters0 || enters1) {
                link = enters0 ? node.child[0] : node.child[1];
            } else {
                link = stack.pop(end);
            }
        }
        return link;
    }
};

} // namespace pertev
