#pragma once

// A binary tree as builders of every kind make it, nodes in any order, and its way into a Bvh: no walk too deep, leaves
// chosen by cost, nodes depth first.
//
// Source of the choice of leaves: Meister, Bittner, "Parallel Locally-Ordered Clustering for Bounding Volume Hierarchy
// Construction", TVCG 2018 (subtrees collapse where a leaf costs less). All of it is a function of the
// tree's shape: in which order the nodes lie does not matter, nor on how many threads it runs.

#include <bit>
#include <cstdint>
#include <vector>

#include "accel/bvh/build_tree.h"
#include "accel/bvh/bvh.h"

namespace pertev {

struct BinaryNode {
    Bounds3 box;
    uint32_t child[2]; // inner: nodes; leaf: {position of its first reference, kLeafBit | how many}

    bool is_leaf() const { return (child[1] & kLeafBit) != 0; }
    uint32_t leaf_size() const { return child[1] & ~kLeafBit; }
};

struct BinaryTree {
    std::vector<BinaryNode> nodes;    // may hold some that nothing links to
    std::vector<uint32_t> references; // positions of triangles, leaf after leaf
    uint32_t root = kNoLink;          // a node; kNoLink: no triangle
};

/// Levels of inner nodes that equal cuts take to bring n references down to single ones.
inline int levels_needed(uint64_t n) { return n < 2 ? 0 : std::bit_width(n - 1); }

/// Puts `child` where `old_child` is; above it is `parent`, or nothing (kNoLink). `parents`: [node] the node above.
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

/// The longest side of a box: 0, 1, 2; of equal ones the first.
inline int longest_axis(const Bounds3& box) {
    const Vec3 size = box.size();
    return size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
}

/// Throws Error(OverLimit) where one tree cannot hold that many.
void check_reference_count(uint64_t count);

/// Cuts into equal counts whatever part of the tree would lie too deep: afterwards no way down passes more than
/// max_depth inner nodes. Leaves that are moved keep their boxes. max_depth >= levels_needed(number of leaves).
void limit_depth(BinaryTree& tree, int max_depth);

/// What make_bvh's tree would cost a ray, in units of the root's area; how much limiting the depth adds is left out.
float cost_with_leaves(const BinaryTree& tree, const BvhBuildSettings& settings);

/// The tree over `triangles`, which its references name. Subtrees of up to settings.max_leaf triangles become leaves
/// where that costs no more; a triangle that a leaf would hold twice, it holds once. Of the settings, `bins` and
/// `max_depth` do not count: the depth is at most kMaxBvhDepth.
Bvh make_bvh(BinaryTree tree, const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings);

} // namespace pertev
