#pragma once

// The parent-pointer automaton: a traversal whose state is the current node and where it came from. The sign of the
// ray on the node's split axis identifies the near child, so that on the way up the automaton knows which child is
// done; entry parameters are no longer available then.
//
// Source: Hapala, Davidovic, Wald, Havran, Slusallek, "Efficient Stack-less BVH Traversal for Ray Tracing", SCCG
// 2011, algorithm 2. It requires a tree with add_parent_links (accel/bvh/parent_links.h); without them it may not
// end.

#include <cstdint>

#include "accel/bvh/parent_links.h"
#include "trace/intersect/test_leaf.h"
#include "trace/traversal/traversal_options.h"

namespace pertev {

template <TraversalOptions kOptions>
struct ParentLinksTraversal {
    using Tree = BvhView;

    template <class Visitor, class Counter>
    HD static bool traverse(const BvhView& bvh, const Ray& ray, uint32_t instance, Visitor& visitor,
                            const Counter& counter) {
        using Tests = TestsOf<kOptions>;
        const auto boxes = Tests::make_boxes(ray, bvh.bounds_max_abs);
        const auto prepared = Tests::make_triangles(ray);
        if (bvh.root & kLeafBit) {
            return bvh.root != kNoLink &&
                   test_leaf<Tests>(bvh.triangles, bvh.root, ray, prepared, instance, visitor, counter);
        }
        uint32_t at = bvh.root;
        State state = State::FromParent;
        for (;;) {
            if (state == State::FromChild) { // the subtree of `at` is done
                if (at == bvh.root) return false;
                const uint32_t parent = bvh.nodes[at].parent;
                at = parent & ~kSecondChildBit;
                const int came_from = (parent & kSecondChildBit) ? 1 : 0;
                if (came_from == first_child<kOptions.near_first>(bvh.nodes[at].split, ray.direction))
                    state = State::FromSibling;
                continue;
            }
            counter.add_node(bvh.nodes + at);
            const BvhNode node = load_aligned(bvh.nodes + at);
            const int first = first_child<kOptions.near_first>(node.split, ray.direction);
            const bool second = (state == State::FromParent ? first : 1 - first) == 1;
            // State after this child is skipped or done.
            const State after = state == State::FromParent ? State::FromSibling : State::FromChild;
            const uint32_t link = second ? node.child[1] : node.child[0];
            if (!enters(boxes, node, second, ray.t_min, skip_beyond<kOptions>(visitor, ray))) {
                state = after;
            } else if (link & kLeafBit) {
                if (test_leaf<Tests>(bvh.triangles, link, ray, prepared, instance, visitor, counter)) return true;
                state = after;
            } else {
                at = link;
                state = State::FromParent;
            }
        }
    }

private:
    enum class State {
        FromParent,  // the first child of the current node is next
        FromSibling, // the second child is next
        FromChild,   // both children are done
    };

    template <bool kNear>
    HD static int first_child(uint32_t split, Vec3 direction) {
        if (!kNear) return 0;
        const bool backwards = component(direction, static_cast<int>(split & 3)) < 0;
        return backwards != ((split & kSecondIsLower) != 0) ? 1 : 0;
    }

    HD static bool enters(const RayBoxes& boxes, const BvhNode& node, bool second, float t_min, float t_limit) {
        const auto pick = [second](const float(&v)[4], int upper) { return second ? v[upper + 1] : v[upper]; };
        float entry;
        return enters_box(boxes, {pick(node.x, 0), pick(node.y, 0), pick(node.z, 0)},
                          {pick(node.x, 2), pick(node.y, 2), pick(node.z, 2)}, t_min, t_limit, entry);
    }
};

} // namespace pertev
