// Makes a finished tree better: subtrees are taken out and put back where the boxes grow least, for as long as that
// pays. Each move is made only if it lowers the sum of the areas of all inner nodes as the tree then is.
//
// Source: Bittner, Hapala, Havran, "Fast Insertion-Based Optimization of Bounding Volume Hierarchies", CGF 2013; the
// search from the node upwards: Meister, Bittner, "Parallel Reinsertion for Bounding Volume Hierarchy Optimization",
// CGF 2018. Threads search for a batch of nodes in the tree as it stands; the moves are then made in turn.

#include <algorithm>

#include "accel/bvh/build_bvh.h"
#include "accel/bvh/builders.h"
#include "accel/bvh/cut_triangle.h"
#include "accel/bvh/linked_tree.h"
#include "base/error.h"
#include "base/parallel_for.h"

namespace pertev {
namespace {

constexpr std::size_t kBatch = 2048; // fixed, so that nothing depends on the number of threads

double half_area(const Bounds3& box) { return static_cast<double>(box.half_area()); }

Bounds3 union_of(Bounds3 a, const Bounds3& b) {
    a.extend(b);
    return a;
}

/// The tree with one triangle a leaf, references by position. A triangle in a box that holds but a part of it stays in
/// it.
BinaryTree unfold(const Bvh& bvh) {
    BinaryTree tree;
    const std::vector<BuildReference> boxes = references_of(bvh.triangles);
    tree.references.resize(bvh.triangles.size());
    tree.nodes.reserve(2 * bvh.triangles.size());
    const auto add = [&](const BinaryNode& node) {
        tree.nodes.push_back(node);
        return static_cast<uint32_t>(tree.nodes.size() - 1);
    };
    const auto add_leaf = [&](uint32_t link, const Bounds3& box) {
        uint32_t sum = kNoLink;
        for (uint32_t i = link & ~kLeafBit;; ++i) {
            tree.references[i] = i;
            const Bounds3 part = intersection({boxes[i].lo, boxes[i].hi}, box);
            const uint32_t leaf = add(make_leaf(part.is_empty() ? box : part, i));
            sum = sum == kNoLink ? leaf : add(make_inner(tree, sum, leaf));
            if (bvh.triangles[i].flags & kLastInLeaf) return sum;
        }
    };
    if (bvh.root == kNoLink) return tree;
    if (bvh.root & kLeafBit) {
        tree.root = add_leaf(bvh.root, bvh.bounds);
        return tree;
    }
    // Depth first: children have greater numbers than their parents.
    std::vector<uint32_t> made(bvh.nodes.size());
    for (std::size_t i = bvh.nodes.size(); i-- > 0;) {
        const BvhNode& node = bvh.nodes[i];
        uint32_t child[2];
        for (int k = 0; k < 2; ++k) {
            const uint32_t link = node.child[k];
            child[k] = link & kLeafBit ? add_leaf(link, child_bounds(node, k)) : made[link];
        }
        made[i] = add(make_inner(tree, child[0], child[1]));
    }
    tree.root = made[0];
    return tree;
}

struct Move {
    uint32_t node = kNoLink, target = kNoLink;
    double gain = 0; // by how much areas shrink, other moves aside
};

/// Where a node had better be: branch and bound, from its own place upwards.
class MoveFinder {
public:
    MoveFinder(const LinkedTree& tree, uint32_t node)
        : tree_(tree), own_(half_area(tree.node(node).box)), box_(tree.node(node).box) {
        best_.node = node;
    }

    Move find() {
        // Taken out, its parent goes, and boxes above shrink up to `pivot`, the last that still holds both places.
        const uint32_t parent = tree_.parent(best_.node);
        double freed = half_area(tree_.node(parent).box);
        Bounds3 shrunk = tree_.node(tree_.sibling(best_.node)).box; // of what remains beneath the pivot
        search(tree_.sibling(best_.node), freed, true);
        for (uint32_t pivot = parent; tree_.parent(pivot) != kNoLink; pivot = tree_.parent(pivot)) {
            const uint32_t beside = tree_.sibling(pivot);
            search(beside, freed, false);
            shrunk.extend(tree_.node(beside).box);
            const uint32_t above = tree_.parent(pivot);
            freed += half_area(tree_.node(above).box) - half_area(shrunk);
            consider(above, freed - half_area(union_of(shrunk, box_)));
        }
        return best_;
    }

private:
    struct Pending {
        uint32_t node;
        double freed; // less the growth of what is above the node and below the pivot
    };

    void consider(uint32_t target, double gain) {
        if (gain > best_.gain) best_.gain = gain, best_.target = target;
    }

    /// Tries every node of a subtree, but for its root where that is where the node comes from.
    void search(uint32_t root, double freed, bool is_own_place) {
        pending_.clear();
        pending_.push_back({root, freed});
        while (!pending_.empty()) {
            const Pending at = pending_.back();
            pending_.pop_back();
            if (at.freed - own_ <= best_.gain) continue;
            const BinaryNode& node = tree_.node(at.node);
            const double with = half_area(union_of(node.box, box_));
            if (!is_own_place || at.node != root) consider(at.node, at.freed - with);
            const double freed_below = at.freed - (with - half_area(node.box));
            if (node.is_leaf() || freed_below - own_ <= best_.gain) continue;
            pending_.push_back({node.child[0], freed_below});
            pending_.push_back({node.child[1], freed_below});
        }
    }

    const LinkedTree& tree_;
    const double own_;
    const Bounds3 box_;
    Move best_;
    std::vector<Pending> pending_;
};

bool can_move(const LinkedTree& tree, uint32_t node) {
    return tree.parent(node) != kNoLink && tree.parent(tree.parent(node)) != kNoLink;
}

/// Makes the move if it still pays after those made before it; returns by how much.
double try_move(LinkedTree& tree, const Move& move) {
    if (move.target == kNoLink || !can_move(tree, move.node) || tree.is_beneath(move.target, move.node)) return 0;
    const uint32_t back = tree.sibling(move.node);
    if (move.target == back || move.target == tree.parent(move.node)) return 0;
    tree.take_area_change();
    tree.insert(move.node, move.target, tree.remove(move.node));
    const double change = tree.take_area_change();
    if (change < 0) return -change;
    tree.insert(move.node, back, tree.remove(move.node));
    return 0;
}

/// Nodes with the largest boxes first: there is most to gain.
std::vector<uint32_t> nodes_by_area(const LinkedTree& tree) {
    std::vector<uint32_t> nodes;
    for (uint32_t i = 0; i < tree.tree().nodes.size(); ++i) {
        if (can_move(tree, i)) nodes.push_back(i);
    }
    std::sort(nodes.begin(), nodes.end(), [&](uint32_t a, uint32_t b) {
        const float area_a = tree.node(a).box.half_area(), area_b = tree.node(b).box.half_area();
        return area_a != area_b ? area_a > area_b : a < b;
    });
    return nodes;
}

double total_area(const BinaryTree& tree) {
    double sum = 0;
    for (const BinaryNode& node : tree.nodes) sum += node.is_leaf() ? 0 : half_area(node.box);
    return sum;
}

} // namespace

Bvh optimise_bvh(const Bvh& bvh, const BvhBuildSettings& settings, const ReinsertionSettings& reinsertion) {
    PERTEV_CHECK(reinsertion.passes >= 0 && reinsertion.part > 0 && reinsertion.part <= 1);
    if (bvh.root == kNoLink) return {};
    LinkedTree tree(unfold(bvh));
    const float cost_before = cost_with_leaves(tree.tree(), settings);
    const double before = total_area(tree.tree());
    for (int pass = 0; pass < reinsertion.passes; ++pass) {
        std::vector<uint32_t> nodes = nodes_by_area(tree);
        nodes.resize(
            static_cast<std::size_t>(static_cast<double>(nodes.size()) * static_cast<double>(reinsertion.part)));
        double gain = 0;
        for (std::size_t begin = 0; begin < nodes.size(); begin += kBatch) {
            std::vector<Move> moves(std::min(kBatch, nodes.size() - begin));
            parallel_for(moves.size(), 16, [&](uint64_t i) {
                if (can_move(tree, nodes[begin + i])) moves[i] = MoveFinder(tree, nodes[begin + i]).find();
            });
            std::stable_sort(moves.begin(), moves.end(), [](const Move& a, const Move& b) { return a.gain > b.gain; });
            for (const Move& move : moves) gain += try_move(tree, move);
        }
        if (gain <= static_cast<double>(reinsertion.min_gain) * before) break;
    }
    // The sum of all areas is not quite what leaves of several triangles cost.
    const bool better = cost_with_leaves(tree.tree(), settings) < cost_before;
    return make_bvh(better ? tree.take() : unfold(bvh), bvh.triangles, settings);
}

} // namespace pertev
