#pragma once

// The same tree with up to N children a node: fewer and longer steps, for walks that test N boxes at once. Made from a
// binary tree by the collapse of least expected cost (collapse_tree.h).
//
// Source of the idea: Wald, Benthin, Boulos, "Getting Rid of Packets", IEEE RT 2008; Dammertz, Hanika, Keller, "Shallow
// Bounding Volume Hierarchies for Fast SIMD Ray Tracing of Incoherent Rays", EGSR 2008.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "accel/bvh/bvh.h"
#include "accel/bvh/collapse_tree.h"
#include "base/limits.h"

namespace pertev {

template <int kWidth>
struct alignas(64) WideBvhNode {
    float planes[6][kWidth]; // lower x, upper x, lower y, upper y, lower z, upper z; a place left empty: +-inf
    uint32_t child[kWidth];  // index of a node, or kLeafBit | first triangle; kNoLink: empty. No place after it is used
    uint32_t count[kWidth];  // triangles of a leaf; 0: an inner node, or empty
};
static_assert(sizeof(WideBvhNode<4>) == 128 && sizeof(WideBvhNode<8>) == 256);

template <int kWidth>
struct WideBvh {
    std::vector<WideBvhNode<kWidth>> nodes; // depth first, [0] the root; none where there is no triangle
    std::vector<BvhTriangle> triangles;     // the binary tree's, with the ends of these leaves in their flags
    Bounds3 bounds;
    int depth = 0;      // nodes on the longest way down; at most kMaxBvhDepth
    float sah_cost = 0; // expected cost of a ray that meets the bounds, by the collapse's settings
};

/// What a walk needs; plain pointers, host's or device's.
template <int kWidth>
struct WideBvhView {
    const WideBvhNode<kWidth>* nodes = nullptr; // null where there is no triangle
    const BvhTriangle* triangles = nullptr;
    float bounds_max_abs = 0; // largest |coordinate| of the bounds
};

/// Entries that a walk's stack needs: at each level all children but the one it goes on to.
template <int kWidth>
inline constexpr int kWideStackSize = kMaxBvhDepth * (kWidth - 1) + 1;

template <int kWidth>
WideBvhView<kWidth> view_of(const WideBvh<kWidth>& bvh) {
    if (bvh.nodes.empty()) return {};
    return {bvh.nodes.data(), bvh.triangles.data(), bvh.bounds.max_abs()};
}

/// kWidth is 4 or 8. Throws Error(OverLimit) where leaves longer than max_leaf, cut up, make it deeper than a walk's
/// stack allows.
template <int kWidth>
WideBvh<kWidth> make_wide_bvh(const Bvh& bvh, const CollapseSettings& settings = {});

/// For the CPU's vector unit (trace/wide/walk_wide.h): eight boxes at a time, and four triangles, for about twice what
/// the boxes of a node cost.
inline constexpr int kWideChildren = 8;
inline constexpr CollapseSettings kSimdCollapse = {.max_leaf = 4, .triangles_at_once = 4, .triangle_cost = 2};

/// Whether links and counts are sound, each node and triangle is reached once, the depth is as stated and every box
/// holds what is beneath it. Nothing when it is sound, else what is wrong. `clipped`: the tree has spatial splits, so a
/// leaf's box holds only a part of each of its triangles.
template <int kWidth>
std::optional<std::string> find_fault(const WideBvh<kWidth>& bvh, bool clipped = false);

} // namespace pertev
