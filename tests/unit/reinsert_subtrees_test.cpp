// The structure of trees after reinsertion. bvh_builders_test.cpp tests their quality.

#include "accel/builders/reinsert_subtrees.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

using namespace pertev;

TEST_CASE("boxes above a reinserted subtree grow even if its sibling's box does not") {
    // x is as large as x and s together, and as x and t: the joint over x has one box before and after its move to t.
    BinaryTree tree;
    const auto add_leaf = [&](Vec3 lower, Vec3 upper) {
        tree.references.push_back(static_cast<uint32_t>(tree.references.size()));
        tree.nodes.push_back(make_leaf({lower, upper}, tree.references.back()));
        return static_cast<uint32_t>(tree.nodes.size() - 1);
    };
    const auto join = [&](uint32_t left, uint32_t right) {
        tree.nodes.push_back(make_inner(tree, left, right));
        return static_cast<uint32_t>(tree.nodes.size() - 1);
    };
    const uint32_t x = add_leaf({0, 0, 0}, {10, 10, 0}), s = add_leaf({1, 1, 0}, {2, 2, 0}),
                   u = add_leaf({11, 1, 0}, {12, 2, 0}), t = add_leaf({0.5f, 0, 0}, {10, 9, 0}),
                   w = add_leaf({9, 0, 0}, {10.9f, 10, 0});
    const uint32_t near = join(join(join(x, s), u), join(t, w));
    std::vector<uint32_t> far; // an optimal row, which makes the tree large
    for (int i = 0; i < 256; ++i) {
        const float at = 1000 + static_cast<float>(i);
        far.push_back(add_leaf({at, 0, 0}, {at + 0.01f, 0.01f, 0}));
    }
    for (; far.size() > 1; far.resize(far.size() / 2)) {
        for (std::size_t i = 0; i < far.size() / 2; ++i) far[i] = join(far[2 * i], far[2 * i + 1]);
    }
    tree.root = join(near, far[0]);
    reinsert_subtrees(tree);
    const auto parent_of = [&](uint32_t child) {
        return std::ranges::find_if(tree.nodes, [&](const BinaryNode& node) {
            return !node.is_leaf() && (node.child[0] == child || node.child[1] == child);
        });
    };
    const BinaryNode& joint = *parent_of(x);
    CHECK((joint.child[0] == t || joint.child[1] == t));
    std::vector<uint32_t> pending = {tree.root};
    while (!pending.empty()) {
        const BinaryNode& node = tree.nodes[pending.back()];
        pending.pop_back();
        if (node.is_leaf()) continue;
        CHECK(node.box == make_inner(tree, node.child[0], node.child[1]).box);
        pending.insert(pending.end(), {node.child[0], node.child[1]});
    }
}
