#include "accel/kd_tree/build_kd_tree.h"

#include <bit>
#include <utility>

#include "accel/clip_triangle.h"
#include "accel/kd_tree/kd_subtree.h"
#include "accel/kd_tree/sah_kd_splitter.h"

namespace pertev {
namespace {

/// Splits the longest side of the cell in the middle.
class MedianKdSplitter {
public:
    struct Part {
        uint32_t triangle;
        Bounds3 box; // bounds of its part in the cell
    };
    struct Node : KdBuildNode {
        std::vector<Part> parts;
    };

    MedianKdSplitter(const std::vector<BvhTriangle>& triangles, const KdTreeSettings& settings, float max_abs)
        : triangles_(triangles), settings_(settings), max_abs_(max_abs) {}

    Node make_root() const {
        Node root;
        root.count = static_cast<uint32_t>(triangles_.size());
        root.parts.reserve(root.count);
        for (uint32_t i = 0; i < root.count; ++i) {
            settings_.sink->check_at(i);
            root.parts.push_back({i, bounds_of(triangles_[i])});
        }
        return root;
    }

    std::optional<KdPlane> split(const Node& node, Node& below, Node& above) const {
        if (node.count <= settings_.max_leaf) return std::nullopt;
        const Vec3 size = node.cell.size();
        const int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
        const float lo = component(node.cell.lo, axis), hi = component(node.cell.hi, axis), at = 0.5f * (lo + hi);
        // Closer planes than the margin of a traversal would not separate any rays.
        if (!(hi - lo > 0x1p-19f * max_abs_ && at > lo && at < hi)) return std::nullopt;
        for (uint32_t i = 0; i < node.count; ++i) {
            settings_.sink->check_at(i + 1);
            add_part(node.parts[i], node.cell, {axis, at}, below, above);
        }
        below.count = static_cast<uint32_t>(below.parts.size());
        above.count = static_cast<uint32_t>(above.parts.size());
        if (uint64_t(below.count) + above.count > node.budget) return std::nullopt;
        return KdPlane{axis, at};
    }

    static std::vector<uint32_t> triangles_of(const Node& node) {
        std::vector<uint32_t> ids;
        for (const Part& part : node.parts) ids.push_back(part.triangle);
        return ids;
    }

private:
    void add_part(const Part& part, const Bounds3& cell, const KdPlane& plane, Node& below, Node& above) const {
        const float lo = component(part.box.lo, plane.axis), hi = component(part.box.hi, plane.axis);
        if (hi <= plane.at) {
            below.parts.push_back(part);
        } else if (lo >= plane.at) {
            above.parts.push_back(part);
        } else {
            const BvhTriangle& triangle = triangles_[part.triangle];
            const double slack = clip_slack(max_abs_);
            const Bounds3 low = clip_triangle(triangle, cell_below(cell, plane.axis, plane.at), slack);
            const Bounds3 high = clip_triangle(triangle, cell_above(cell, plane.axis, plane.at), slack);
            if (!low.is_empty()) below.parts.push_back({part.triangle, low});
            if (!high.is_empty()) above.parts.push_back({part.triangle, high});
        }
    }

    const std::vector<BvhTriangle>& triangles_;
    const KdTreeSettings& settings_;
    const float max_abs_;
};

template <class Splitter>
KdSubtree build_with(const Splitter& splitter, const Bounds3& bounds, int levels, uint64_t budget, Sink& sink) {
    typename Splitter::Node root = splitter.make_root();
    root.cell = bounds;
    root.levels = levels;
    root.budget = budget;
    KdSubtree all;
    build_kd_subtree(splitter, std::move(root), 0, all, sink);
    return all;
}

} // namespace

KdTree build_kd_tree(const std::vector<BvhTriangle>& triangles, const KdTreeSettings& settings) {
    PERTEV_CHECK(settings.max_depth >= 0 && settings.max_depth <= kMaxKdTreeDepth && settings.max_references >= 1);
    PERTEV_CHECK(settings.node_cost >= 0 && settings.triangle_cost > 0);
    PERTEV_CHECK(settings.empty_bonus >= 0 && settings.empty_bonus < 1);
    if (triangles.size() > kMaxKdTreeTriangles) {
        throw Error(ErrorCode::OverLimit, "a kd-tree holds at most 2^30 - 1 triangles");
    }
    KdTree tree;
    if (triangles.empty()) return tree;
    for (const BvhTriangle& t : triangles) tree.bounds.extend(bounds_of(t));
    const int log2_count = static_cast<int>(std::bit_width(triangles.size())) - 1;
    const int levels = min(settings.max_depth, 8 + 13 * log2_count / 10);
    const uint64_t budget = uint64_t(settings.max_references) * triangles.size();
    const float max_abs = tree.bounds.max_abs();
    KdSubtree built;
    switch (settings.split) {
    case KdSplit::SpatialMedian:
        built = build_with(MedianKdSplitter(triangles, settings, max_abs), tree.bounds, levels, budget, *settings.sink);
        break;
    case KdSplit::Sah:
        built = build_with(SahKdSplitter(triangles, settings, max_abs), tree.bounds, levels, budget, *settings.sink);
        break;
    }
    tree.nodes = std::move(built.nodes);
    tree.references = std::move(built.references);
    tree.depth = built.depth;
    tree.triangles = triangles;
    tree.sah_cost = kd_tree_sah_cost(tree, settings.node_cost, settings.triangle_cost, *settings.sink);
    return tree;
}

double kd_cell_area(const Bounds3& cell, float max_abs) {
    const double grown = 2 * 0x1p-20 * static_cast<double>(max_abs);
    const auto side = [&](int axis) {
        return static_cast<double>(component(cell.hi, axis)) - static_cast<double>(component(cell.lo, axis)) + grown;
    };
    const double x = side(0), y = side(1), z = side(2);
    return x * y + y * z + z * x;
}

float kd_tree_sah_cost(const KdTree& tree, float node_cost, float triangle_cost, Sink& sink) {
    if (tree.nodes.empty()) return 0;
    const float max_abs = tree.bounds.max_abs();
    struct Pending {
        uint32_t node;
        Bounds3 cell;
    };
    std::vector<Pending> pending = {{0, tree.bounds}};
    double cost = 0;
    for (uint64_t visits = 1; !pending.empty(); ++visits) {
        sink.check_at(visits);
        const Pending at = pending.back();
        pending.pop_back();
        const KdTreeNode& node = tree.nodes[at.node];
        const double area = kd_cell_area(at.cell, max_abs);
        if (node.is_leaf()) {
            cost += area * static_cast<double>(triangle_cost) * node.count();
            continue;
        }
        cost += area * static_cast<double>(node_cost);
        pending.push_back({node.above(), cell_above(at.cell, node.axis(), node.plane())});
        pending.push_back({at.node + 1, cell_below(at.cell, node.axis(), node.plane())});
    }
    const double whole = kd_cell_area(tree.bounds, max_abs);
    return whole > 0 ? static_cast<float>(cost / whole) : static_cast<float>(tree.triangles.size()) * triangle_cost;
}

} // namespace pertev
