// The octree over spheres and points: the spheres that cover a point, k nearest and radius search give exactly the
// results of brute force.

#include <doctest/doctest.h>

#include "accel/octree/point_octree.h"
#include "base/sink.h"
#include "tests/support/options.h"
#include "tests/support/stress_points.h"

using namespace pertev;
using namespace pertev::test;

namespace {

std::vector<Sphere> points_as_spheres(const std::vector<Vec3>& points) {
    std::vector<Sphere> spheres;
    for (const Vec3 p : points) spheres.push_back({p, 0});
    return spheres;
}

} // namespace

TEST_CASE("searches of an octree over points match brute force, with ties by index") {
    for (const StressPoints& set : stress_points(static_cast<uint32_t>(effort(600, 5000)))) {
        CAPTURE(set.name);
        for (const uint32_t max_leaf : {1u, 4u}) {
            const PointOctree tree = build_point_octree(points_as_spheres(set.points), nobody(), max_leaf);
            CHECK(find_wrong_search(view_of(tree), set, static_cast<uint32_t>(effort(60, 400))) == "");
            CHECK(tree.nodes.size() <= 2 * set.points.size());
        }
    }
}

TEST_CASE("an octree over spheres finds exactly the spheres that cover a point, each once") {
    for (const StressPoints& set : stress_points(static_cast<uint32_t>(effort(3000, 20000)))) {
        CAPTURE(set.name);
        Random random(12);
        std::vector<Sphere> spheres;
        for (const Vec3 p : set.points) {
            const float u = random.unit();
            // Radii of all sizes, many of which touch lattice points exactly.
            const float radius = random.below(3) == 0 ? 0.25f * static_cast<float>(random.below(4)) : u * u * u * u;
            spheres.push_back({p, set.extent * (random.below(10) == 0 ? 0 : radius)});
        }
        const PointOctree tree = build_point_octree(spheres, nobody());
        CHECK(tree.spheres.size() == spheres.size());
        CHECK(tree.nodes.size() <= 2 * spheres.size());
        uint64_t covering = 0;
        for (const Vec3 at : query_points(set, static_cast<uint32_t>(effort(300, 2000)))) {
            std::vector<NearPoint> want, seen;
            for (uint32_t i = 0; i < spheres.size(); ++i) {
                const float distance_squared = squared_distance(spheres[i].centre, at);
                if (distance_squared <= spheres[i].radius * spheres[i].radius) want.push_back({distance_squared, i});
            }
            visit_covering(view_of(tree), at, [&](const NearPoint& p) { seen.push_back(p); });
            std::sort(seen.begin(), seen.end(),
                      [](const NearPoint& a, const NearPoint& b) { return a.index < b.index; });
            REQUIRE(seen == want);
            covering += want.size();
        }
        if (set.points.size() > 2) CHECK(covering > 100);
    }
}

TEST_CASE("a few large spheres do not slow down the search for small ones") {
    Random random(6);
    std::vector<Sphere> spheres;
    for (uint32_t i = 0; i < 50'000; ++i) spheres.push_back({random.point(-1, 1), i % 1000 == 0 ? 1.0f : 0.01f});
    const PointOctree tree = build_point_octree(spheres, nobody());
    uint64_t nodes = 0;
    for (int i = 0; i < 100; ++i) { // the order of visit_covering
        const Vec3 at = random.point(-1, 1);
        for (uint32_t k = 0; k < tree.nodes.size(); ++nodes) {
            const PointOctreeNode& n = tree.nodes[k];
            k = squared_distance_to_box(n.lo, n.hi, at) > n.max_radius * n.max_radius ? n.skip : k + 1;
        }
    }
    CHECK(nodes < 100 * 300);
}

TEST_CASE("an octree without spheres finds nothing") {
    int seen = 0;
    visit_covering(PointOctreeView{}, {}, [&](const NearPoint&) { ++seen; });
    visit_within(PointOctreeView{}, {}, kInfinity, [&](const NearPoint&) { ++seen; });
    CHECK(seen == 0);
    CHECK(find_nearest(PointOctreeView{}, {}, kInfinity, 3, nullptr) == 0);
}
