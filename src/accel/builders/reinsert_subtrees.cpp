#include "accel/builders/reinsert_subtrees.h"

#include <algorithm>
#include <atomic>

#include "accel/builders/visit_upwards.h"
#include "base/parallel_for.h"
#include "base/parallel_until.h"

namespace pertev {
namespace {

constexpr std::size_t kWorthAnother = 64;    // no further round if fewer than one in this many moves was made
constexpr std::size_t kFewChanges = 64;      // if fewer than one in this many nodes changed, their boxes are refitted
                                             // one by one
constexpr uint64_t kReinsertChunk = 1 << 12; // nodes; fixed, so that no sum depends on the number of threads

float area_of_both(const Bounds3& a, const Bounds3& b) {
    const Vec3 d = max(a.hi, b.hi) - min(a.lo, b.lo);
    return d.x * d.y + d.y * d.z + d.z * d.x;
}

struct Move {
    uint32_t node = kNoLink, target = kNoLink; // the node becomes the target's sibling; kNoLink: it stays
    uint32_t pivot = kNoLink;                  // the lowest common ancestor of both
    float gain = 0;                            // reduction of the sum of areas if no other move is made
};

class Reinserter {
public:
    Reinserter(BinaryTree& tree, Sink& sink)
        : nodes_(tree.nodes), tree_(tree), sink_(sink), parent_(tree.nodes.size(), kNoLink), own_(tree.nodes.size()),
          lock_(tree.nodes.size()) {
        visit_upwards(tree, sink, [&](uint32_t at) {
            if (nodes_[at].is_leaf()) return;
            for (const uint32_t child : nodes_[at].child) parent_[child] = at;
        });
    }

    double total_area() const {
        std::vector<double> parts(chunk_count());
        parallel_for(parts.size(), 1, [&](uint64_t chunk) {
            for_chunk(chunk, [&](uint32_t at) {
                if (is_linked(at) && !nodes_[at].is_leaf()) parts[chunk] += static_cast<double>(area(at));
            });
        });
        double sum = 0;
        for (const double part : parts) sum += part;
        return sum;
    }

    /// Tries to move about the fraction `part` of the nodes, those with the largest boxes, because they have the most
    /// to gain. Nodes whose move is blocked by moves with a higher gain are tried again as long as enough of them
    /// succeed.
    void pass(float part) {
        std::vector<uint32_t> nodes = largest_nodes(part);
        while (!nodes.empty()) {
            const std::size_t made = round(nodes);
            if (made * kWorthAnother < nodes.size()) return;
        }
    }

private:
    std::size_t chunk_count() const { return (nodes_.size() + kReinsertChunk - 1) / kReinsertChunk; }
    template <class Body>
    void for_chunk(uint64_t chunk, const Body& body) const {
        const auto end = static_cast<uint32_t>(std::min<uint64_t>(nodes_.size(), (chunk + 1) * kReinsertChunk));
        for (auto at = static_cast<uint32_t>(chunk * kReinsertChunk); at < end; ++at) body(at);
    }

    float area(uint32_t at) const { return nodes_[at].box.half_area(); }
    bool is_linked(uint32_t at) const { return at == tree_.root || parent_[at] != kNoLink; }
    bool can_move(uint32_t at) const { return parent_[at] != kNoLink && parent_[parent_[at]] != kNoLink; }
    uint32_t sibling(uint32_t at) const {
        const BinaryNode& parent = nodes_[parent_[at]];
        return parent.child[parent.child[0] == at ? 1 : 0];
    }

    /// Makes the moves of `nodes` that no better move conflicts with, and leaves the blocked ones in `nodes`. Returns
    /// the number of moves made.
    std::size_t round(std::vector<uint32_t>& nodes) {
        std::vector<Move> moves(nodes.size());
        parallel_until(nodes.size(), 64, sink_, [&](uint64_t i) {
            if (can_move(nodes[i])) moves[i] = find_move(nodes[i]);
        });
        std::erase_if(moves, [](const Move& move) { return move.target == kNoLink; });
        parallel_until(moves.size(), kReinsertChunk, sink_, [&](uint64_t i) {
            own_[moves[i].node] = key_of(moves[i]);
            for_each_link(moves[i], [&](uint32_t at) { raise(lock_[at], key_of(moves[i])); });
        });
        std::vector<uint8_t> is_first(moves.size());
        parallel_for(moves.size(), kReinsertChunk, [&](uint64_t i) { is_first[i] = is_made(moves[i]) ? 1 : 0; });
        parallel_for(moves.size(), kReinsertChunk, [&](uint64_t i) {
            own_[moves[i].node] = 0;
            for_each_link(moves[i], [&](uint32_t at) { lock_[at].store(0, std::memory_order_relaxed); });
        });
        nodes.clear();
        std::vector<uint32_t> changed; // nodes whose children changed
        for (std::size_t i = 0; i < moves.size(); ++i) {
            sink_.check_at(i);
            if (is_first[i] == 0) {
                nodes.push_back(moves[i].node);
            } else {
                const uint32_t joint = parent_[moves[i].node];
                changed.insert(changed.end(), {parent_[joint], joint, parent_[moves[i].target]});
                make(moves[i]);
            }
        }
        refit(changed);
        return changed.size() / 3;
    }

    void refit_node(uint32_t at) { nodes_[at] = make_inner(tree_, nodes_[at].child[0], nodes_[at].child[1]); }

    /// Updates boxes from the nodes whose children changed upwards. `changed` lists these nodes, and kNoLink.
    void refit(const std::vector<uint32_t>& changed) {
        if (changed.size() > nodes_.size() / kFewChanges) {
            return visit_upwards(tree_, sink_, [&](uint32_t at) {
                if (!nodes_[at].is_leaf()) refit_node(at);
            });
        }
        for (uint32_t at : changed) {
            for (; at != kNoLink; at = parent_[at]) {
                const Bounds3 before = nodes_[at].box;
                refit_node(at);
                if (nodes_[at].box == before) break; // further changes above are refitted from another node
            }
        }
    }

    std::vector<uint32_t> largest_nodes(float part) const {
        // The bits of a non-negative float sort like its value; the upper half suffices to rank areas.
        std::vector<std::atomic<uint32_t>> counts(1 << 16);
        parallel_for(chunk_count(), 1, [&](uint64_t chunk) {
            for_chunk(chunk, [&](uint32_t at) {
                if (can_move(at)) counts[bits_of(area(at)) >> 16].fetch_add(1, std::memory_order_relaxed);
            });
        });
        auto wanted = static_cast<int64_t>(static_cast<double>(part) * static_cast<double>(nodes_.size()));
        uint32_t least = 1 << 16;
        while (least > 0 && wanted > 0) wanted -= counts[--least].load(std::memory_order_relaxed);
        std::vector<std::vector<uint32_t>> parts(chunk_count());
        parallel_for(parts.size(), 1, [&](uint64_t chunk) {
            for_chunk(chunk, [&](uint32_t at) {
                if (can_move(at) && bits_of(area(at)) >> 16 >= least) parts[chunk].push_back(at);
            });
        });
        std::vector<uint32_t> nodes;
        for (const auto& some : parts) nodes.insert(nodes.end(), some.begin(), some.end());
        return nodes;
    }

    /// Finds the best position for a node by branch and bound, from its present position upwards.
    Move find_move(uint32_t node) const {
        Move best = {.node = node};
        const Bounds3 box = nodes_[node].box;
        // Removing the node removes its parent, and boxes shrink up to the pivot, which holds both positions.
        const uint32_t parent = parent_[node];
        float freed = area(parent);
        Bounds3 shrunk = nodes_[sibling(node)].box; // box of the rest below the pivot
        search(sibling(node), parent, freed, box, true, best);
        for (uint32_t below = parent; parent_[below] != kNoLink; below = parent_[below]) {
            const uint32_t beside = sibling(below), pivot = parent_[below];
            search(beside, pivot, freed, box, false, best);
            shrunk.extend(nodes_[beside].box);
            freed += area(pivot) - shrunk.half_area();
            consider(pivot, parent_[pivot], freed - area_of_both(shrunk, box), best);
        }
        return best;
    }

    static void consider(uint32_t target, uint32_t pivot, float gain, Move& best) {
        if (gain > best.gain) best.gain = gain, best.target = target, best.pivot = pivot;
    }

    /// Tries every node of a subtree, except its root if the node comes from there. `freed` is the area saved so far,
    /// minus the growth of boxes above the node and below the pivot.
    void search(uint32_t root, uint32_t pivot, float freed, const Bounds3& box, bool is_own_position,
                Move& best) const {
        struct Pending {
            uint32_t node;
            float freed;
        };
        Pending pending[2 * kStack];
        int count = 0;
        const float own = box.half_area();
        pending[count++] = {root, freed};
        while (count > 0) {
            const Pending at = pending[--count];
            if (at.freed - own <= best.gain) continue;
            const BinaryNode& node = nodes_[at.node];
            const float with = area_of_both(node.box, box);
            if (!is_own_position || at.node != root) consider(at.node, pivot, at.freed - with, best);
            const float below = at.freed - (with - node.box.half_area());
            if (node.is_leaf() || below - own <= best.gain || count + 2 > 2 * kStack) continue;
            pending[count++] = {node.child[0], below};
            pending[count++] = {node.child[1], below};
        }
    }

    /// Sort key of a move: unique, and greater for greater gains.
    static uint64_t key_of(const Move& move) { return static_cast<uint64_t>(bits_of(move.gain)) << 32 | ~move.node; }

    static void raise(std::atomic<uint64_t>& lock, uint64_t key) {
        uint64_t old = lock.load(std::memory_order_relaxed);
        while (old < key && !lock.compare_exchange_weak(old, key, std::memory_order_relaxed)) {
        }
    }

    /// Calls body for the nodes whose links or parents a move changes.
    template <class Body>
    void for_each_link(const Move& move, const Body& body) const {
        const uint32_t parent = parent_[move.node];
        for (const uint32_t at : {move.node, parent, parent_[parent], sibling(move.node), move.target}) body(at);
        if (parent_[move.target] != kNoLink) body(parent_[move.target]);
    }

    /// Returns whether the move has the highest gain among moves that change the same links and among moves of an
    /// ancestor of its target. Without the second condition a could move below b while b moves below a.
    bool is_made(const Move& move) const {
        const uint64_t key = key_of(move);
        bool is_first = true;
        for_each_link(move,
                      [&](uint32_t at) { is_first = is_first && lock_[at].load(std::memory_order_relaxed) == key; });
        for (uint32_t at = move.target; is_first && at != move.pivot && at != kNoLink; at = parent_[at]) {
            is_first = own_[at] < key;
        }
        return is_first;
    }

    void make(const Move& move) {
        const uint32_t joint = parent_[move.node];
        replace_child(tree_, parent_, parent_[joint], joint, sibling(move.node));
        replace_child(tree_, parent_, parent_[move.target], move.target, joint);
        nodes_[joint].child[0] = move.target, nodes_[joint].child[1] = move.node;
        parent_[move.target] = joint;
    }

    static constexpr int kStack = 256;

    std::vector<BinaryNode>& nodes_;
    BinaryTree& tree_;
    Sink& sink_;
    std::vector<uint32_t> parent_;
    std::vector<uint64_t> own_;               // [node] key of its own move in this round, else 0
    std::vector<std::atomic<uint64_t>> lock_; // [node] highest key of the moves that change its links, else 0
};

} // namespace

void reinsert_subtrees(BinaryTree& tree, const ReinsertionSettings& settings, Sink& sink) {
    if (tree.root == kNoLink) return;
    Reinserter reinserter(tree, sink);
    double before = reinserter.total_area();
    const double enough = static_cast<double>(settings.min_gain) * before;
    for (int pass = 0; pass < settings.passes; ++pass) {
        reinserter.pass(settings.part);
        const double after = reinserter.total_area();
        if (before - after <= enough) break;
        before = after;
    }
}

} // namespace pertev
