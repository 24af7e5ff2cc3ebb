#pragma once

// The walk of one binary tree, near child first, with a stack. What a leaf holds is the caller's affair.
//
// Source: Aila, Laine, "Understanding the Efficiency of Ray Traversal on GPUs", HPG 2009 (while-while); a node whose
// entry lies beyond the nearest hit is dropped when it is popped (redundant traversal avoidance).
// A node is skipped only if its grown box is missed or its entry parameter is greater than the limit: equal is entered.

#include <cstdint>

#include "accel/bvh/bvh.h"
#include "base/host_device.h"
#include "trace/intersect/ray_boxes.h"
#include "trace/load_bvh.h"
#include "trace/walk_counter.h"

namespace pertev {

struct WalkStackEntry {
    uint32_t link;
    float entry;
};

/// A walk that can be left at a leaf and taken up again.
struct TreeWalk {
    uint32_t link; // where to go on; kNoLink: done
    int size = 0;  // entries on the stack
};

/// Goes on to the next leaf whose box may hold a hit with t_min < t <= t_limit and returns its link; kNoLink at the
/// end. `stack` holds as many entries as the tree is deep.
template <class Counter>
HD inline uint32_t next_leaf(TreeWalk& walk, const BvhNode* nodes, const RayBoxes& boxes, float t_min, float t_limit,
                             WalkStackEntry* stack, const Counter& counter) {
    uint32_t link = walk.link;
    int size = walk.size;
    const auto pop = [&] {
        while (size > 0) {
            const WalkStackEntry top = stack[--size];
            if (top.entry <= t_limit) return top.link;
        }
        return kNoLink;
    };
    while (!(link & kLeafBit)) {
        counter.add_node(nodes + link);
        const BvhNode node = load_aligned(nodes + link);
        float entry0, entry1;
        const bool enters0 = enters_child(boxes, node, 0, t_min, t_limit, entry0);
        const bool enters1 = enters_child(boxes, node, 1, t_min, t_limit, entry1);
        if (enters0 && enters1) {
            const bool swap = entry1 <= entry0;
            stack[size++] = {swap ? node.child[0] : node.child[1], swap ? entry0 : entry1};
            link = swap ? node.child[1] : node.child[0];
        } else if (enters0 || enters1) {
            link = enters0 ? node.child[0] : node.child[1];
        } else {
            link = pop();
        }
    }
    walk.size = size;
    return link;
}

/// Sets the walk to what is next on the stack after a leaf.
HD inline void leave_leaf(TreeWalk& walk, const WalkStackEntry* stack, float t_limit) {
    while (walk.size > 0) {
        const WalkStackEntry top = stack[--walk.size];
        if (top.entry <= t_limit) {
            walk.link = top.link;
            return;
        }
    }
    walk.link = kNoLink;
}

} // namespace pertev
