#include "accel/builders/binary_tree.h"

#include <algorithm>
#include <ranges>

#include <fmt/format.h>

#include "accel/builders/visit_upwards.h"
#include "base/error.h"
#include "base/huge_pages.h"
#include "base/limits.h"

namespace pertev {
namespace {

/// Links `leaves` by object medians along the longest side, with inner nodes from `free` in their order.
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

/// Collects the triangles below a node, each once, in ascending order.
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
    float cost = 0;     // SAH cost times the half area of the root
    uint32_t size = 0;  // triangles in the leaves below
    uint32_t inner = 0; // inner nodes of the subtree, itself included; 0 if it becomes a leaf
    int depth = 0;      // inner nodes on the longest path down

    bool is_leaf() const { return inner == 0; }
};

/// Decides from the bottom up which subtrees become leaves: those for which a leaf costs no more.
std::vector<NodeSummary> choose_leaves(const BinaryTree& tree, const BvhBuildSettings& settings) {
    const auto max_leaf = static_cast<std::size_t>(settings.max_leaf);
    std::vector<NodeSummary> summaries(tree.nodes.size());
    visit_upwards(tree, *settings.sink, [&](uint32_t at) {
        thread_local std::vector<uint32_t> held;
        const BinaryNode& node = tree.nodes[at];
        NodeSummary& summary = summaries[at];
        const float area = node.box.half_area();
        if (!node.is_leaf()) {
            const NodeSummary &left = summaries[node.child[0]], &right = summaries[node.child[1]];
            summary = {settings.node_cost * area + left.cost + right.cost, left.size + right.size,
                       left.inner + right.inner + 1, 1 + std::max(left.depth, right.depth)};
            // Spatial splits often give a subtree a triangle twice, but seldom three times.
            if (summary.size > 2 * max_leaf) return;
        }
        collect_references(tree, at, held);
        const float cost = settings.leaf_cost * static_cast<float>(held.size()) * area;
        if (!node.is_leaf() && (held.size() > max_leaf || cost > summary.cost)) return;
        summary = {cost, static_cast<uint32_t>(held.size()), 0, 0};
    });
    return summaries;
}

/// Copies nodes and triangles to depth-first order, each node before its first child. The sizes of subtrees determine
/// all positions, so subtrees are copied in parallel.
class Flattener {
public:
    Flattener(const BinaryTree& tree, const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings)
        : tree_(tree), triangles_(triangles), summaries_(choose_leaves(tree, settings)), sink_(*settings.sink) {}

    Bvh run() {
        const BinaryNode& root = tree_.nodes[tree_.root];
        const NodeSummary& summary = summaries_[tree_.root];
        bvh_.bounds = root.box;
        bvh_.nodes = array_on_huge_pages<BvhNode>(summary.inner);
        bvh_.triangles = array_on_huge_pages<BvhTriangle>(summary.size);
        bvh_.root = link_of({tree_.root, 0, 0});
        bvh_.depth = summary.depth;
        bvh_.sah_cost = summary.cost / max(root.box.half_area(), 0x1p-126f);
        // Breadth first until there are enough subtrees to share among threads.
        constexpr std::size_t kSubtrees = 2048;
        std::vector<NodeSlot> level = {{tree_.root, 0, 0}};
        while (!level.empty() && level.size() < kSubtrees) {
            std::vector<NodeSlot> next;
            for (const NodeSlot& at : level) copy(at, next);
            level = std::move(next);
        }
        parallel_for(level.size(), 1, [&](uint64_t i) {
            sink_.check();
            std::vector<NodeSlot> pending = {level[i]};
            while (!pending.empty()) {
                const NodeSlot at = pending.back();
                pending.pop_back();
                copy(at, pending);
            }
        });
        return std::move(bvh_);
    }

private:
    struct NodeSlot {
        uint32_t from, node, triangle; // positions of its first node and first triangle
    };

    uint32_t link_of(const NodeSlot& at) const {
        return summaries_[at.from].is_leaf() ? kLeafBit | at.triangle : at.node;
    }

    float surface_by_size(const BinaryNode& node, int k, int other) const {
        return tree_.nodes[node.child[k]].box.half_area() * static_cast<float>(summaries_[node.child[other]].size);
    }

    /// Copies a leaf, or an inner node whose children are then appended to `pending`.
    void copy(const NodeSlot& at, std::vector<NodeSlot>& pending) {
        if (summaries_[at.from].is_leaf()) return copy_leaf(at);
        const BinaryNode& node = tree_.nodes[at.from];
        // Child 0 is the one where a ray finds a hit sooner: more surface per triangle, as in build_tree.
        const int first = surface_by_size(node, 0, 1) >= surface_by_size(node, 1, 0) ? 0 : 1;
        const NodeSummary& of_first = summaries_[node.child[first]];
        const NodeSlot slots[2] = {{node.child[first], at.node + 1, at.triangle},
                                   {node.child[1 - first], at.node + 1 + of_first.inner, at.triangle + of_first.size}};
        for (int k = 0; k < 2; ++k) {
            set_child(bvh_.nodes[at.node], k, tree_.nodes[slots[k].from].box, link_of(slots[k]));
            pending.push_back(slots[k]);
        }
    }

    void copy_leaf(const NodeSlot& at) {
        thread_local std::vector<uint32_t> held;
        collect_references(tree_, at.from, held);
        for (std::size_t i = 0; i < held.size(); ++i) {
            BvhTriangle t = triangles_[held[i]];
            t.flags = i + 1 == held.size() ? t.flags | kLastInLeaf : t.flags & ~kLastInLeaf;
            bvh_.triangles[at.triangle + i] = t;
        }
    }

    const BinaryTree& tree_;
    const std::vector<BvhTriangle>& triangles_;
    const std::vector<NodeSummary> summaries_;
    Sink& sink_;
    Bvh bvh_;
};

/// Number of inner nodes on the longest path down.
int depth_of(const BinaryTree& tree, Sink& sink) {
    std::vector<int> depth(tree.nodes.size());
    visit_upwards(tree, sink, [&](uint32_t at) {
        const BinaryNode& node = tree.nodes[at];
        depth[at] = node.is_leaf() ? 0 : 1 + std::max(depth[node.child[0]], depth[node.child[1]]);
    });
    return depth[tree.root];
}

} // namespace

void check_reference_count(uint64_t count) {
    if (count <= kMaxBvhTriangles) return;
    throw Error(ErrorCode::OverLimit,
                fmt::format("{} triangles in one tree; the limit is {}", count, kMaxBvhTriangles));
}

void limit_depth(BinaryTree& tree, int max_depth, Sink& sink) {
    if (tree.root == kNoLink || depth_of(tree, sink) <= max_depth) return;
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
        } else { // its children have enough levels for object medians
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
    limit_depth(tree, kMaxBvhDepth, *settings.sink);
    return Flattener(tree, triangles, settings).run();
}

} // namespace pertev
