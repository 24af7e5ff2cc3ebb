#include "lab/found_points.h"

#include <algorithm>

#include <fmt/format.h>

#include "accel/kd_tree/point_kd_tree.h"
#include "accel/octree/point_octree.h"
#include "base/sink.h"
#include "math/bounds3.h"
#include "math/portable_math.h"
#include "math/random.h"

namespace pertev {
namespace {

constexpr uint32_t kDrawnPoints = 240;
constexpr Vec3 kQuery = {0.38f, 0.52f, 0};
constexpr double kDrawnSide = 440, kDrawnMargin = 10, kDrawnTop = 28;

/// Returns points that are dense in two places and sparse between them, like photons.
std::vector<Vec3> scattered_points() {
    std::vector<Vec3> points;
    for (uint32_t i = 0; points.size() < kDrawnPoints; ++i) {
        const auto bits = hash_words(i, 0, 0x706f696eu);
        const auto unit = [](uint32_t word) { return static_cast<float>(word >> 8) * 0x1p-24f; };
        Vec3 p = {unit(bits.x), unit(bits.y), 0};
        if (i % 3 != 0) { // a normal distribution by Box and Muller's method
            const Vec3 middle = i % 3 == 1 ? Vec3{0.3f, 0.6f, 0} : Vec3{0.72f, 0.3f, 0};
            const float far = 0.13f * sqrt(-2.0f * log(1.0f - p.x)), angle = 2 * kPi * p.y;
            p = {middle.x + far * cos(angle), middle.y + far * sin(angle), 0};
        }
        if (min(p.x, p.y) >= 0 && max(p.x, p.y) <= 1) points.push_back(p);
    }
    return points;
}

/// Forwards the points that a search offers and counts them.
template <class Found>
struct Watched {
    Found& inner;
    std::vector<uint32_t>& tested;
    mutable uint32_t requested = 0; // counts calls for the search radius

    float limit() const {
        ++requested;
        return inner.limit();
    }
    void offer(const NearPoint& p) {
        tested.push_back(p.index);
        inner.offer(p);
    }
};

/// Adds the splitting planes of node `at` and of the nodes below it, clipped to the node's cell.
void add_planes(const PointKdTree& tree, std::size_t at, const Bounds3& cell, FoundPoints& found) {
    if (2 * at + 1 >= tree.nodes.size()) return; // a node without children: its plane divides nothing
    const PointKdNode& node = tree.nodes[at];
    Bounds3 left = cell, right = cell;
    Vec3 from = cell.lo, to = cell.hi;
    if (node.axis() == 0) {
        left.hi.x = right.lo.x = from.x = to.x = node.position.x;
    } else {
        left.hi.y = right.lo.y = from.y = to.y = node.position.y;
    }
    found.lines.push_back({from, to, std::ranges::binary_search(found.tested, node.index())});
    add_planes(tree, 2 * at + 1, left, found);
    add_planes(tree, 2 * at + 2, right, found);
}

double x_of(Vec3 p) { return kDrawnMargin + kDrawnSide * static_cast<double>(p.x); }
double y_of(Vec3 p) { return kDrawnTop + kDrawnSide * (1 - static_cast<double>(p.y)); }

std::string circle_at(Vec3 p, double radius, const char* style) {
    return fmt::format(R"(<circle cx="{:.1f}" cy="{:.1f}" r="{:.1f}" {}/>)", x_of(p), y_of(p), radius, style);
}
std::string box_at(Vec3 lo, Vec3 hi, const char* style) {
    return fmt::format(R"(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" {}/>)", x_of(lo), y_of(hi),
                       kDrawnSide * static_cast<double>(hi.x - lo.x), kDrawnSide * static_cast<double>(hi.y - lo.y),
                       style);
}

} // namespace

FoundPoints found_in_kd_tree() {
    FoundPoints result = {.tree = "kd-tree", .points = scattered_points(), .at = kQuery};
    const PointKdTree tree = build_point_kd_tree(result.points, nobody());
    NearPoint nearest[kPointsRequested];
    NearestPoints heap(nearest, kPointsRequested, kInfinity);
    Watched<NearestPoints> watched = {heap, result.tested};
    search_points(view_of(tree), result.at, watched);
    const uint32_t count = heap.sort();
    for (uint32_t i = 0; i < count; ++i) result.found.push_back(nearest[i].index);
    result.radius_squared = nearest[count - 1].distance_squared;
    std::ranges::sort(result.found);
    std::ranges::sort(result.tested);
    result.nodes = static_cast<uint32_t>(tree.nodes.size());
    result.visited = static_cast<uint32_t>(result.tested.size()); // each node holds one point
    add_planes(tree, 0, {{0, 0, 0}, {1, 1, 0}}, result);
    return result;
}

FoundPoints found_in_octree() {
    const FoundPoints nearest = found_in_kd_tree();
    FoundPoints result = {
        .tree = "octree", .points = nearest.points, .at = kQuery, .radius_squared = nearest.radius_squared};
    std::vector<Sphere> spheres;
    for (const Vec3 p : result.points) spheres.push_back({p, 0});
    const PointOctree tree = build_point_octree(spheres, nobody());
    auto keep = [&](const NearPoint& p) { result.found.push_back(p.index); };
    PointsWithin<decltype(keep)> within = {result.radius_squared, keep};
    Watched<PointsWithin<decltype(keep)>> watched = {within, result.tested};
    search_points(view_of(tree), result.at, watched);
    result.visited = watched.requested; // the radius is requested once per node
    std::ranges::sort(result.found);
    std::ranges::sort(result.tested);
    result.nodes = static_cast<uint32_t>(tree.nodes.size());
    for (const PointOctreeNode& node : tree.nodes) {
        if (node.count == 0) continue;
        const uint32_t first = tree.indices[node.first];
        result.boxes.push_back({node.lo, node.hi, std::ranges::binary_search(result.tested, first)});
    }
    return result;
}

std::string describe(const FoundPoints& found) {
    return fmt::format(
        "The search visits {} of {} nodes and tests {} of {} points (orange); {} of them are found (green).",
        found.visited, found.nodes, found.tested.size(), found.points.size(), found.found.size());
}

std::string svg_of(const FoundPoints& found) {
    std::string content = box_at({0, 0, 0}, {1, 1, 0}, R"(fill="#fff" stroke="#444")");
    for (const FoundPoints::Box& box : found.boxes) {
        content += box_at(box.lo, box.hi,
                          box.is_visited ? R"(fill="#ffe8cc" stroke="#d9822b")" : R"(fill="none" stroke="#bbb")");
    }
    for (const bool visited : {false, true}) { // planes of visited nodes are drawn last, so they lie on top
        for (const FoundPoints::Line& line : found.lines) {
            if (line.is_visited != visited) continue;
            content +=
                fmt::format(R"(<line x1="{:.1f}" y1="{:.1f}" x2="{:.1f}" y2="{:.1f}" stroke="{}"/>)", x_of(line.from),
                            y_of(line.from), x_of(line.to), y_of(line.to), visited ? "#d9822b" : "#ccc");
        }
    }
    content += circle_at(found.at, kDrawnSide * static_cast<double>(sqrt(found.radius_squared)),
                         R"(fill="#2ca02c" fill-opacity="0.1" stroke="#2ca02c")");
    for (uint32_t i = 0; i < found.points.size(); ++i) {
        const bool is_found = std::ranges::binary_search(found.found, i);
        const bool is_seen = std::ranges::binary_search(found.tested, i);
        content += circle_at(found.points[i], is_found ? 4 : 2.5,
                             is_found  ? R"(fill="#2ca02c")"
                             : is_seen ? R"(fill="#ff7f0e")"
                                       : R"(fill="#777")");
    }
    content += fmt::format(R"(<path d="M{0:.1f} {1:.1f}h12m-6 -6v12" stroke="#d62728" stroke-width="2"/>)",
                           x_of(found.at) - 6, y_of(found.at));
    return fmt::format(
        R"(<svg xmlns="http://www.w3.org/2000/svg" width="{:.0f}" height="{:.0f}">)"
        R"(<text x="{:.0f}" y="18" font-family="sans-serif" font-size="14">Points found in a tree: {}</text>{}</svg>)"
        "\n",
        kDrawnSide + 2 * kDrawnMargin, kDrawnTop + kDrawnSide + kDrawnMargin, kDrawnMargin, found.tree, content);
}

} // namespace pertev
