#pragma once

// Parts that the checkers of the kd-tree and the octree share: checks of a leaf's list, and whether each triangle is
// in the list of each cell that it touches.

#include <atomic>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include <fmt/format.h>

#include "accel/clip_triangle.h"
#include "base/parallel_for.h"
#include "tests/support/triangle_points.h"

namespace pertev {

inline bool holds(const Bounds3& outer, const Bounds3& inner) {
    return min(outer.lo, inner.lo) == outer.lo && max(outer.hi, inner.hi) == outer.hi;
}

/// Checks the list of leaf `node` with cell `cell`: ids are in range and ascend, and boxes of the triangles overlap
/// the cell. Returns the fault, if any.
inline std::optional<std::string> find_list_fault(std::span<const uint32_t> list,
                                                  std::span<const BvhTriangle> triangles, const Bounds3& cell,
                                                  uint32_t node) {
    for (std::size_t i = 0; i < list.size(); ++i) {
        const uint32_t id = list[i];
        if (id >= triangles.size()) return fmt::format("leaf {} lists triangle {}", node, id);
        if (i > 0 && list[i - 1] >= id) return fmt::format("leaf {} is not in order", node);
        const Bounds3 box = bounds_of(triangles[id]);
        const Bounds3 part = {max(box.lo, cell.lo), min(box.hi, cell.hi)};
        if (part.is_empty()) return fmt::format("leaf {} lists triangle {}, which is outside", node, id);
    }
    return std::nullopt;
}

/// Returns the first triangle with a point that is outside the bounds or for which is_listed(id, TrianglePoint) is
/// false.
template <class IsListed>
std::optional<std::string> find_uncovered(std::span<const BvhTriangle> triangles, const Bounds3& bounds,
                                          const IsListed& is_listed) {
    const auto is_covered = [&](uint32_t id) {
        if (!holds(bounds, bounds_of(triangles[id]))) return false;
        for (int k = 0; k < kTrianglePoints; ++k) {
            if (!is_listed(id, triangle_point(triangles[id], k))) return false;
        }
        return true;
    };
    std::atomic<uint64_t> first{triangles.size()};
    parallel_for(triangles.size(), 256, [&](uint64_t i) {
        if (is_covered(static_cast<uint32_t>(i))) return;
        uint64_t seen = first;
        while (i < seen && !first.compare_exchange_weak(seen, i)) {
        }
    });
    if (first == triangles.size()) return std::nullopt;
    return fmt::format("a part of triangle {} lies in no leaf that lists it", first.load());
}

/// Checks a tree by its own check_structure() and find_uncovered.
template <class Tree, class CheckStructure, class IsListed>
std::optional<std::string> find_fault_of(const Tree& tree, const CheckStructure& check_structure,
                                         const IsListed& is_listed) {
    if (tree.nodes.empty()) {
        if (tree.triangles.empty() && tree.references.empty()) return std::nullopt;
        return "no node, but triangles or references";
    }
    if (auto fault = check_structure()) return fault;
    return find_uncovered(tree.triangles, tree.bounds, is_listed);
}

/// Returns which of a traversal's counts differs from the tree's.
template <class Tree>
std::optional<std::string> find_unreached(const Tree& tree, uint64_t nodes, uint64_t references, int depth) {
    if (nodes != tree.nodes.size()) return fmt::format("{} of {} nodes are reached", nodes, tree.nodes.size());
    if (references != tree.references.size()) {
        return fmt::format("{} of {} references are in leaves", references, tree.references.size());
    }
    if (depth != tree.depth) return fmt::format("depth {}, stated {}", depth, tree.depth);
    return std::nullopt;
}

} // namespace pertev
