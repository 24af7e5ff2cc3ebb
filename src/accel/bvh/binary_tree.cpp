#include "accel/bvh/binary_tree.h"

#include <algorithm>
#include <ranges>

#include <fmt/format.h>

#include "base/error.h"
#include "base/limits.h"

namespace pertev {
namespace {

/// Every node that can be reached, each before its children.
std::vector<uint32_t> nodes_downwards(const BinaryTree& tree, uint32_t root) {
    std::vector<uint32_t> order, pending = {root};
    while (!pending.empty()) {
        const uint32_t at = pending.back();
        pending.pop_back();
        order.push_back(at);
        const BinaryNode& node = tree.nodes[at];
        if (!node.is_leaf()) pending.insert(pending.end(), {node.child[1], node.child[0]});
    }
    return order;
}

/// Links `leaves` by equal cuts along the longest side, taking inner nodes from `free` as they come.
class EqualCuts {
public:
    EqualCuts(BinaryTree& tree, std::vector<uint32_t>& leaves, const std::vector<uint32_t>& free)
        : tree_(tree), leaves_(leaves), free_(free) {}

    uint32_t link(std::size_t begin, std::size_t end) {
        if (end - begin == 1) return leaves_[begin];
        const uint32_t index = free_[used_++];
        const auto centre = [&](uint32_t leaf) { return tree_.nodes[leaf].box.lo + tree_.nodes[leaf].box.hi; };
        Bounds3 centres;
        for (std::size_t i = begin; i < end; ++i) centres.extend(centre(leaves_[i]));
        const int axis = longest_axis(centres);
        const std::size_t middle = begin + (end - begin) / 2;
        const auto at = [&](std::size_t i) { return leaves_.begin() + static_cast<std::ptrdiff_t>(i); };
        std::nth_element(at(begin), at(middle), at(end), [&](uint32_t a, uint32_t b) {
            const float ca = component(centre(a), axis), cb = component(centre(b), axis);
            return ca != cb ? ca < cb : first_triangle(a) < first_triangle(b);
        });
        const uint32_t left = link(begin, middle), right = link(middle, end);
        tree_.nodes[index] = make_inner(tree_, left, right);
        return index;
    }

private:
    uint32_t first_triangle(uint32_t leaf) const { return tree_.references[tree_.nodes[leaf].child[0]]; }

    BinaryTree& tree_;
    std::vector<uint32_t>& leaves_;
    const std::vector<uint32_t>& free_;
    std::size_t used_ = 0;
};

void rebuild_by_counts(BinaryTree& tree, uint32_t root) {
    std::vector<uint32_t> leaves, inner;
    for (const uint32_t at : nodes_downwards(tree, root)) (tree.nodes[at].is_leaf() ? leaves : inner).push_back(at);
    EqualCuts(tree, leaves, inner).link(0, leaves.size()); // the root comes first in `inner`, so it stays the root
}

/// The triangles beneath a node, each once, in their own order.
void collect_references(const BinaryTree& tree, uint32_t root, std::vector<uint32_t>& held) {
    held.clear();
    std::vector<uint32_t> pending = {root};
    while (!pending.empty()) {
        const BinaryNode& node = tree.nodes[pending.back()];
        pending.pop_back();
        if (node.is_leaf()) {
            const auto first = tree.references.begin() + node.child[0];
            held.insert(held.end(), first, first + node.leaf_size());
        } else {
            pending.insert(pending.end(), {node.child[0], node.child[1]});
        }
    }
    std::sort(held.begin(), held.end());
    held.erase(std::unique(held.begin(), held.end()), held.end());
}

struct NodeSummary {
    float cost = 0;    // times the root's area
    uint32_t size = 0; // references beneath; of a leaf, triangles
    bool leaf = false; // whether it becomes one
};

/// Decides from the bottom up which subtrees become leaves: those where that costs no more.
std::vector<NodeSummary> choose_leaves(const BinaryTree& tree, const BvhBuildSettings& settings) {
    const auto max_leaf = static_cast<std::size_t>(settings.max_leaf);
    std::vector<NodeSummary> summaries(tree.nodes.size());
    std::vector<uint32_t> held;
    const std::vector<uint32_t> order = nodes_downwards(tree, tree.root);
    for (const uint32_t at : std::views::reverse(order)) {
        const BinaryNode& node = tree.nodes[at];
        NodeSummary& summary = summaries[at];
        const float area = node.box.half_area();
        if (node.is_leaf()) {
            summary = {settings.leaf_cost * static_cast<float>(node.leaf_size()) * area, node.leaf_size(), true};
            continue;
        }
        const NodeSummary &left = summaries[node.child[0]], &right = summaries[node.child[1]];
        summary = {settings.node_cost * area + left.cost + right.cost, left.size + right.size, false};
        if (summary.size > 2 * max_leaf) continue; // a triangle twice is common in trees by spatial splits, not thrice
        collect_references(tree, at, held);
        const float cost = settings.leaf_cost * static_cast<float>(held.size()) * area;
        if (held.size() > max_leaf || cost > summary.cost) continue;
        summary = {cost, static_cast<uint32_t>(held.size()), true};
    }
    return summaries;
}

/// Copies nodes and triangles to depth-first order, each node before its first child.
class Flattener {
public:
    Flattener(const BinaryTree& tree, const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings)
        : tree_(tree), triangles_(triangles), settings_(settings), summaries_(choose_leaves(tree, settings)) {}

    Bvh run() {
        const BinaryNode& root = tree_.nodes[tree_.root];
        bvh_.bounds = root.box;
        root_area_ = static_cast<double>(max(root.box.half_area(), 0x1p-126f));
        bvh_.triangles.reserve(summaries_[tree_.root].size);
        struct Pending {
            uint32_t node, parent;
            int k, depth;
        };
        std::vector<Pending> pending = {{tree_.root, kNoLink, 0, 0}};
        while (!pending.empty()) {
            const Pending at = pending.back();
            pending.pop_back();
            const bool leaf = summaries_[at.node].leaf;
            const uint32_t link = leaf ? add_leaf(at.node) : static_cast<uint32_t>(bvh_.nodes.size());
            if (at.parent == kNoLink) {
                bvh_.root = link;
            } else {
                bvh_.nodes[at.parent].child[at.k] = link;
            }
            if (leaf) continue;
            const BinaryNode& node = tree_.nodes[at.node];
            // Child 0 is the one where a ray finds something sooner: more surface a triangle, as in build_tree.
            const int first = surface_by_size(node, 0, 1) >= surface_by_size(node, 1, 0) ? 0 : 1;
            const uint32_t children[2] = {node.child[first], node.child[1 - first]};
            BvhNode& out = bvh_.nodes.emplace_back();
            for (int k = 0; k < 2; ++k) set_child(out, k, tree_.nodes[children[k]].box, kNoLink);
            for (int k = 1; k >= 0; --k) pending.push_back({children[k], link, k, at.depth + 1});
            bvh_.depth = std::max(bvh_.depth, at.depth + 1);
            cost_ += static_cast<double>(settings_.node_cost) * probability(node);
        }
        bvh_.sah_cost = static_cast<float>(cost_);
        return std::move(bvh_);
    }

private:
    float surface_by_size(const BinaryNode& node, int k, int other) const {
        return tree_.nodes[node.child[k]].box.half_area() * static_cast<float>(summaries_[node.child[other]].size);
    }

    double probability(const BinaryNode& node) const { return static_cast<double>(node.box.half_area()) / root_area_; }

    uint32_t add_leaf(uint32_t index) {
        const auto first = static_cast<uint32_t>(bvh_.triangles.size());
        collect_references(tree_, index, held_);
        for (const uint32_t reference : held_) {
            BvhTriangle& t = bvh_.triangles.emplace_back(triangles_[reference]);
            t.flags &= ~kLastInLeaf;
        }
        bvh_.triangles.back().flags |= kLastInLeaf;
        cost_ += static_cast<double>(settings_.leaf_cost) * static_cast<double>(held_.size()) *
                 probability(tree_.nodes[index]);
        return kLeafBit | first;
    }

    const BinaryTree& tree_;
    const std::vector<BvhTriangle>& triangles_;
    const BvhBuildSettings& settings_;
    const std::vector<NodeSummary> summaries_;
    std::vector<uint32_t> held_;
    double root_area_ = 1, cost_ = 0;
    Bvh bvh_;
};

} // namespace

void check_reference_count(uint64_t count) {
    if (count <= kMaxBvhTriangles) return;
    throw Error(ErrorCode::OverLimit,
                fmt::format("{} triangles in one tree; the limit is {}", count, kMaxBvhTriangles));
}

void limit_depth(BinaryTree& tree, int max_depth) {
    if (tree.root == kNoLink) return;
    std::vector<uint32_t> height(tree.nodes.size()), leaves(tree.nodes.size());
    const std::vector<uint32_t> order = nodes_downwards(tree, tree.root);
    for (const uint32_t at : std::views::reverse(order)) {
        const BinaryNode& node = tree.nodes[at];
        leaves[at] = 1;
        if (node.is_leaf()) continue;
        const uint32_t left = node.child[0], right = node.child[1];
        height[at] = 1 + std::max(height[left], height[right]);
        leaves[at] = leaves[left] + leaves[right];
    }
    PERTEV_CHECK(levels_needed(leaves[tree.root]) <= max_depth);
    struct Pending {
        uint32_t node;
        int levels_left;
    };
    std::vector<Pending> pending = {{tree.root, max_depth}};
    while (!pending.empty()) {
        const Pending at = pending.back();
        pending.pop_back();
        if (height[at.node] <= static_cast<uint32_t>(at.levels_left)) continue;
        if (levels_needed(leaves[at.node]) >= at.levels_left) {
            rebuild_by_counts(tree, at.node);
        } else { // its children have levels enough for equal cuts
            for (const uint32_t child : tree.nodes[at.node].child) pending.push_back({child, at.levels_left - 1});
        }
    }
}

float cost_with_leaves(const BinaryTree& tree, const BvhBuildSettings& settings) {
    return choose_leaves(tree, settings)[tree.root].cost;
}

Bvh make_bvh(BinaryTree tree, const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings) {
    PERTEV_CHECK(settings.max_leaf >= 1);
    if (tree.root == kNoLink) return {};
    limit_depth(tree, kMaxBvhDepth);
    return Flattener(tree, triangles, settings).run();
}

} // namespace pertev
