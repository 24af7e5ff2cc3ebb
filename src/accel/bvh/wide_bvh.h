#pragma once

// The N-wide tree: fewer but larger steps for traversals that test N boxes at once. It is made from a binary tree by
// the collapse with the least SAH cost (collapse_tree.h).
//
// Source of the idea: Wald, Benthin, Boulos, "Getting Rid of Packets", IEEE RT 2008; Dammertz, Hanika, Keller, "Shallow
// Bounding Volume Hierarchies for Fast SIMD Ray Tracing of Incoherent Rays", EGSR 2008.

#include <cstdint>
#include <vector>

#include "accel/bvh/bvh.h"
#include "accel/bvh/collapse_tree.h"
#include "base/limits.h"

namespace pertev {

template <int kWidth>
struct alignas(64) WideBvhNode {
    float planes[6][kWidth]; // lower x, upper x, lower y, upper y, lower z, upper z; +-inf in an empty slot
    uint32_t child[kWidth];  // index of a node, or kLeafBit | first triangle; kNoLink in an empty slot, which only
                             // empty slots follow
    uint32_t count[kWidth];  // triangles of a leaf; 0 for an inner node or an empty slot
};
static_assert(sizeof(WideBvhNode<4>) == 128 && sizeof(WideBvhNode<8>) == 256);

template <int kWidth>
struct WideBvh {
    std::vector<WideBvhNode<kWidth>> nodes; // depth first, [0] is the root; empty if there is no triangle
    std::vector<BvhTriangle> triangles;     // the binary tree's, with kLastInLeaf set for these leaves
    Bounds3 bounds;
    int depth = 0;      // nodes on the longest path; at most kMaxBvhDepth
    float sah_cost = 0; // expected cost of a ray that hits the bounds, by the costs of the collapse
};

/// Arrays of a WideBvh for traversal, as plain pointers of host or device.
template <int kWidth>
struct WideBvhView {
    const WideBvhNode<kWidth>* nodes = nullptr; // null if there is no triangle
    const BvhTriangle* triangles = nullptr;
    float bounds_max_abs = 0;    // largest |coordinate| of the bounds
    uint32_t triangle_count = 0; // a triangle of several leaves counts for each
};

/// Size of a traversal stack: at each level all children but the one that is visited.
template <int kWidth>
inline constexpr int kWideStackSize = kMaxBvhDepth * (kWidth - 1) + 1;

template <int kWidth>
WideBvhView<kWidth> view_of(const WideBvh<kWidth>& bvh) {
    if (bvh.nodes.empty()) return {};
    return {bvh.nodes.data(), bvh.triangles.data(), bvh.bounds.max_abs(), static_cast<uint32_t>(bvh.triangles.size())};
}

/// Makes the wide tree; kWidth is 4 or 8. Throws Error(OverLimit) if splitting leaves longer than max_leaf makes it
/// deeper than the traversal stack allows.
template <int kWidth>
WideBvh<kWidth> make_wide_bvh(const Bvh& bvh, const CollapseSettings& settings = {}, Sink& sink = nobody());

/// Parameters for the CPU's SIMD unit (trace/wide/traverse_wide.h): eight boxes at a time, and four triangles for about
/// twice the cost of a node's boxes.
inline constexpr int kWideChildren = 8;
inline constexpr CollapseSettings kSimdCollapse = {.max_leaf = 4, .triangles_at_once = 4, .triangle_cost = 2};

} // namespace pertev
