#pragma once

// A binary tree that subtrees are taken out of and put into, with every box kept exact. Any way of putting them in ends
// in the same boxes, and its total area, which is what all inner nodes cost a ray, is followed along.

#include <vector>

#include "accel/bvh/binary_tree.h"

namespace pertev {

class LinkedTree {
public:
    explicit LinkedTree(BinaryTree tree);

    const BinaryNode& node(uint32_t index) const { return tree_.nodes[index]; }
    uint32_t root() const { return tree_.root; }
    uint32_t parent(uint32_t index) const { return parent_[index]; } // kNoLink: the root's, and of what is not linked
    uint32_t sibling(uint32_t index) const {
        const BinaryNode& parent = tree_.nodes[parent_[index]];
        return parent.child[parent.child[0] == index ? 1 : 0];
    }
    bool is_beneath(uint32_t index, uint32_t ancestor) const; // or the same
    const BinaryTree& tree() const { return tree_; }
    BinaryTree take() { return std::move(tree_); }

    /// Takes out a node that has a parent, with all beneath it; its sibling moves to where the parent was. Returns the
    /// parent, which is then free.
    uint32_t remove(uint32_t index);

    /// Puts `index`, which is not linked, beside `target`: the free node `parent` takes the target's place and both
    /// become its children.
    void insert(uint32_t index, uint32_t target, uint32_t parent);

    /// Sum of the changes of the half areas of inner nodes since the last call.
    double take_area_change() {
        const double change = area_change_;
        area_change_ = 0;
        return change;
    }

private:
    void replace_child(uint32_t parent, uint32_t old_child, uint32_t child);
    void refit_upwards(uint32_t index);
    double area(uint32_t index) const { return static_cast<double>(tree_.nodes[index].box.half_area()); }

    BinaryTree tree_;
    std::vector<uint32_t> parent_;
    double area_change_ = 0;
};

} // namespace pertev
