#pragma once

// Visits every node of a binary tree after its children, on all threads: first the subtrees below a fixed cut in
// parallel, then the nodes above it. The result does not depend on the number of threads.

#include <cstdint>
#include <ranges>
#include <vector>

#include "accel/builders/binary_tree.h"
#include "base/parallel_for.h"

namespace pertev {

/// A cut through a tree: the nodes above it, each before its children, and the roots of the subtrees below.
struct CrossCut {
    std::vector<uint32_t> above, roots;
};

/// Descends breadth first until there are enough subtrees to distribute; small trees have none.
inline CrossCut cut_across(const BinaryTree& tree) {
    constexpr std::size_t kSubtrees = 2048, kMinNodes = 1 << 14;
    CrossCut cut;
    if (tree.root == kNoLink) return cut;
    std::vector<uint32_t> level = {tree.root};
    if (tree.nodes.size() < kMinNodes) return {{}, level};
    while (!level.empty() && cut.roots.size() + level.size() < kSubtrees) {
        std::vector<uint32_t> next;
        for (const uint32_t at : level) {
            const BinaryNode& node = tree.nodes[at];
            (node.is_leaf() ? cut.roots : cut.above).push_back(at);
            if (!node.is_leaf()) next.insert(next.end(), {node.child[0], node.child[1]});
        }
        level = std::move(next);
    }
    cut.roots.insert(cut.roots.end(), level.begin(), level.end());
    return cut;
}

/// Returns the nodes of a subtree, each before its children.
inline std::vector<uint32_t> nodes_downwards(const BinaryTree& tree, uint32_t root) {
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

/// Calls visit(node) for every reachable node, children first. `sink` may end it.
template <class Visit>
void visit_upwards(const BinaryTree& tree, Sink& sink, const Visit& visit) {
    const CrossCut cut = cut_across(tree);
    parallel_for(cut.roots.size(), 1, [&](uint64_t i) {
        sink.check();
        for (const uint32_t at : std::views::reverse(nodes_downwards(tree, cut.roots[i]))) visit(at);
    });
    for (const uint32_t at : std::views::reverse(cut.above)) visit(at);
}

} // namespace pertev
