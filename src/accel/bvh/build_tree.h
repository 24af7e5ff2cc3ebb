#pragma once

// The core of the default builder: a binary tree over boxes by the binned surface area heuristic, for triangles and
// instances.
//
// Source: Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", IEEE RT 2007, section 3.
// The tree depends only on the boxes and the settings, not on threads. Its depth is limited: where SAH splits could
// run out of levels, boxes are split at the object median.

#include <cstdint>
#include <vector>

#include "accel/bvh/bvh.h"
#include "base/limits.h"
#include "base/sink.h"

namespace pertev {

struct BvhBuildSettings {
    int bins = 16;                // [2, 64], per axis
    int max_leaf = 4;             // >= 1, boxes per leaf
    int max_depth = kMaxBvhDepth; // inner nodes on any path; a tree of n boxes needs at least ceil(log2(n /
                                  // max_leaf))
    float node_cost = 1.0f;       // cost of testing a node's two boxes
    float leaf_cost = 1.0f;       // cost of testing one triangle
    Sink* sink = &nobody();       // may end the build
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
    std::vector<uint32_t> order; // ids of the references, ordered by leaf
    std::vector<bool> is_last;   // [order] whether a leaf ends here
    uint32_t root = kNoLink;
    Bounds3 bounds;
    int depth = 0;
    float sah_cost = 0;
};

/// Builds the tree. Throws Error(OverLimit) for more than kMaxBvhTriangles references, or more than max_depth levels
/// can hold.
BuiltTree build_tree(std::vector<BuildReference> references, const BvhBuildSettings& settings);

} // namespace pertev
