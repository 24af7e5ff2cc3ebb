#pragma once

// The binary tree that all builders make, with nodes in any order, and its conversion to a Bvh: limits the depth,
// chooses leaves by cost and orders nodes depth first.
//
// Source of the choice of leaves: Meister, Bittner, "Parallel Locally-Ordered Clustering for Bounding Volume
// Hierarchy Construction", TVCG 2018 (subtrees collapse if a leaf costs less). The result depends only on the shape
// of the tree, not on the order of nodes or the number of threads.

#include <bit>
#include <cstdint>
#include <vector>

#include "accel/bvh/build_tree.h"
#include "accel/bvh/bvh.h"

namespace pertev {

struct BinaryNode {
    Bounds3 box;
    uint32_t child[2]; // inner: nodes; leaf: {position of its first reference, kLeafBit | count}

    bool is_leaf() const { return (child[1] & kLeafBit) != 0; }
    uint32_t leaf_size() const { return child[1] & ~kLeafBit; }
};

struct BinaryTree {
    std::vector<BinaryNode> nodes;    // may contain unlinked nodes
    std::vector<uint32_t> references; // positions of triangles, ordered by leaf
    uint32_t root = kNoLink;          // kNoLink if there is no triangle
};

/// Number of levels that object medians need to separate n references.
inline int levels_needed(uint64_t n) { return n < 2 ? 0 : std::bit_width(n - 1); }

/// Replaces `old_child` by `child` in `parent`, which is kNoLink at the root. `parents`: [node] its parent.
inline void replace_child(BinaryTree& tree, std::vector<uint32_t>& parents, uint32_t parent, uint32_t old_child,
                          uint32_t child) {
    parents[child] = parent;
    if (parent == kNoLink) {
        tree.root = child;
    } else {
        BinaryNode& node = tree.nodes[parent];
        node.child[node.child[0] == old_child ? 0 : 1] = child;
    }
}

inline BinaryNode make_leaf(const Bounds3& box, uint32_t first, uint32_t count = 1) {
    return {box, {first, kLeafBit | count}};
}

inline BinaryNode make_inner(const BinaryTree& tree, uint32_t left, uint32_t right) {
    Bounds3 box = tree.nodes[left].box;
    box.extend(tree.nodes[right].box);
    return {box, {left, right}};
}

/// Axis of the longest side of a box: 0, 1 or 2; the first of equal ones.
inline int longest_axis(const Bounds3& box) {
    const Vec3 size = box.size();
    return size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
}

/// Throws Error(OverLimit) if one tree cannot hold `count` references.
void check_reference_count(uint64_t count);

/// Rebuilds by object medians every part of the tree that is too deep, so that no path has more than max_depth inner
/// nodes. Leaves keep their boxes. max_depth >= levels_needed(number of leaves). `sink` may end it.
void limit_depth(BinaryTree& tree, int max_depth, Sink& sink = nobody());

/// SAH cost of the tree that make_bvh would make, times the half area of its root, without the effect of limiting the
/// depth.
float cost_with_leaves(const BinaryTree& tree, const BvhBuildSettings& settings);

/// Makes the tree over `triangles`, which its references index. Subtrees of up to settings.max_leaf triangles become
/// leaves if that costs no more, and a leaf holds each triangle once. The depth is at most kMaxBvhDepth;
/// settings.bins and settings.max_depth are ignored.
Bvh make_bvh(BinaryTree tree, const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings);

} // namespace pertev
