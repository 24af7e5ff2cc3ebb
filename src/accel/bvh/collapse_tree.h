#pragma once

// Decides which nodes of a binary tree become the nodes of a wide one, and which subtrees become leaves, so that the
// expected cost of a ray is least: dynamic programming over (subtree, number of roots it may be left with).
//
// Source: Ylitie, Karras, Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG 2017,
// section 3.1. It only ever drops nodes, so a wide tree is no deeper than its binary one and keeps its order.

#include <cstdint>
#include <vector>

#include "accel/bvh/bvh.h"

namespace pertev {

inline constexpr int kMaxWidth = 8;

struct CollapseSettings {
    int max_leaf = 4;           // >= 1, triangles of a leaf; longer runs of the binary tree are cut in halves
    int triangles_at_once = 1;  // >= 1, what the walk tests in one step
    float node_cost = 1.0f;     // of testing all boxes of a node; >= 0
    float triangle_cost = 0.3f; // of each step begun in a leaf; >= 0
};

class CollapsedTree {
public:
    /// A part of the binary tree: one of its nodes or leaves, or a piece of a leaf that was too long.
    struct Subtree {
        Bounds3 box;
        uint32_t right = 0;            // the right child; the left one is the next. 0: it has none
        uint32_t first = 0, count = 0; // its triangles; a count of 0: they are not one run, or too many for a leaf
    };

    /// `width` children a node, [2, kMaxWidth].
    CollapsedTree(const Bvh& bvh, const CollapseSettings& settings, int width);

    /// [0] is the whole tree; none where it is empty.
    const std::vector<Subtree>& subtrees() const { return subtrees_; }
    /// Whether this child of a wide node is best a leaf; else it is a wide node itself.
    bool is_leaf(uint32_t subtree) const { return plans_[subtree].splits[0] == kLeaf; }
    /// The children of the wide node that stands for a subtree, in the binary tree's order; returns how many.
    int children_of(uint32_t subtree, uint32_t (&children)[kMaxWidth]) const;
    /// Cost of a leaf of so many triangles, times a box's share of rays.
    static float leaf_cost(const CollapseSettings& settings, uint32_t count);

private:
    static constexpr uint8_t kLeaf = 1, kFewer = 0;
    /// splits[i], i roots: how many of them the left child has; kFewer: i - 1 roots are as good. [width] is of the
    /// children where it is a node; [0] is kLeaf for a leaf.
    struct Plan {
        uint8_t splits[kMaxWidth + 1] = {};
    };
    struct Costs {
        float roots[kMaxWidth]; // [i] least cost of the subtree as at most i trees; [0] unused
    };

    void add_subtrees(const Bvh& bvh);
    void join_runs();
    void plan();
    Costs plan_subtree(uint32_t index, const Costs* left, const Costs* right);
    void expand(uint32_t subtree, int roots, uint32_t (&children)[kMaxWidth], int& count) const;

    CollapseSettings settings_;
    int width_;
    std::vector<Subtree> subtrees_;
    std::vector<Plan> plans_;
};

} // namespace pertev
