#include "accel/bvh/linked_tree.h"

namespace pertev {

LinkedTree::LinkedTree(BinaryTree tree) : tree_(std::move(tree)), parent_(tree_.nodes.size(), kNoLink) {
    if (tree_.root == kNoLink) return;
    std::vector<uint32_t> pending = {tree_.root};
    while (!pending.empty()) {
        const uint32_t at = pending.back();
        pending.pop_back();
        if (tree_.nodes[at].is_leaf()) continue;
        for (const uint32_t child : tree_.nodes[at].child) {
            parent_[child] = at;
            pending.push_back(child);
        }
    }
}

bool LinkedTree::is_beneath(uint32_t index, uint32_t ancestor) const {
    while (index != ancestor && index != kNoLink) index = parent_[index];
    return index == ancestor;
}

uint32_t LinkedTree::remove(uint32_t index) {
    const uint32_t free = parent_[index], other = sibling(index), above = parent_[free];
    area_change_ -= area(free);
    replace_child(above, free, other);
    parent_[index] = parent_[free] = kNoLink;
    refit_upwards(above);
    return free;
}

void LinkedTree::insert(uint32_t index, uint32_t target, uint32_t parent) {
    const uint32_t above = parent_[target];
    tree_.nodes[parent] = make_inner(tree_, target, index);
    area_change_ += area(parent);
    replace_child(above, target, parent);
    parent_[target] = parent_[index] = parent;
    refit_upwards(above);
}

void LinkedTree::replace_child(uint32_t parent, uint32_t old_child, uint32_t child) {
    parent_[child] = parent;
    if (parent == kNoLink) {
        tree_.root = child;
    } else {
        BinaryNode& node = tree_.nodes[parent];
        node.child[node.child[0] == old_child ? 0 : 1] = child;
    }
}

void LinkedTree::refit_upwards(uint32_t index) {
    for (; index != kNoLink; index = parent_[index]) {
        BinaryNode& node = tree_.nodes[index];
        const BinaryNode refitted = make_inner(tree_, node.child[0], node.child[1]);
        if (refitted.box == node.box) return; // nor does anything above change
        area_change_ -= area(index);
        node.box = refitted.box;
        area_change_ += area(index);
    }
}

} // namespace pertev
