#pragma once

// Restart trail with a short stack: the last few children that wait are kept, older ones fall out at the bottom, and
// only when the stack runs dry does the trail lead down from the root again. On that way the stack fills anew.
//
// Source: Laine, "Restart Trail for Stackless BVH Traversal", HPG 2010, section 3.2; Horn et al., "Interactive k-D Tree
// GPU Raytracing", I3D 2007 (short stacks). Entries move rather than an index, so that the device has them in
// registers.

#include "trace/binary/restart_trail_walk.h"

namespace pertev {

/// The top kCapacity entries of a stack.
struct ShortStack {
    static constexpr int kCapacity = 4;
    WalkStackEntry entries[kCapacity] = {}; // [0] is the top
    int size = 0;

    HD void push(uint32_t link, float entry) {
        for (int i = kCapacity - 1; i > 0; --i) entries[i] = entries[i - 1];
        entries[0] = {link, entry};
        size = min(size + 1, kCapacity);
    }
    /// False when there is none.
    HD bool pop(WalkStackEntry& top) {
        if (size == 0) return false;
        top = entries[0];
        for (int i = 1; i < kCapacity; ++i) entries[i - 1] = entries[i];
        --size;
        return true;
    }
};

template <WalkOptions kOptions>
struct ShortStackWalk {
    using Tree = BvhView;

    template <class Visitor, class Counter>
    HD static bool walk(const BvhView& bvh, const Ray& ray, uint32_t instance, Visitor& visitor,
                        const Counter& counter) {
        return walk_by_trail<kOptions, ShortStack>(bvh, ray, instance, visitor, counter);
    }
};

} // namespace pertev
