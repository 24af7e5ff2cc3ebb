#include "accel/kd_tree/check_kd_tree.h"

#include <algorithm>
#include <atomic>
#include <vector>

#include <fmt/format.h>

#include "accel/clip_triangle.h"
#include "accel/triangle_points.h"
#include "base/parallel_for.h"

namespace pertev {
namespace {

bool holds(const Bounds3& outer, const Bounds3& inner) {
    return min(outer.lo, inner.lo) == outer.lo && max(outer.hi, inner.hi) == outer.hi;
}

class KdTreeChecker {
public:
    explicit KdTreeChecker(const KdTree& tree) : tree_(tree) {}

    std::optional<std::string> run() const {
        if (tree_.nodes.empty()) {
            if (tree_.triangles.empty() && tree_.references.empty()) return std::nullopt;
            return "no node, but triangles or references";
        }
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
        Bounds3 cell;
    };

    std::optional<std::string> check_structure() const {
        std::vector<Pending> pending = {{0, 0, tree_.bounds}};
        uint64_t nodes = 0, references = 0;
        int depth = 0;
        while (!pending.empty()) { // in the order in which nodes and references are stored
            const Pending at = pending.back();
            pending.pop_back();
            if (at.node != nodes++) return fmt::format("node {} is not where the walk expects it", at.node);
            if (at.node >= tree_.nodes.size()) return fmt::format("a link to node {}", at.node);
            const KdTreeNode& node = tree_.nodes[at.node];
            depth = std::max(depth, at.depth);
            if (node.is_leaf()) {
                if (node.first() != references) return fmt::format("leaf {} has not the next references", at.node);
                references += node.count();
                if (references > tree_.references.size()) return fmt::format("leaf {} runs past the end", at.node);
                if (auto fault = check_leaf(node, at)) return fault;
                continue;
            }
            if (at.depth >= kMaxKdTreeDepth) return fmt::format("node {} is too deep", at.node);
            const float lo = component(at.cell.lo, node.axis()), hi = component(at.cell.hi, node.axis());
            if (!(node.plane() > lo && node.plane() < hi)) return fmt::format("node {} cuts outside it", at.node);
            pending.push_back({node.above(), at.depth + 1, cell_above(at.cell, node.axis(), node.plane())});
            pending.push_back({at.node + 1, at.depth + 1, cell_below(at.cell, node.axis(), node.plane())});
        }
        if (nodes != tree_.nodes.size()) return fmt::format("{} of {} nodes are reached", nodes, tree_.nodes.size());
        if (references != tree_.references.size()) {
            return fmt::format("{} of {} references are in leaves", references, tree_.references.size());
        }
        if (depth != tree_.depth) return fmt::format("depth {}, stated {}", depth, tree_.depth);
        return std::nullopt;
    }

    std::optional<std::string> check_leaf(const KdTreeNode& leaf, const Pending& at) const {
        for (uint32_t i = 0; i < leaf.count(); ++i) {
            const uint32_t* id = &tree_.references[leaf.first() + i];
            if (*id >= tree_.triangles.size()) return fmt::format("leaf {} lists triangle {}", at.node, *id);
            if (i > 0 && id[-1] >= *id) return fmt::format("leaf {} is not in order", at.node);
            const Bounds3 box = bounds_of(tree_.triangles[*id]);
            const Bounds3 part = {max(box.lo, at.cell.lo), min(box.hi, at.cell.hi)};
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
        std::vector<uint32_t> pending = {0};
        while (!pending.empty()) {
            const uint32_t at = pending.back();
            pending.pop_back();
            const KdTreeNode& node = tree_.nodes[at];
            if (node.is_leaf()) {
                const auto first = tree_.references.begin() + node.first();
                if (std::binary_search(first, first + node.count(), id)) return true;
                continue;
            }
            const double from = p.at[node.axis()] - static_cast<double>(node.plane());
            if (from >= -slack) pending.push_back(node.above());
            if (from <= slack) pending.push_back(at + 1);
        }
        return false;
    }

    const KdTree& tree_;
};

} // namespace

std::optional<std::string> find_fault(const KdTree& tree) { return KdTreeChecker(tree).run(); }

} // namespace pertev
