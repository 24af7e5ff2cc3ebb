// The figures of points found in a tree: a kd-tree and an octree find the same nearest points, and the drawing shows
// the search.

#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "accel/nearest_points.h"
#include "lab/found_points.h"

using namespace pertev;

TEST_CASE("a search in a point tree finds the nearest points and visits few nodes") {
    const FoundPoints kd = found_in_kd_tree(), octree = found_in_octree();
    CHECK(kd.points == octree.points);
    std::vector<std::pair<float, uint32_t>> by_distance;
    for (uint32_t i = 0; i < kd.points.size(); ++i) {
        by_distance.emplace_back(squared_distance(kd.points[i], kd.at), i);
    }
    std::ranges::sort(by_distance);
    std::vector<uint32_t> nearest;
    for (uint32_t i = 0; i < kPointsRequested; ++i) nearest.push_back(by_distance[i].second);
    std::ranges::sort(nearest);
    CHECK(kd.found == nearest);
    CHECK(octree.found == nearest);
    CHECK(kd.radius_squared == by_distance[kPointsRequested - 1].first);
    for (const FoundPoints* found : {&kd, &octree}) {
        CAPTURE(found->tree);
        CHECK(std::ranges::includes(found->tested, found->found));
        CHECK(found->tested.size() < found->points.size() / 3);
        CHECK(found->visited < found->nodes / 2);
        const std::string svg = svg_of(*found);
        // There is one circle per point, and one for the search radius.
        std::size_t circles = 0;
        for (std::size_t at = svg.find("<circle"); at != std::string::npos; at = svg.find("<circle", at + 1)) ++circles;
        CHECK(circles == found->points.size() + 1);
    }
    CHECK(kd.nodes == kd.points.size());
    CHECK(kd.visited == kd.tested.size());
    // Each plane of the kd-tree lies within the square and contains its node's point.
    CHECK(kd.lines.size() == kd.points.size() / 2);
    for (const FoundPoints::Line& line : kd.lines) {
        const bool is_upright = line.from.x == line.to.x;
        CHECK((is_upright || line.from.y == line.to.y));
        CHECK(std::ranges::any_of(kd.points, [&](const Vec3& p) {
            return is_upright ? p.x == line.from.x && p.y >= line.from.y && p.y <= line.to.y
                              : p.y == line.from.y && p.x >= line.from.x && p.x <= line.to.x;
        }));
    }
    // Each point lies in one box of the octree.
    for (const Vec3& p : octree.points) {
        CHECK(std::ranges::count_if(octree.boxes, [&](const FoundPoints::Box& box) {
                  return p.x >= box.lo.x && p.x <= box.hi.x && p.y >= box.lo.y && p.y <= box.hi.y;
              }) == 1);
    }
}
