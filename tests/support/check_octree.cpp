#include "tests/support/check_octree.h"

#include <algorithm>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "accel/octree/build_octree.h"
#include "tests/support/check_cells.h"

namespace pertev {
namespace {

/// Returns whether the eight children of a cell meet at its centre and have half its size, to the bit.
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

    std::optional<std::string> run() const {
        return find_fault_of(
            tree_, [this] { return check_structure(); },
            [this](uint32_t id, const TrianglePoint& p) { return is_listed(id, p); });
    }

private:
    struct Pending {
        uint32_t node;
        int depth;
        OctreeCell cell;
    };

    OctreeCell root() const { return {0, 0, 0, 0.5f * tree_.side}; }

    std::optional<std::string> check_structure() const {
        if (!holds(bounds_of(root(), tree_.corner), tree_.bounds)) return "the root's cell does not hold the bounds";
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
                const auto list = std::span(tree_.references).subspan(node.first, node.count());
                if (auto fault = find_list_fault(list, tree_.triangles, bounds_of(at.cell, tree_.corner), at.node))
                    return fault;
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
        return find_unreached(tree_, nodes, references, depth);
    }

    /// Returns whether the leaf at `p` lists the triangle; on a plane, whether one of the adjacent leaves does.
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
