#include "tests/support/check_kd_tree.h"

#include <algorithm>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "tests/support/check_cells.h"

namespace pertev {
namespace {

class KdTreeChecker {
public:
    explicit KdTreeChecker(const KdTree& tree) : tree_(tree) {}

    std::optional<std::string> run() const {
        return find_fault_of(
            tree_, [this] { return check_structure(); },
            [this](uint32_t id, const TrianglePoint& p) { return is_listed(id, p); });
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
            if (at.node != nodes++) return fmt::format("node {} is not where the traversal expects it", at.node);
            if (at.node >= tree_.nodes.size()) return fmt::format("a link to node {}", at.node);
            const KdTreeNode& node = tree_.nodes[at.node];
            depth = std::max(depth, at.depth);
            if (node.is_leaf()) {
                if (node.first() != references) return fmt::format("leaf {} has not the next references", at.node);
                references += node.count();
                if (references > tree_.references.size()) return fmt::format("leaf {} runs past the end", at.node);
                const auto list = std::span(tree_.references).subspan(node.first(), node.count());
                if (auto fault = find_list_fault(list, tree_.triangles, at.cell, at.node)) return fault;
                continue;
            }
            if (at.depth >= kMaxKdTreeDepth) return fmt::format("node {} is too deep", at.node);
            const float lo = component(at.cell.lo, node.axis()), hi = component(at.cell.hi, node.axis());
            if (!(node.plane() > lo && node.plane() < hi)) return fmt::format("node {} cuts outside it", at.node);
            pending.push_back({node.above(), at.depth + 1, cell_above(at.cell, node.axis(), node.plane())});
            pending.push_back({at.node + 1, at.depth + 1, cell_below(at.cell, node.axis(), node.plane())});
        }
        return find_unreached(tree_, nodes, references, depth);
    }

    /// Returns whether the leaf at `p` lists the triangle; on a plane, whether one of the adjacent leaves does.
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
