#pragma once

// A binary tree with insertion of subtrees that keeps every box exact. Boxes do not depend on the order of
// insertions.

#include <vector>

#include "accel/builders/binary_tree.h"

namespace pertev {

class LinkedTree {
public:
    explicit LinkedTree(BinaryTree tree);

    const BinaryNode& node(uint32_t index) const { return tree_.nodes[index]; }
    uint32_t root() const { return tree_.root; }
    uint32_t parent(uint32_t index) const { return parent_[index]; } // kNoLink for the root and for unlinked nodes
    BinaryTree take() { return std::move(tree_); }

    /// Inserts the node `index`, which has no parent, beside `target`: the free node `parent` takes the target's
    /// position and both become its children.
    void insert(uint32_t index, uint32_t target, uint32_t parent);

private:
    void refit_upwards(uint32_t index);

    BinaryTree tree_;
    std::vector<uint32_t> parent_;
};

} // namespace pertev
