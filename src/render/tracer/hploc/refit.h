#pragma once

// Fits a tree of compressed nodes to triangles that have moved: nodes and leaves stay what they are, boxes are made
// anew from the bottom up, each node by whoever finishes the last of its children. Each box is that of its triangles,
// to the bit, so the bytes do not depend on who that is.

#include <cstdint>

#include "accel/bvh/compress_boxes.h"
#include "accel/bvh/compressed_bvh.h"
#include "accel/hploc/cluster_tree.h"
#include "accel/hploc/leaves.h"

namespace pertev::hploc {

/// The box of what a node holds, before it is rounded.
struct alignas(32) NodeBox {
    Vec3 lo;
    uint32_t unused0;
    Vec3 hi;
    uint32_t unused1;
};

/// One node each: counts its inner children and tells them where it is. The root's own entry is the caller's.
struct LinkParents {
    const CompressedBvhNode* nodes;
    uint32_t *parents, *children;

    HD void operator()(uint32_t i) const {
        const uint32_t count = count_ones(inner_slots(nodes[i]));
        children[i] = count;
        for (uint32_t k = 0; k < count; ++k) parents[nodes[i].child_base + k] = i;
    }
};

/// One triangle of the tree each: takes its new place.
struct MoveTriangles {
    const BvhTriangle* moved; // in the order of those that the tree was built of
    const uint32_t* sources;  // [triangle of the tree] which of them
    BvhTriangle* triangles;

    HD void operator()(uint32_t i) const {
        BvhTriangle triangle = load_triangle(moved + sources[i]);
        triangle.flags = (triangle.flags & ~kLastInLeaf) | (triangles[i].flags & kLastInLeaf);
        triangles[i] = triangle;
    }
};

/// One node each: those without inner children begin, and climb as far as they are the last to come.
struct RefitNodes {
    CompressedBvhNode* nodes;
    const BvhTriangle* triangles;
    const uint32_t* parents;  // [0] kNone
    const uint32_t* children; // [node] how many inner ones; nodes change meanwhile
    uint32_t* arrived;        // [node] children that are done; 0 at first
    NodeBox* boxes;
    Bounds3* bounds; // of all

    HD void operator()(uint32_t i) const {
        if (children[i] != 0) return;
        while (true) {
            fit(i);
            const uint32_t parent = parents[i];
            if (parent == kNone) return;
            if (arrive(arrived + parent) != children[parent]) return;
            i = parent;
        }
    }

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

    HD void fit(uint32_t i) const {
        CompressedBvhNode node = nodes[i];
        Bounds3 slots[8], all;
        uint32_t child = node.child_base, triangle = node.triangle_base;
        for (uint32_t bit = 0; bit < 24; ++bit) {
            if (node.triangles >> bit & 1u) slots[bit % 8].extend(bounds_of(triangles[triangle++]));
        }
        for (uint32_t s = 0; s < 8; ++s) {
            if (inner_slots(node) >> s & 1u) {
                const NodeBox box = load_fresh(boxes + child++);
                slots[s] = {box.lo, box.hi};
            }
            all.extend(slots[s]);
        }
        compress_boxes(node, all, slots);
        nodes[i] = node;
        boxes[i] = {all.lo, 0, all.hi, 0};
        if (i == 0) *bounds = all;
    }
};

} // namespace pertev::hploc
