#pragma once

// Restart trail with a short stack: the latest pending children are kept, and older ones are dropped at the bottom.
// Only when the stack is empty does the trail restart at the root; on that path the stack is refilled.
//
// Source: Laine, "Restart Trail for Stackless BVH Traversal", HPG 2010, section 3.2; Horn et al., "Interactive k-D
// Tree GPU Raytracing", I3D 2007 (short stacks). Entries move instead of an index, so that a device keeps them in
// registers.

#include "trace/binary/restart_trail_traversal.h"

namespace pertev {

/// The top kCapacity entries of a stack.
struct ShortStack {
    static constexpr int kCapacity = 4;
    TraversalStackEntry entries[kCapacity] = {}; // [0] is the top
    int size = 0;

    HD void push(uint32_t link, float entry) {
        for (int i = kCapacity - 1; i > 0; --i) entries[i] = entries[i - 1];
        entries[0] = {link, entry};
        size = min(size + 1, kCapacity);
    }
    /// Pops the top entry. Returns false if the stack is empty.
    HD bool pop(TraversalStackEntry& top) {
        if (size == 0) return false;
        top = entries[0];
        for (int i = 1; i < kCapacity; ++i) entries[i - 1] = entries[i];
        --size;
        return true;
    }
};

template <TraversalOptions kOptions>
struct ShortStackTraversal {
    using Tree = BvhView;

    template <class Visitor, class Counter>
    HD static bool traverse(const BvhView& bvh, const Ray& ray, uint32_t instance, Visitor& visitor,
                            const Counter& counter) {
        return traverse_by_trail<kOptions, ShortStack>(bvh, ray, instance, visitor, counter);
    }
};

} // namespace pertev
