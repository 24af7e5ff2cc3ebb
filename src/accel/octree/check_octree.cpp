#include "accel/octree/check_octree.h"

#include <algorithm>
#include <atomic>
#include <vector>

#include <fmt/format.h>

#include "accel/clip_triangle.h"
#include "accel/octree/build_octree.h"
#include "accel/triangle_points.h"
#include "base/parallel_for.h"

namespace pertev {
namespace {

bool holds(const Bounds3& outer, const Bounds3& inner) {
    return min(outer.lo, inner.lo) == outer.lo && max(outer.hi, inner.hi) == outer.hi;
}

/// Whether the eight cells of a cell meet at its centre, and are as large as they should be, to the bit.
bool is_exact(const OctreeCell& cell, Vec3 corner) {
    const Bounds3 box = bounds_of(cell, corner);
    const Bounds3 low = bounds_of(cell.child(0), corner), high = bounds_of(cell.child(7), corner);
    const Vec3 side = {2 * cell.half, 2 * cell.half, 2 * cell.half};
    return low.lo == box.lo && high.hi == box.hi && low.hi == high.lo && low.hi == cell.centre(corner) &&
           box.hi - box.lo == side && cell.half > 0;
}

class OctreeChecker {
public:
    explicit OctreeChecker(const Octree& tree) : tree_(tree) {}

    std::optional<std::string> run() {
        if (tree_.nodes.empty()) {
            if (tree_.triangles.empty() && tree_.references.empty()) return std::nullopt;
            return "no node, but triangles or references";
        }
        if (!holds(bounds_of(root(), tree_.corner), tree_.bounds)) return "the root's cell does not hold the bounds";
        if (auto fault = check_structure()) return fault;
        std::atomic<uint64_t> first{tree_.triangles.size()};
        parallel_for(tree_.triangles.size(), 256, [&](uint64_t i) {
            if (is_covered(static_cast<uint32_t>(i))) return;
            uint64_t seen = first;
            while (i < seen && !first.compare_exchange_weak(seen, i)) {
            }
        });
        if (first == tree_.triangles.size()) return std::nullopt;
        return fmt::format("a part of triangle {} lies in no leaf that lists it", first.load());
    }

private:
    struct Pending {
        uint32_t node;
        int depth;
        OctreeCell cell;
    };

    OctreeCell root() const { return {0, 0, 0, 0.5f * tree_.side}; }

    std::optional<std::string> check_structure() {
        std::vector<bool> seen(tree_.nodes.size()), listed(tree_.references.size());
        std::vector<Pending> pending = {{0, 0, root()}};
        uint64_t nodes = 0, references = 0;
        int depth = 0;
        while (!pending.empty()) {
            const Pending at = pending.back();
            pending.pop_back();
            if (at.node >= tree_.nodes.size()) return fmt::format("a link to node {}", at.node);
            if (seen[at.node]) return fmt::format("node {} is reached twice", at.node);
            seen[at.node] = true;
            ++nodes;
            const OctreeNode& node = tree_.nodes[at.node];
            depth = std::max(depth, at.depth);
            if (node.is_leaf()) {
                if (uint64_t(node.first) + node.count() > listed.size())
                    return fmt::format("leaf {} runs past the end", at.node);
                for (uint32_t i = 0; i < node.count(); ++i) {
                    if (listed[node.first + i]) return fmt::format("leaf {} has another's references", at.node);
                    listed[node.first + i] = true;
                }
                references += node.count();
                if (auto fault = check_leaf(node, at)) return fault;
                continue;
            }
            if (at.depth >= kMaxOctreeDepth) return fmt::format("node {} is too deep", at.node);
            if (node.link == 0 || node.link > 0xff)
                return fmt::format("node {} has no children, or others than 8", at.node);
            if (!is_exact(at.cell, tree_.corner)) return fmt::format("node {} has a cell that is not exact", at.node);
            for (uint32_t k = 0; k < 8; ++k) {
                if (node.has_child(k)) pending.push_back({node.child(k), at.depth + 1, at.cell.child(k)});
            }
        }
        if (nodes != tree_.nodes.size()) return fmt::format("{} of {} nodes are reached", nodes, tree_.nodes.size());
        if (references != listed.size())
            return fmt::format("{} of {} references are in leaves", references, listed.size());
        if (depth != tree_.depth) return fmt::format("depth {}, stated {}", depth, tree_.depth);
        return std::nullopt;
    }

    std::optional<std::string> check_leaf(const OctreeNode& leaf, const Pending& at) const {
        const Bounds3 cell = bounds_of(at.cell, tree_.corner);
        for (uint32_t i = 0; i < leaf.count(); ++i) {
            const uint32_t* id = &tree_.references[leaf.first + i];
            if (*id >= tree_.triangles.size()) return fmt::format("leaf {} lists triangle {}", at.node, *id);
            if (i > 0 && id[-1] >= *id) return fmt::format("leaf {} is not in order", at.node);
            const Bounds3 box = bounds_of(tree_.triangles[*id]);
            const Bounds3 part = {max(box.lo, cell.lo), min(box.hi, cell.hi)};
            if (part.is_empty()) return fmt::format("leaf {} lists triangle {}, which is outside", at.node, *id);
        }
        return std::nullopt;
    }

    bool is_covered(uint32_t id) const {
        const BvhTriangle& triangle = tree_.triangles[id];
        if (!holds(tree_.bounds, bounds_of(triangle))) return false;
        for (int k = 0; k < kTrianglePoints; ++k) {
            if (!is_listed(id, triangle_point(triangle, k))) return false;
        }
        return true;
    }

    /// Whether the leaf at `p` lists the triangle; at a plane, whether one of the leaves there does.
    bool is_listed(uint32_t id, const TrianglePoint& p) const {
        const double slack = clip_slack(tree_.bounds.max_abs());
        std::vector<Pending> pending = {{0, 0, root()}};
        while (!pending.empty()) {
            const Pending at = pending.back();
            pending.pop_back();
            const OctreeNode& node = tree_.nodes[at.node];
            if (node.is_leaf()) {
                const auto first = tree_.references.begin() + node.first;
                if (std::binary_search(first, first + node.count(), id)) return true;
                continue;
            }
            const Vec3 centre = at.cell.centre(tree_.corner);
            for (uint32_t k = 0; k < 8; ++k) {
                bool is_here = node.has_child(k);
                for (int axis = 0; axis < 3; ++axis) {
                    const double from = p.at[axis] - static_cast<double>(component(centre, axis));
                    is_here = is_here && (k >> axis & 1 ? from >= -slack : from <= slack);
                }
                if (is_here) pending.push_back({node.child(k), 0, at.cell.child(k)});
            }
        }
        return false;
    }

    const Octree& tree_;
};

} // namespace

std::optional<std::string> find_fault(const Octree& tree) { return OctreeChecker(tree).run(); }

} // namespace pertev
