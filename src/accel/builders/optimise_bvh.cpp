// Optimizes a finished tree of any builder: it is unfolded to one triangle per leaf and improved by
// reinsert_subtrees.h.

#include <algorithm>

#include "accel/builders/build_bvh.h"
#include "accel/builders/build_spatial_splits.h"
#include "accel/builders/builders.h"
#include "accel/builders/cut_triangle.h"
#include "accel/builders/reinsert_subtrees.h"
#include "accel/builders/visit_upwards.h"
#include "base/error.h"
#include "base/parallel_until.h"

namespace pertev {
namespace {

/// Returns the tree with one triangle per leaf and references by position. A box that holds only a part of its
/// triangle is kept. Leaves come first, ordered by triangle, then the old nodes, then those that join the triangles
/// of an old leaf.
BinaryTree unfold(const Bvh& bvh, Sink& sink) {
    BinaryTree tree;
    const auto triangles = static_cast<uint32_t>(bvh.triangles.size()), inner = static_cast<uint32_t>(bvh.nodes.size());
    const std::vector<BuildReference> boxes = references_of(bvh.triangles);
    tree.nodes.resize(2 * std::size_t(triangles) - 1);
    tree.references.resize(triangles);
    std::vector<uint32_t> leaves_before(triangles); // [triangle] leaves that end before it
    for (uint32_t i = 1; i < triangles; ++i) {
        sink.check_at(i);
        leaves_before[i] = leaves_before[i - 1] + (bvh.triangles[i - 1].flags & kLastInLeaf);
    }
    const auto add_leaf = [&](uint32_t link, const Bounds3& box) {
        const uint32_t first = link & ~kLeafBit;
        uint32_t sum = kNoLink;
        for (uint32_t i = first;; ++i) {
            tree.references[i] = i;
            const Bounds3 part = intersection({boxes[i].lo, boxes[i].hi}, box);
            tree.nodes[i] = make_leaf(part.is_empty() ? box : part, i);
            const uint32_t joint = triangles + inner + i - leaves_before[i] - 1;
            if (i > first) tree.nodes[joint] = make_inner(tree, sum, i);
            sum = i > first ? joint : i;
            if (bvh.triangles[i].flags & kLastInLeaf) return sum;
        }
    };
    if (bvh.root & kLeafBit) {
        tree.root = add_leaf(bvh.root, bvh.bounds);
        return tree;
    }
    tree.root = triangles + bvh.root;
    parallel_until(inner, 1024, sink, [&](uint64_t i) {
        const BvhNode& node = bvh.nodes[i];
        for (int k = 0; k < 2; ++k) {
            const uint32_t link = node.child[k];
            tree.nodes[triangles + i].child[k] =
                link & kLeafBit ? add_leaf(link, child_bounds(node, k)) : triangles + link;
        }
    });
    visit_upwards(tree, sink, [&](uint32_t at) {
        BinaryNode& node = tree.nodes[at];
        if (!node.is_leaf()) node = make_inner(tree, node.child[0], node.child[1]);
    });
    return tree;
}

} // namespace

Bvh optimise_bvh(const Bvh& bvh, const BvhBuildSettings& settings, const ReinsertionSettings& reinsertion) {
    PERTEV_CHECK(reinsertion.passes >= 0 && reinsertion.part > 0 && reinsertion.part <= 1);
    if (bvh.root == kNoLink) return {};
    BinaryTree tree = unfold(bvh, *settings.sink);
    const float cost_before = cost_with_leaves(tree, settings);
    reinsert_subtrees(tree, reinsertion, *settings.sink);
    // The sum of areas is not exactly the cost with leaves of several triangles.
    const bool better = cost_with_leaves(tree, settings) < cost_before;
    return make_bvh(better ? std::move(tree) : unfold(bvh, *settings.sink), bvh.triangles, settings);
}

Bvh build_spatial_reinsertion_bvh(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings) {
    if (triangles.empty()) return {};
    BinaryTree tree = build_spatial_split_tree(triangles, settings);
    reinsert_subtrees(tree, {}, *settings.sink);
    return make_bvh(std::move(tree), triangles, settings);
}

} // namespace pertev
