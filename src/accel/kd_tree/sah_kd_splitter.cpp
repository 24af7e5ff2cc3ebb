#include "accel/kd_tree/sah_kd_splitter.h"

#include <algorithm>
#include <array>

#include "accel/clip_triangle.h"
#include "base/sort_until.h"

namespace pertev {
namespace {

constexpr uint32_t kParallelKdNode = 1u << 14; // from this many triangles on, the three axes are swept in parallel

// An event is one number, which makes sorting cheap: position, then kind, then the triangle's index in the node. At
// equal positions ends come before triangles in the plane, and these before beginnings.
enum Kind : uint32_t { kEnd = 0, kPlanar = 1, kBegin = 2 };
enum Side : uint8_t { kBoth = 0, kBelow = 1, kAbove = 2 };

uint64_t make_event(float at, Kind kind, uint32_t index) {
    const uint32_t bits = bits_of(at + 0.0f); // -0 becomes 0
    const uint32_t ordered = bits & 0x80000000u ? ~bits : bits | 0x80000000u;
    return uint64_t(ordered) << 32 | kind << 30 | index;
}
uint32_t position_key(uint64_t event) { return static_cast<uint32_t>(event >> 32); }
float position_of(uint32_t key) { return float_of(key & 0x80000000u ? key & 0x7fffffffu : ~key); }
float position_of(uint64_t event) { return position_of(position_key(event)); }
Kind kind_of(uint64_t event) { return static_cast<Kind>(event >> 30 & 3); }
uint32_t index_of(uint64_t event) { return static_cast<uint32_t>(event) & 0x3fffffffu; }
uint64_t with_index(uint64_t event, uint32_t index) { return (event & ~uint64_t(0x3fffffffu)) | index; }

void add_events(const Bounds3& box, uint32_t index, std::vector<uint64_t> (&events)[3]) {
    for (int axis = 0; axis < 3; ++axis) {
        const float lo = component(box.lo, axis), hi = component(box.hi, axis);
        if (lo == hi) {
            events[axis].push_back(make_event(lo, kPlanar, index));
        } else {
            events[axis].push_back(make_event(lo, kBegin, index));
            events[axis].push_back(make_event(hi, kEnd, index));
        }
    }
}

template <class Body>
void for_each_axis(bool parallel, const Body& body) {
    if (!parallel) {
        for (int axis = 0; axis < 3; ++axis) body(axis);
        return;
    }
    parallel_invoke([&] { body(0); }, [&] { parallel_invoke([&] { body(1); }, [&] { body(2); }); });
}

/// Finds the side of the plane on which each triangle lies.
std::vector<Side> find_sides(const SahKdSplitter::Node& node, const KdPlane& plane, bool planar_below) {
    std::vector<Side> sides(node.count, kBoth);
    for (const uint64_t event : node.events[plane.axis]) {
        const float at = position_of(event);
        const Kind kind = kind_of(event);
        Side& side = sides[index_of(event)];
        if (kind == kEnd && at <= plane.at) side = kBelow;
        if (kind == kBegin && at >= plane.at) side = kAbove;
        if (kind == kPlanar) side = at < plane.at || (at == plane.at && planar_below) ? kBelow : kAbove;
    }
    return sides;
}

std::vector<uint64_t> merge(const std::vector<uint64_t>& a, const std::vector<uint64_t>& b) {
    std::vector<uint64_t> all(a.size() + b.size());
    std::merge(a.begin(), a.end(), b.begin(), b.end(), all.begin());
    return all;
}

} // namespace

struct SahKdSplitter::Choice {
    double cost;
    KdPlane plane;
    bool planar_below;
};

SahKdSplitter::SahKdSplitter(const std::vector<BvhTriangle>& triangles, const KdTreeSettings& settings, float max_abs)
    : triangles_(triangles), settings_(settings), max_abs_(max_abs) {}

SahKdSplitter::Node SahKdSplitter::make_root() const {
    Node root;
    root.count = static_cast<uint32_t>(triangles_.size());
    root.triangles.resize(root.count);
    for (auto& events : root.events) events.reserve(2 * triangles_.size());
    for (uint32_t i = 0; i < root.count; ++i) {
        settings_.sink->check_at(i);
        root.triangles[i] = i;
        add_events(bounds_of(triangles_[i]), i, root.events);
    }
    for_each_axis(root.count >= kParallelKdNode,
                  [&](int axis) { sort_until(std::span(root.events[axis]), *settings_.sink); });
    return root;
}

SahKdSplitter::Choice SahKdSplitter::find_cheapest(const Node& node, int axis) const {
    const double kInfinite = static_cast<double>(kInfinity);
    Choice best = {kInfinite, {axis, 0}, true};
    const float lo = component(node.cell.lo, axis), hi = component(node.cell.hi, axis);
    // The area of a half is a linear function of the plane's position.
    const double whole = kd_cell_area(node.cell, max_abs_),
                 flat = kd_cell_area(cell_below(node.cell, axis, lo), max_abs_);
    if (!(hi > lo && whole > 0)) return best;
    const double slope = (whole - flat) / (static_cast<double>(hi) - static_cast<double>(lo));
    const double node_cost = static_cast<double>(settings_.node_cost);
    const double per_area = static_cast<double>(settings_.triangle_cost) / whole;
    const double bonus = 1 - static_cast<double>(settings_.empty_bonus);

    const std::vector<uint64_t>& events = node.events[axis];
    uint32_t below = 0, above = node.count;
    for (std::size_t i = 0; i < events.size();) {
        const uint32_t key = position_key(events[i]);
        uint32_t seen[3] = {0, 0, 0};
        for (; i < events.size() && position_key(events[i]) == key; ++i) ++seen[kind_of(events[i])];
        above -= seen[kPlanar] + seen[kEnd];
        const float at = position_of(key);
        if (at > lo && at < hi) {
            const double area_below = flat + slope * (static_cast<double>(at) - static_cast<double>(lo));
            const double area_above = flat + slope * (static_cast<double>(hi) - static_cast<double>(at));
            const auto consider = [&](uint32_t n_below, uint32_t n_above, bool planar_below) {
                double cost = node_cost + per_area * (area_below * n_below + area_above * n_above);
                if (n_below == 0 || n_above == 0) cost *= bonus;
                if (cost < best.cost) best = {cost, {axis, at}, planar_below};
            };
            consider(below + seen[kPlanar], above, true);
            if (seen[kPlanar] != 0) consider(below, above + seen[kPlanar], false);
        }
        below += seen[kPlanar] + seen[kBegin];
    }
    return best;
}

std::optional<KdPlane> SahKdSplitter::split(const Node& node, Node& below, Node& above) const {
    if (node.count == 0) return std::nullopt;
    const bool parallel = node.count >= kParallelKdNode;
    // Every loop over a large node is one that the sink may end.
    const auto for_axes = [&](const auto& body) {
        for_each_axis(parallel, [&](int axis) {
            if (parallel) settings_.sink->check();
            body(axis);
        });
    };
    std::array<Choice, 3> choices;
    for_axes([&](int axis) { choices[static_cast<std::size_t>(axis)] = find_cheapest(node, axis); });
    Choice best = choices[0];
    for (const Choice& choice : choices) best = choice.cost < best.cost ? choice : best;
    if (!(best.cost < static_cast<double>(settings_.triangle_cost) * node.count)) return std::nullopt;

    const KdPlane plane = best.plane;
    const std::vector<Side> sides = find_sides(node, plane, best.planar_below);
    const Bounds3 low = cell_below(node.cell, plane.axis, plane.at), high = cell_above(node.cell, plane.axis, plane.at);
    const double slack = clip_slack(max_abs_);
    std::vector<uint32_t> new_indices(node.count); // new index, in its half, of a triangle that is in only one
    std::vector<uint64_t> fresh_below[3], fresh_above[3];
    const auto add = [&](Node& half, uint32_t index) {
        half.triangles.push_back(node.triangles[index]);
        return half.count++;
    };
    for (uint32_t i = 0; i < node.count; ++i) {
        settings_.sink->check_at(i + 1);
        if (sides[i] == kBelow) new_indices[i] = add(below, i);
        if (sides[i] == kAbove) new_indices[i] = add(above, i);
        if (sides[i] != kBoth) continue;
        const BvhTriangle& triangle = triangles_[node.triangles[i]];
        const Bounds3 part_below = clip_triangle(triangle, low, slack),
                      part_above = clip_triangle(triangle, high, slack);
        if (!part_below.is_empty()) add_events(part_below, add(below, i), fresh_below);
        if (!part_above.is_empty()) add_events(part_above, add(above, i), fresh_above);
    }
    if (uint64_t(below.count) + above.count > node.budget) return std::nullopt;

    for_axes([&](int axis) {
        std::vector<uint64_t> kept_below, kept_above;
        kept_below.reserve(2 * std::size_t(below.count));
        kept_above.reserve(2 * std::size_t(above.count));
        for (const uint64_t event : node.events[axis]) {
            const uint32_t i = index_of(event);
            if (sides[i] == kBelow) kept_below.push_back(with_index(event, new_indices[i]));
            if (sides[i] == kAbove) kept_above.push_back(with_index(event, new_indices[i]));
        }
        std::sort(fresh_below[axis].begin(), fresh_below[axis].end());
        std::sort(fresh_above[axis].begin(), fresh_above[axis].end());
        // Renumbering keeps the order of indices, so the events that stay are still sorted.
        below.events[axis] = merge(kept_below, fresh_below[axis]);
        above.events[axis] = merge(kept_above, fresh_above[axis]);
    });
    return plane;
}

std::vector<uint32_t> SahKdSplitter::triangles_of(const Node& node) { return node.triangles; }

} // namespace pertev
