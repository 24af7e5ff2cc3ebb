#pragma once

// The recursion of top-down builders: splits a set of boxes in two until each box is alone. Each builder defines how
// to split.

#include <cstdint>

#include "accel/builders/binary_tree.h"
#include "base/limits.h"
#include "base/parallel_for.h"

namespace pertev {

/// Builds a tree with the splits of `Cuts`, which holds references by position:
///   uint32_t cut(begin, end)              reorders positions [begin, end), at least two, and returns the start of the
///                                         second half: begin < middle < end
///   uint32_t halve(begin, end)            like cut(), but in the middle of the range
///   const BuildReference& at(position)    the reference there, once it is alone
/// Disjoint ranges are split in parallel. A range that could run out of levels is halved.
template <class Cuts>
class TopDownBuilder {
public:
    TopDownBuilder(Cuts& cuts, uint32_t count, Sink& sink) : cuts_(cuts), count_(count), sink_(sink) {}

    BinaryTree build() {
        if (count_ == 0) return {};
        tree_.nodes.resize(2 * static_cast<std::size_t>(count_) - 1);
        tree_.references.resize(count_);
        tree_.root = 0;
        build_range(0, count_, 0, 0);
        return std::move(tree_);
    }

private:
    static constexpr uint32_t kParallelSubtree = 1u << 12; // from this many references on, both halves are built in
                                                           // parallel

    /// Builds the subtree over positions [begin, end) in nodes [slot, slot + 2 (end - begin) - 1), so that threads need
    /// no common counter.
    void build_range(uint32_t begin, uint32_t end, uint32_t slot, int depth) {
        const uint32_t size = end - begin;
        if (size == 1) {
            const BuildReference& reference = cuts_.at(begin);
            tree_.references[begin] = reference.id;
            tree_.nodes[slot] = make_leaf({reference.lo, reference.hi}, begin);
            return;
        }
        const bool short_of_levels = levels_needed(size) >= kMaxBvhDepth - depth;
        const uint32_t middle = short_of_levels ? cuts_.halve(begin, end) : cuts_.cut(begin, end);
        const uint32_t left = slot + 1, right = slot + 2 * (middle - begin);
        const auto build_left = [&] { build_range(begin, middle, left, depth + 1); };
        const auto build_right = [&] { build_range(middle, end, right, depth + 1); };
        if (size >= kParallelSubtree) {
            sink_.check();
            parallel_invoke(build_left, build_right);
        } else {
            build_left();
            build_right();
        }
        tree_.nodes[slot] = make_inner(tree_, left, right);
    }

    Cuts& cuts_;
    uint32_t count_;
    Sink& sink_;
    BinaryTree tree_;
};

} // namespace pertev
