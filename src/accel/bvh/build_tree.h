#pragma once

// The builder's core: a binary tree over boxes by the binned surface area heuristic, for triangles and instances alike.
//
// Source: Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", IEEE RT 2007, section 3.
// The tree is a function of the boxes and the settings: neither the number of threads nor their timing enters. It is
// never deeper than asked for: where a cut by cost could run out of levels, the boxes are cut into equal counts.

#include <cstdint>
#include <vector>

#include "accel/bvh/bvh.h"
#include "base/limits.h"

namespace pertev {

struct BvhBuildSettings {
    int bins = 16;                // [2, 64] an axis
    int max_leaf = 4;             // >= 1, boxes a leaf may hold
    int max_depth = kMaxBvhDepth; // inner nodes on any way down; a tree of n needs ceil(log2(n / max_leaf)) at least
    float node_cost = 1.0f;       // of testing the two boxes of a node
    float leaf_cost = 1.0f;       // of testing one triangle
    bool operator==(const BvhBuildSettings&) const = default;
};

struct alignas(16) BuildReference {
    Vec3 lo;
    uint32_t id = 0;
    Vec3 hi;
    uint32_t unused = 0;
};

struct BuiltTree {
    std::vector<BvhNode> nodes;  // leaf links name positions in `order`
    std::vector<uint32_t> order; // ids of the references, leaf after leaf
    std::vector<bool> is_last;   // [order] the leaf ends here
    uint32_t root = kNoLink;
    Bounds3 bounds;
    int depth = 0;
    float sah_cost = 0;
};

/// Throws Error(OverLimit) for more than kMaxBvhTriangles references, or more than max_depth levels can hold.
BuiltTree build_tree(std::vector<BuildReference> references, const BvhBuildSettings& settings);

} // namespace pertev
