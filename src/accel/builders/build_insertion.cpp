// Incremental build: each triangle goes where it makes the boxes grow least. The order is scrambled, because in the
// order of the file neighbours follow each other and the first of them would shape the top of the tree.
//
// Source: Goldsmith, Salmon, "Automatic Creation of Object Hierarchies for Ray Tracing", IEEE CG&A 1987; branch and
// bound: Bittner, Hapala, Havran, "Incremental BVH Construction for Ray Tracing", Computers & Graphics 2015.

#include "accel/builders/build_bvh.h"
#include "accel/builders/builders.h"
#include "accel/builders/linked_tree.h"
#include "base/sort_until.h"

namespace pertev {
namespace {

constexpr int kMaxVisits = 2000; // nodes visited for one triangle; after that the best position so far is taken

uint32_t scramble_bits(uint32_t x) { // Wellons, "lowbias32", 2018: a bijection
    x = (x ^ (x >> 16)) * 0x7feb352du;
    x = (x ^ (x >> 15)) * 0x846ca68bu;
    return x ^ (x >> 16);
}

/// Returns a permutation of [0, count) that depends only on `count`.
std::vector<uint32_t> scramble(uint32_t count, Sink& sink) {
    std::vector<uint64_t> keys(count);
    for (uint32_t i = 0; i < count; ++i) keys[i] = static_cast<uint64_t>(scramble_bits(i)) << 32 | i;
    sort_until(std::span(keys), sink);
    std::vector<uint32_t> order(count);
    for (uint32_t i = 0; i < count; ++i) order[i] = static_cast<uint32_t>(keys[i]);
    return order;
}

class InsertionSearch {
public:
    explicit InsertionSearch(const LinkedTree& tree) : tree_(tree) {}

    /// Returns the node beside which a leaf with this box adds the least area, including the growth of all boxes
    /// above.
    uint32_t find(const Bounds3& box) {
        const float own = box.half_area();
        uint32_t best = tree_.root();
        float best_cost = kInfinity, best_growth = 0;
        pending_.clear();
        push(tree_.root(), 0);
        for (int visits = 0; !pending_.empty() && visits < kMaxVisits; ++visits) {
            std::pop_heap(pending_.begin(), pending_.end());
            const Pending at = pending_.back();
            pending_.pop_back();
            if (at.growth + own >= best_cost) break; // so have all others: no better position is left
            const BinaryNode& node = tree_.node(at.node);
            const float cost = at.growth + area_of_union(node.box, box);
            if (cost < best_cost) best_cost = cost, best_growth = at.growth, best = at.node;
            const float growth = cost - node.box.half_area();
            if (node.is_leaf() || growth + own >= best_cost) continue;
            push(node.child[0], growth);
            push(node.child[1], growth);
        }
        return descend_equals(box, best, best_cost, best_growth);
    }

private:
    /// Descends from a node while a child is an equally good position, to a pseudorandom side. Otherwise coincident
    /// triangles would form a chain.
    uint32_t descend_equals(const Bounds3& box, uint32_t at, float cost, float growth) {
        while (!tree_.node(at).is_leaf()) {
            const BinaryNode& node = tree_.node(at);
            growth += area_of_union(node.box, box) - node.box.half_area();
            bool equal[2];
            for (int k = 0; k < 2; ++k) {
                equal[k] = growth + area_of_union(tree_.node(node.child[k]).box, box) <= cost;
            }
            if (!equal[0] && !equal[1]) break;
            at = node.child[equal[0] && equal[1] ? scramble_bits(number_++) & 1 : (equal[0] ? 0 : 1)];
        }
        return at;
    }

    static float area_of_union(Bounds3 a, const Bounds3& b) {
        a.extend(b);
        return a.half_area();
    }

    struct Pending {
        float growth; // growth of the boxes above
        uint32_t number, node;
        bool operator<(const Pending& b) const {                               // the top of the heap is the greatest
            return growth != b.growth ? growth > b.growth : number < b.number; // for equal growth the deeper node,
                                                                               // which was added later
        }
    };

    void push(uint32_t node, float growth) {
        pending_.push_back({growth, number_++, node});
        std::push_heap(pending_.begin(), pending_.end());
    }

    const LinkedTree& tree_;
    std::vector<Pending> pending_; // a heap with the least growth on top
    uint32_t number_ = 0;
};

} // namespace

Bvh build_insertion_bvh(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings) {
    check_reference_count(triangles.size());
    if (triangles.empty()) return {};
    const auto count = static_cast<uint32_t>(triangles.size());
    const std::vector<BuildReference> references = references_of(triangles);
    BinaryTree leaves; // the first `count` nodes; inner nodes follow
    leaves.nodes.resize(2 * static_cast<std::size_t>(count) - 1);
    for (const uint32_t id : scramble(count, *settings.sink)) {
        const auto position = static_cast<uint32_t>(leaves.references.size());
        leaves.nodes[position] = make_leaf({references[id].lo, references[id].hi}, position);
        leaves.references.push_back(id);
    }
    leaves.root = 0;
    LinkedTree tree(std::move(leaves));
    InsertionSearch search(tree);
    for (uint32_t i = 1; i < count; ++i) {
        if (i % 1024 == 0) settings.sink->check();
        tree.insert(i, search.find(tree.node(i).box), count + i - 1);
    }
    return make_bvh(tree.take(), triangles, settings);
}

} // namespace pertev
