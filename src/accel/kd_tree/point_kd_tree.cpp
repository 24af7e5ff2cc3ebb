#include "accel/kd_tree/point_kd_tree.h"

#include <algorithm>
#include <bit>

#include "base/error.h"
#include "base/parallel_for.h"
#include "base/sink.h"
#include "math/bounds3.h"

namespace pertev {
namespace {

constexpr std::size_t kParallelPoints = 1 << 12; // from this many points on, both halves are built in parallel

/// Number of points in the left subtree of a left-balanced tree of n points.
std::size_t count_of_left(std::size_t n) {
    if (n <= 1) return 0;
    const std::size_t half_row = std::size_t(1) << (std::bit_width(n) - 2); // left half of the last row
    const std::size_t in_last_row = n - (2 * half_row - 1);
    return half_row - 1 + std::min(in_last_row, half_row);
}

class PointKdBuilder {
public:
    PointKdBuilder(std::span<const Vec3> points, std::vector<PointKdNode>& nodes, Sink& sink)
        : points_(points), nodes_(nodes), sink_(sink) {}

    /// Builds the subtree at node `at` from the points `ids`.
    void build(std::span<uint32_t> ids, std::size_t at) const {
        if (ids.empty()) return;
        const bool is_parallel = ids.size() >= kParallelPoints;
        if (is_parallel) sink_.check();
        Bounds3 bounds;
        for (const uint32_t id : ids) bounds.extend(points_[id]);
        const Vec3 size = bounds.size();
        const int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
        const std::size_t left = count_of_left(ids.size());
        // A total order makes the result independent of the implementation of nth_element.
        const auto is_before = [&](uint32_t a, uint32_t b) {
            const float x = component(points_[a], axis), y = component(points_[b], axis);
            return x < y || (x == y && a < b);
        };
        std::nth_element(ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(left), ids.end(), is_before);
        nodes_[at] = kd_node(points_[ids[left]], ids[left], axis);
        const auto build_left = [&] { build(ids.first(left), 2 * at + 1); };
        const auto build_right = [&] { build(ids.subspan(left + 1), 2 * at + 2); };
        if (is_parallel) return parallel_invoke(build_left, build_right);
        build_left();
        build_right();
    }

private:
    std::span<const Vec3> points_;
    std::vector<PointKdNode>& nodes_;
    Sink& sink_;
};

} // namespace

PointKdTree build_point_kd_tree(std::span<const Vec3> points, Sink& sink) {
    if (points.size() > kMaxKdPoints) {
        throw Error(ErrorCode::OverLimit, "a kd-tree over points holds at most 2^30 - 1 of them");
    }
    PointKdTree tree;
    tree.nodes.resize(points.size());
    std::vector<uint32_t> ids(points.size());
    for (uint32_t i = 0; i < ids.size(); ++i) {
        PERTEV_CHECK(is_finite(points[i]));
        ids[i] = i;
    }
    PointKdBuilder(points, tree.nodes, sink).build(ids, 0);
    return tree;
}

} // namespace pertev
