#include "accel/builders/linked_tree.h"

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

void LinkedTree::insert(uint32_t index, uint32_t target, uint32_t parent) {
    const uint32_t above = parent_[target];
    tree_.nodes[parent] = make_inner(tree_, target, index);
    replace_child(tree_, parent_, above, target, parent);
    parent_[target] = parent_[index] = parent;
    refit_upwards(above);
}

void LinkedTree::refit_upwards(uint32_t index) {
    for (; index != kNoLink; index = parent_[index]) {
        BinaryNode& node = tree_.nodes[index];
        const BinaryNode refitted = make_inner(tree_, node.child[0], node.child[1]);
        if (refitted.box == node.box) return; // boxes above do not change either
        node.box = refitted.box;
    }
}

} // namespace pertev
