#pragma once

// A binary tree as one list: nodes in depth-first order, each with its own box and the place to go on at when that box
// is missed. A walk needs no stack and reads mostly forwards, but its order is the list's for every ray.
//
// Source: Smits, "Efficiency Issues for Ray Tracing", Journal of Graphics Tools 3(2), 1998 (skip pointers).

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "accel/bvh/bvh.h"

namespace pertev {

/// 32 bytes: two loads of 16.
struct alignas(32) SkipNode {
    Vec3 lo;
    uint32_t next = 0; // index of the node after this one's subtree; the count of nodes at the end
    Vec3 hi;
    uint32_t leaf = kNoLink; // link of the leaf, or kNoLink: an inner node, whose first child follows it
};
static_assert(sizeof(SkipNode) == 32);

struct SkipBvh {
    std::vector<SkipNode> nodes;
    std::vector<BvhTriangle> triangles; // those of the tree it was made of, in their order
    Bounds3 bounds;
};

struct SkipBvhView {
    const SkipNode* nodes = nullptr;
    const BvhTriangle* triangles = nullptr;
    uint32_t count = 0;       // of nodes
    float bounds_max_abs = 0; // largest |coordinate| of the bounds
};

/// Children in the builder's order. Throws Error(OverLimit) where the nodes, inner ones and leaves, pass 32 bits.
SkipBvh make_skip_bvh(const Bvh& bvh);

SkipBvhView view_of(const SkipBvh& bvh);

/// What is wrong: a link that leads back or out, a box that does not hold what is beneath it, a triangle that is not
/// reached just once. `boxes_hold_triangles` is false for trees with spatial splits, whose leaves' boxes are cut.
std::optional<std::string> find_fault(const SkipBvh& bvh, bool boxes_hold_triangles = true);

} // namespace pertev
