#pragma once

// Fits the nodes of a wide tree from the bottom up, each by whoever finishes the last of its children, so that all
// threads work at once and none waits. What a node becomes is a function of its children alone, so the bytes do not
// depend on who that is.

#include <cstdint>

#include "accel/hploc/cluster_tree.h"
#include "base/host_device.h"
#include "math/bounds3.h"

namespace pertev {

/// What a refitted node tells the one above it.
struct alignas(32) NodeBox {
    Vec3 lo;    // of what it holds, before it is rounded
    float cost; // that a ray through the root's box expects here and beneath, times the area of that box
    Vec3 hi;
    uint32_t unused;
};

/// Of a whole tree, after a refit.
struct RefitResult {
    Bounds3 bounds;
    float cost; // of a ray that meets the bounds, as WideBvh::sah_cost
};

struct UpwardLinks {
    const uint32_t* parents;  // of each node; of the root nothing that is looked at
    const uint32_t* children; // of each node, how many inner ones
    uint32_t* arrived;        // of each node, children that are done; 0 at first
    NodeBox* boxes;
    RefitResult* result;

    /// One call for each node: those without inner children begin, and climb as far as they are the last to come.
    /// `fit(node)` returns the NodeBox of a node whose inner children's lie in `boxes`.
    template <class Fit>
    HD void climb_from(uint32_t i, const Fit& fit) const {
        if (children[i] != 0) return;
        while (true) {
            const NodeBox box = fit(i);
            boxes[i] = box;
            if (i == 0) {
                const Bounds3 all = {box.lo, box.hi};
                const float area = all.half_area();
                *result = {all, area > 0 ? box.cost / area : 0.0f};
                return;
            }
            const uint32_t parent = parents[i];
            if (arrive(arrived + parent) != children[parent]) return;
            i = parent;
        }
    }

    /// Of an inner child that is done.
    HD NodeBox box_of(uint32_t node) const { return hploc::load_fresh(boxes + node); }

private:
    /// How many have arrived, this one among them; it sees what those before wrote.
    HD static uint32_t arrive(uint32_t* count) {
#if defined(__CUDA_ARCH__)
        __threadfence();
        const uint32_t before = atomicAdd(count, 1u);
        __threadfence();
        return before + 1;
#else
        return __atomic_fetch_add(count, 1u, __ATOMIC_ACQ_REL) + 1;
#endif
    }
};

} // namespace pertev
