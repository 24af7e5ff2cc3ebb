#pragma once

// The stack of binary-tree traversals, and their step at an inner node.
//
// Source: Aila, Laine, "Understanding the Efficiency of Ray Traversal on GPUs", HPG 2009: both boxes are tested at
// once, traversal continues with the nearer child, and the other one is pushed. Redundant traversal avoidance (RTA)
// drops entries beyond the nearest hit at each pop; without it no entry parameters are stored.

#include <cstdint>

#include "accel/bvh/bvh.h"
#include "base/host_device.h"
#include "base/limits.h"
#include "math/scalar.h"
#include "trace/intersect/load_bvh.h"
#include "trace/intersect/ray_boxes.h"

namespace pertev {

/// A stack over slots in a separate array, [kMaxBvhDepth]. In one object, the compiler would keep the size in the
/// device's local memory too.
template <bool kRta>
struct TraversalStack {
    using Slot = uint64_t; // link in the lower half, entry in the upper: one load, where a struct would take two
    Slot* slots;
    int size = 0;

    HD void push(uint32_t link, float entry) { slots[size++] = uint64_t(bits_of(entry)) << 32 | link; }
    /// Pops the first entry that is not beyond `limit`. Returns kNoLink if there is none.
    HD uint32_t pop(float limit) {
        while (size > 0) {
            const Slot top = slots[--size];
            if (float_of(static_cast<uint32_t>(top >> 32)) <= limit) return static_cast<uint32_t>(top);
        }
        return kNoLink;
    }
};

template <>
struct TraversalStack<false> {
    using Slot = uint32_t;
    Slot* slots;
    int size = 0;

    HD void push(uint32_t link, float) { slots[size++] = link; }
    HD uint32_t pop(float) { return size > 0 ? slots[--size] : kNoLink; }
};

/// An entry of stacks with another layout.
struct TraversalStackEntry {
    uint32_t link;
    float entry;
};

/// The next link after `node`: a child, or a popped link if neither is entered.
template <bool kNearFirst, class Stack>
HD inline uint32_t step_down(const BvhNode& node, const RayBoxes& boxes, float t_min, float t_limit, Stack& stack) {
    float entry0, entry1;
    const bool enters0 = enters_child(boxes, node, 0, t_min, t_limit, entry0);
    const bool enters1 = enters_child(boxes, node, 1, t_min, t_limit, entry1);
    if (enters0 && enters1) {
        const bool swap = kNearFirst && entry1 <= entry0;
        stack.push(swap ? node.child[0] : node.child[1], swap ? entry0 : entry1);
        return swap ? node.child[1] : node.child[0];
    }
    if (enters0 || enters1) return enters0 ? node.child[0] : node.child[1];
    return stack.pop(t_limit);
}

} // namespace pertev
