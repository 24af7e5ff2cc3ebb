#include "accel/bvh/collapse_tree.h"

#include <algorithm>

#include "base/error.h"
#include "base/huge_pages.h"

namespace pertev {
namespace {

Bounds3 overlap(const Bounds3& a, const Bounds3& b) { return {max(a.lo, b.lo), min(a.hi, b.hi)}; }

uint32_t run_length(const std::vector<BvhTriangle>& triangles, uint32_t first) {
    uint32_t count = 1;
    for (uint32_t i = first; !(triangles[i].flags & kLastInLeaf); ++i) ++count;
    return count;
}

/// Box of a piece of a leaf: the bounds of its triangles within the leaf's box, which may be clipped.
Bounds3 piece_box(const std::vector<BvhTriangle>& triangles, uint32_t first, uint32_t count, const Bounds3& leaf) {
    Bounds3 box;
    for (uint32_t i = first; i < first + count; ++i) {
        box.extend(triangles[i].a);
        box.extend(triangles[i].b);
        box.extend(triangles[i].c);
    }
    box = overlap(box, leaf);
    return box.is_empty() ? leaf : box;
}

} // namespace

CollapsedTree::CollapsedTree(const Bvh& bvh, const CollapseSettings& settings, int width, Sink& sink)
    : settings_(settings), width_(width) {
    PERTEV_CHECK(width >= 2 && width <= kMaxWidth);
    PERTEV_CHECK(settings.max_leaf >= 1 && settings.triangles_at_once >= 1);
    PERTEV_CHECK(settings.node_cost >= 0 && settings.triangle_cost >= 0);
    if (bvh.root == kNoLink) return;
    add_subtrees(bvh, sink);
    join_runs(sink);
    plan(sink);
}

/// Adds subtrees in depth-first order, each left child right after its parent.
void CollapsedTree::add_subtrees(const Bvh& bvh, Sink& sink) {
    struct Pending {
        uint32_t link, count, parent; // parent is kNoLink for a left child and for the root
        Bounds3 box;
    };
    reserve_on_huge_pages(subtrees_, 2 * bvh.nodes.size() + 1);
    std::vector<Pending> pending = {{bvh.root, 0, kNoLink, bvh.bounds}};
    while (!pending.empty()) {
        Pending at = pending.back();
        pending.pop_back();
        const auto index = static_cast<uint32_t>(subtrees_.size());
        sink.check_at(index);
        if (at.parent != kNoLink) subtrees_[at.parent].right = index;
        Subtree& subtree = subtrees_.emplace_back();
        subtree.box = at.box;
        if (!(at.link & kLeafBit)) {
            const BvhNode& node = bvh.nodes[at.link];
            pending.push_back({node.child[1], 0, index, child_bounds(node, 1)});
            pending.push_back({node.child[0], 0, kNoLink, child_bounds(node, 0)});
            continue;
        }
        subtree.first = at.link & ~kLeafBit;
        subtree.count = at.count != 0 ? at.count : run_length(bvh.triangles, subtree.first);
        if (subtree.count <= static_cast<uint32_t>(settings_.max_leaf)) continue;
        const uint32_t first = subtree.first, half = subtree.count / 2, rest = subtree.count - half;
        pending.push_back(
            {kLeafBit | (first + half), rest, index, piece_box(bvh.triangles, first + half, rest, at.box)});
        pending.push_back({kLeafBit | first, half, kNoLink, piece_box(bvh.triangles, first, half, at.box)});
    }
}

/// Finds the subtrees that could be one leaf: few triangles that form one run. The builder may have swapped children.
void CollapsedTree::join_runs(Sink& sink) {
    const auto most = static_cast<uint32_t>(settings_.max_leaf);
    for (std::size_t i = subtrees_.size(); i-- > 0;) {
        sink.check_at(i);
        Subtree& subtree = subtrees_[i];
        if (subtree.right == 0) continue;
        const Subtree &left = subtrees_[i + 1], &right = subtrees_[subtree.right];
        const bool adjoin = left.first + left.count == right.first || right.first + right.count == left.first;
        const bool joined = left.count != 0 && right.count != 0 && adjoin && left.count + right.count <= most;
        subtree.first = joined ? min(left.first, right.first) : 0;
        subtree.count = joined ? left.count + right.count : 0;
    }
}

float CollapsedTree::leaf_cost(const CollapseSettings& settings, uint32_t count) {
    const auto step = static_cast<uint32_t>(settings.triangles_at_once);
    const uint32_t steps = (count + step - 1) / step;
    return settings.triangle_cost * static_cast<float>(steps);
}

void CollapsedTree::plan(Sink& sink) {
    plans_ = array_on_huge_pages<Plan>(subtrees_.size());
    std::vector<Costs> stack; // costs of subtrees whose parent comes later; a left child is on top of its sibling
    for (std::size_t i = subtrees_.size(); i-- > 0;) {
        sink.check_at(i);
        const auto index = static_cast<uint32_t>(i);
        if (subtrees_[i].right == 0) {
            stack.push_back(plan_subtree(index, nullptr, nullptr));
            continue;
        }
        const Costs left = stack.back();
        stack.pop_back();
        stack.back() = plan_subtree(index, &left, &stack.back());
    }
}

CollapsedTree::Costs CollapsedTree::plan_subtree(uint32_t index, const Costs* left, const Costs* right) {
    const Subtree& subtree = subtrees_[index];
    Plan& plan = plans_[index];
    // Areas are at most 2^84 and counts at most 2^31, so no sum of their products overflows.
    const float area = subtree.box.half_area();
    const float as_leaf = subtree.count != 0 ? area * leaf_cost(settings_, subtree.count) : kInfinity;
    Costs costs;
    if (left == nullptr) {
        plan.splits[0] = kLeaf;
        std::fill_n(costs.roots, kMaxWidth, as_leaf);
        return costs;
    }
    // Returns the least cost of exactly `roots` roots below this one, or fewer on a side that cannot have more.
    const auto distribute = [&](int roots) {
        float least = kInfinity;
        for (int k = 1; k < roots; ++k) {
            const float cost = left->roots[k] + right->roots[roots - k];
            if (k > 1 && !(cost < least)) continue;
            least = cost;
            plan.splits[roots] = static_cast<uint8_t>(k);
        }
        return least;
    };
    const float as_node = distribute(width_) + area * settings_.node_cost;
    plan.splits[0] = as_leaf <= as_node ? kLeaf : 0;
    costs.roots[1] = min(as_leaf, as_node);
    for (int i = 2; i < width_; ++i) {
        const float cost = distribute(i);
        if (cost > costs.roots[i - 1]) plan.splits[i] = kFewer; // if both cost the same, the shallower tree
        costs.roots[i] = min(cost, costs.roots[i - 1]);
    }
    return costs;
}

void CollapsedTree::expand(uint32_t subtree, int roots, uint32_t (&children)[kMaxWidth], int& count) const {
    const Plan& plan = plans_[subtree];
    while (roots > 1 && plan.splits[roots] == kFewer) --roots;
    if (roots == 1) {
        children[count++] = subtree;
        return;
    }
    const int left = plan.splits[roots];
    expand(subtree + 1, left, children, count);
    expand(subtrees_[subtree].right, roots - left, children, count);
}

int CollapsedTree::children_of(uint32_t subtree, uint32_t (&children)[kMaxWidth]) const {
    int count = 0;
    if (subtrees_[subtree].right == 0) { // only if the tree is one leaf, because the root is always a node
        children[count++] = subtree;
        return count;
    }
    const int left = plans_[subtree].splits[width_];
    expand(subtree + 1, left, children, count);
    expand(subtrees_[subtree].right, width_ - left, children, count);
    return count;
}

} // namespace pertev
