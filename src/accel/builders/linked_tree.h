#pragma once

// A binary tree that subtrees are put into, with every box kept exact. Any way of putting them in ends in the same
// boxes.

#include <vector>

#include "accel/builders/binary_tree.h"

namespace pertev {

class LinkedTree {
public:
    explicit LinkedTree(BinaryTree tree);

    const BinaryNode& node(uint32_t index) const { return tree_.nodes[index]; }
    uint32_t root() const { return tree_.root; }
    uint32_t parent(uint32_t index) const { return parent_[index]; } // kNoLink: the root's, and of what is not linked
    BinaryTree take() { return std::move(tree_); }

    /// Puts `index`, which is not linked, beside `target`: the free node `parent` takes the target's place and both
    /// become its children.
    void insert(uint32_t index, uint32_t target, uint32_t parent);

private:
    void refit_upwards(uint32_t index);

    BinaryTree tree_;
    std::vector<uint32_t> parent_;
};

} // namespace pertev
