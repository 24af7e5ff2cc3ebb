#pragma once

// Decides which nodes of a binary tree become nodes of a wide tree and which subtrees become leaves, with the least
// SAH cost: dynamic programming over (subtree, number of roots that it may keep).
//
// Source: Ylitie, Karras, Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG 2017,
// section 3.1. It only removes nodes, so a wide tree is no deeper than its binary tree and keeps its order.

#include <cstdint>
#include <vector>

#include "accel/bvh/bvh.h"
#include "base/sink.h"

namespace pertev {

inline constexpr int kMaxWidth = 8;

struct CollapseSettings {
    int max_leaf = 4;           // >= 1, triangles per leaf; longer runs of the binary tree are halved
    int triangles_at_once = 1;  // >= 1, triangles that a traversal tests in one step
    float node_cost = 1.0f;     // cost of testing all boxes of a node; >= 0
    float triangle_cost = 0.3f; // cost of each step in a leaf; >= 0
};

class CollapsedTree {
public:
    /// A part of the binary tree: a node, a leaf, or a piece of a leaf that was too long.
    struct Subtree {
        Bounds3 box;
        uint32_t right = 0;            // right child, or 0 if it has no children; the left child is the next subtree
        uint32_t first = 0, count = 0; // range of triangles; count 0 if they are not one run or too many for a leaf
    };

    /// `width` is the number of children per node, in [2, kMaxWidth]. `sink` may end it.
    CollapsedTree(const Bvh& bvh, const CollapseSettings& settings, int width, Sink& sink);

    /// All subtrees, of which the first is the whole tree; empty if there are no triangles.
    const std::vector<Subtree>& subtrees() const { return subtrees_; }
    /// Returns whether this child of a wide node becomes a leaf; otherwise it becomes a wide node.
    bool is_leaf(uint32_t subtree) const { return plans_[subtree].splits[0] == kLeaf; }
    /// Writes the children of a subtree's wide node in the binary tree's order and returns their number.
    int children_of(uint32_t subtree, uint32_t (&children)[kMaxWidth]) const;
    /// Cost of a leaf with `count` triangles, to be multiplied by the share of rays that hit its box.
    static float leaf_cost(const CollapseSettings& settings, uint32_t count);

private:
    static constexpr uint8_t kLeaf = 1, kFewer = 0;
    /// The choices for a subtree. splits[i] for i roots is the left child's share of them, or kFewer if i - 1 roots are
    /// as good. splits[width] applies to the children of a node; splits[0] is kLeaf for a leaf.
    struct Plan {
        uint8_t splits[kMaxWidth + 1] = {};
    };
    struct Costs {
        float roots[kMaxWidth]; // [i] least cost of the subtree as at most i trees; [0] is unused
    };

    void add_subtrees(const Bvh& bvh, Sink& sink);
    void join_runs(Sink& sink);
    void plan(Sink& sink);
    Costs plan_subtree(uint32_t index, const Costs* left, const Costs* right);
    void expand(uint32_t subtree, int roots, uint32_t (&children)[kMaxWidth], int& count) const;

    CollapseSettings settings_;
    int width_;
    std::vector<Subtree> subtrees_;
    std::vector<Plan> plans_;
};

} // namespace pertev
