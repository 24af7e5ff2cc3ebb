#pragma once

// Traversal of one binary tree with a stack, near child first. The caller tests the leaves.
//
// Source: Aila, Laine, "Understanding the Efficiency of Ray Traversal on GPUs", HPG 2009 (while-while); a node whose
// entry is beyond the nearest hit is dropped when it is popped (redundant traversal avoidance). A node is skipped
// only if its grown box is missed or its entry parameter is greater than the limit; it is entered if both are equal.

#include <cstdint>

#include "accel/bvh/bvh.h"
#include "base/host_device.h"
#include "trace/binary/traversal_stack.h"
#include "trace/intersect/load_bvh.h"
#include "trace/intersect/ray_boxes.h"
#include "trace/traversal/traversal_counter.h"

namespace pertev {

/// A traversal that can be suspended at a leaf and resumed.
struct TreeTraversal {
    uint32_t link; // next link; kNoLink: done
    int size = 0;  // entries on the stack
};

using TreeStack = TraversalStack<true>;

/// Continues to the next leaf whose box may hold a hit with t_min < t <= t_limit and returns its link; kNoLink at the
/// end. There are as many slots as the depth of the tree.
template <class Counter>
HD inline uint32_t next_leaf(TreeTraversal& traversal, const BvhNode* nodes, const RayBoxes& boxes, float t_min,
                             float t_limit, TreeStack::Slot* slots, const Counter& counter) {
    TreeStack stack = {slots, traversal.size};
    uint32_t link = traversal.link;
    while (!(link & kLeafBit)) {
        counter.add_node(nodes + link);
        link = step_down<true>(load_aligned(nodes + link), boxes, t_min, t_limit, stack);
    }
    traversal.size = stack.size;
    return link;
}

/// Continues with the top of the stack after a leaf.
HD inline void finish_leaf(TreeTraversal& traversal, TreeStack::Slot* slots, float t_limit) {
    TreeStack stack = {slots, traversal.size};
    traversal.link = stack.pop(t_limit);
    traversal.size = stack.size;
}

} // namespace pertev
