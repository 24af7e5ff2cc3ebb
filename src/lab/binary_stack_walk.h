#pragma once

// The walk of pictures by binary nodes on both devices, where StackWalk takes wide ones on the host: the same hits, and
// counts of nodes that can be compared with those of others.

#include "trace/walk_scene.h"

namespace pertev {

struct BinaryStackWalk {
    using Tree = BvhView;

    template <class Visitor, class Counter>
    HD static bool walk(const BvhView& bvh, const Ray& ray, uint32_t instance, Visitor& visitor,
                        const Counter& counter) {
        BvhView binary = bvh;
        binary.wide = nullptr;
        return StackWalk::walk(binary, ray, instance, visitor, counter);
    }
};

} // namespace pertev
