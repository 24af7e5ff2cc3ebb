#pragma once

// Visits every node of a binary tree after its children, on all threads: subtrees beneath a fixed cut at once, then
// what is above it. What a visit reads of its children is there; nothing depends on the number of threads.

#include <cstdint>
#include <ranges>
#include <vector>

#include "accel/builders/binary_tree.h"
#include "base/parallel_for.h"

namespace pertev {

/// A tree cut across: nodes above the cut, each before its children, and the roots of all subtrees beneath.
struct CrossCut {
    std::vector<uint32_t> above, roots;
};

/// Breadth first, until there are enough subtrees to share out, which small trees are not worth.
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

/// The nodes of a subtree, each before its children.
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

/// Calls visit(node) for every node that can be reached, children first.
template <class Visit>
void visit_upwards(const BinaryTree& tree, const Visit& visit) {
    const CrossCut cut = cut_across(tree);
    parallel_for(cut.roots.size(), 1, [&](uint64_t i) {
        for (const uint32_t at : std::views::reverse(nodes_downwards(tree, cut.roots[i]))) visit(at);
    });
    for (const uint32_t at : std::views::reverse(cut.above)) visit(at);
}

} // namespace pertev
