#pragma once

// Refits the nodes of a wide tree from the bottom up. The thread that finishes the last child of a node handles the
// node, so all threads work at once and none waits. A node depends only on its children, so the bytes do not depend
// on which thread that is.

#include <cstdint>

#include "accel/hploc/cluster_tree.h"
#include "base/host_device.h"
#include "math/bounds3.h"

namespace pertev {

/// The result that a refitted node passes to its parent.
struct alignas(32) NodeBox {
    Vec3 lo;    // bounds of its contents before quantization
    float cost; // SAH cost of the subtree, times the surface area of the root's box
    Vec3 hi;
    uint32_t unused;
};

/// Figures of a tree after a refit.
struct RefitResult {
    Bounds3 bounds;
    float cost; // expected cost of a ray that hits the bounds, as WideBvh::sah_cost
};

struct UpwardLinks {
    const uint32_t* parents;  // [node]; the root's entry is not read
    const uint32_t* children; // [node] number of inner children
    uint32_t* arrived;        // [node] children that are done; 0 at first
    NodeBox* boxes;
    RefitResult* result;

    /// Refits from node `i` upwards; it is called once for each node. Nodes without inner children start, and climb as
    /// long as they are the last child to arrive. `fit(node)` returns the NodeBox of a node whose inner children have
    /// theirs in `boxes`.
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

    /// Box of an inner child that is done.
    HD NodeBox box_of(uint32_t node) const { return hploc::load_fresh(boxes + node); }

private:
    /// Counts an arrival. Returns the number of arrivals including this one; writes of earlier arrivals are visible.
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
