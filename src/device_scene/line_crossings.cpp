#include "device_scene/line_crossings.h"

#include <algorithm>
#include <cmath>

namespace pertev {
namespace {

constexpr uint32_t kMostCells = 512;   // along a side
constexpr std::size_t kMaxEntries = 8; // entries per index, on average
constexpr double kMargin = 1e-6;       // in cells, far more than what rounding moves a place by

/// Returns +1 or -1 if a line from `from` along `direction` meets the triangle, by the side that it meets; else 0.
int crossing(DoubleVec3 from, DoubleVec3 direction, DoubleVec3 a, DoubleVec3 b, DoubleVec3 c) {
    const DoubleVec3 ab = b - a, ac = c - a, p = cross(direction, ac);
    const double det = dot(ab, p);
    if (det == 0) return 0;
    const DoubleVec3 to = from - a, q = cross(to, ab);
    const double u = dot(to, p) / det, v = dot(direction, q) / det, t = dot(ac, q) / det;
    if (!(u >= 0 && v >= 0 && u + v <= 1 && t > 0)) return 0;
    return det > 0 ? 1 : -1;
}

DoubleVec3 scaled(double by, DoubleVec3 v) { return {by * v.x, by * v.y, by * v.z}; }

} // namespace

LineCrossings::LineCrossings(std::span<const Vec3> positions, std::span<const uint32_t> indices, DoubleVec3 along)
    : along_(along) {
    const DoubleVec3 other = std::abs(along.x) < std::abs(along.y) ? DoubleVec3{1, 0, 0} : DoubleVec3{0, 1, 0};
    x_axis_ = cross(along, other), y_axis_ = cross(along, x_axis_);
    double least_x = 0, least_y = 0;
    bool is_first = true;
    const auto corner = [&](std::size_t i) { return to_double(positions[indices[i]]); };
    double most_x = 0, most_y = 0;
    for (std::size_t i = 0; i < indices.size(); ++i) {
        const double x = dot(corner(i), x_axis_), y = dot(corner(i), y_axis_);
        least_x = is_first ? x : std::min(least_x, x), most_x = is_first ? x : std::max(most_x, x);
        least_y = is_first ? y : std::min(least_y, y), most_y = is_first ? y : std::max(most_y, y);
        is_first = false;
    }
    const double size = std::max(most_x - least_x, most_y - least_y);
    // A point whose products with the two axes, which are at right angles, are the least ones.
    corner_ = scaled(least_x / dot(x_axis_, x_axis_), x_axis_) + scaled(least_y / dot(y_axis_, y_axis_), y_axis_);
    const DoubleVec3 whole_x = scaled(size > 0 ? 1 / size : 1, x_axis_),
                     whole_y = scaled(size > 0 ? 1 / size : 1, y_axis_);
    const auto visit_cells = [&](std::size_t triangle, const auto& visit) {
        GridPoint lo = grid_point_of(corner(triangle)), hi = lo;
        for (std::size_t k = 1; k < 3; ++k) {
            const GridPoint p = grid_point_of(corner(triangle + k));
            lo = {std::min(lo.x, p.x), std::min(lo.y, p.y)}, hi = {std::max(hi.x, p.x), std::max(hi.y, p.y)};
        }
        for (uint32_t y = cell(lo.y - kMargin); y <= cell(hi.y + kMargin); ++y)
            for (uint32_t x = cell(lo.x - kMargin); x <= cell(hi.x + kMargin); ++x) visit(y * side_ + x);
    };
    side_ = std::clamp(static_cast<uint32_t>(std::sqrt(static_cast<double>(indices.size() / 3))), 1u, kMostCells);
    for (;; side_ /= 2) { // long triangles lie in many cells
        x_axis_ = scaled(side_, whole_x), y_axis_ = scaled(side_, whole_y);
        starts_.assign(std::size_t(side_) * side_ + 1, 0);
        std::size_t total = 0;
        for (std::size_t i = 0; i < indices.size() && (side_ == 1 || total <= kMaxEntries * indices.size()); i += 3)
            visit_cells(i, [&](uint32_t at) { ++starts_[at + 1], ++total; });
        if (side_ == 1 || total <= kMaxEntries * indices.size()) break;
    }
    for (std::size_t at = 1; at < starts_.size(); ++at) starts_[at] += starts_[at - 1];
    triangles_.resize(starts_.back());
    std::vector<uint32_t> next(starts_.begin(), starts_.end() - 1);
    for (std::size_t i = 0; i < indices.size(); i += 3)
        visit_cells(i, [&](uint32_t at) { triangles_[next[at]++] = static_cast<uint32_t>(i / 3); });
}

LineCrossings::GridPoint LineCrossings::grid_point_of(DoubleVec3 point) const {
    const DoubleVec3 to = point - corner_;
    return {dot(to, x_axis_), dot(to, y_axis_)};
}

uint32_t LineCrossings::cell(double at) const { return static_cast<uint32_t>(std::clamp(at, 0.0, side_ - 1.0)); }

int LineCrossings::count(std::span<const Vec3> positions, std::span<const uint32_t> indices, DoubleVec3 from) const {
    const GridPoint point_on_grid = grid_point_of(from);
    const auto is_outside = [&](double at) { return !(at >= -kMargin && at <= side_ + kMargin); };
    if (is_outside(point_on_grid.x) || is_outside(point_on_grid.y)) return 0;
    const uint32_t number = cell(point_on_grid.y) * side_ + cell(point_on_grid.x);
    int count = 0;
    for (uint32_t k = starts_[number]; k < starts_[number + 1]; ++k) {
        const uint32_t* const i = indices.data() + 3 * std::size_t(triangles_[k]);
        count +=
            crossing(from, along_, to_double(positions[i[0]]), to_double(positions[i[1]]), to_double(positions[i[2]]));
    }
    return count;
}

} // namespace pertev
