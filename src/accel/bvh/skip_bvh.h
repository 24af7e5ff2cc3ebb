#pragma once

// A binary tree as a list: nodes in depth-first order, each with its own box and a skip pointer to the node that
// follows if the box is missed. Traversal needs no stack and reads mostly forwards, but all rays have the same order.
//
// Source: Smits, "Efficiency Issues for Ray Tracing", Journal of Graphics Tools 3(2), 1998 (skip pointers).

#include <cstdint>
#include <vector>

#include "accel/bvh/bvh.h"
#include "base/sink.h"

namespace pertev {

/// Node of 32 bytes, loaded as two times 16.
struct alignas(32) SkipNode {
    Vec3 lo;
    uint32_t next = 0; // index of the node after this one's subtree; at the end the number of nodes
    Vec3 hi;
    uint32_t leaf = kNoLink; // link of the leaf, or kNoLink for an inner node, whose first child is the next node
};
static_assert(sizeof(SkipNode) == 32);

struct SkipBvh {
    std::vector<SkipNode> nodes;
    std::vector<BvhTriangle> triangles; // the triangles of the binary tree in their order
    Bounds3 bounds;
};

struct SkipBvhView {
    const SkipNode* nodes = nullptr;
    const BvhTriangle* triangles = nullptr;
    uint32_t count = 0;       // number of nodes
    float bounds_max_abs = 0; // largest |coordinate| of the bounds
};

/// Makes the list with children in the builder's order. Throws Error(OverLimit) if inner nodes and leaves exceed 32
/// bits. `sink` may end it.
SkipBvh make_skip_bvh(const Bvh& bvh, Sink& sink = nobody());

SkipBvhView view_of(const SkipBvh& bvh);

} // namespace pertev
