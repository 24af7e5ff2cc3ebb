// The kd-tree over points: k nearest and radius search give exactly the results of brute force, ties included.

#include <doctest/doctest.h>

#include <cstring>

#include "accel/kd_tree/point_kd_tree.h"
#include "base/parallel_for.h"
#include "base/sink.h"
#include "tests/support/options.h"
#include "tests/support/stress_points.h"

using namespace pertev;
using namespace pertev::test;

TEST_CASE("searches of a kd-tree over points match brute force, with ties by index") {
    for (const StressPoints& set : stress_points(static_cast<uint32_t>(effort(600, 5000)))) {
        CAPTURE(set.name);
        const PointKdTree tree = build_point_kd_tree(set.points, nobody());
        CHECK(find_wrong_search(view_of(tree), set, static_cast<uint32_t>(effort(60, 400))) == "");
    }
}

TEST_CASE("a kd-tree over any number of points is left-balanced") {
    Random random(2);
    for (uint32_t n = 0; n < 70; ++n) {
        CAPTURE(n);
        StressPoints set = {"few", {}};
        for (uint32_t i = 0; i < n; ++i) set.points.push_back(random.point(-1, 1));
        const PointKdTree tree = build_point_kd_tree(set.points, nobody());
        REQUIRE(tree.nodes.size() == n);
        for (uint32_t i = 1; i < n; ++i) { // each node is on its side of every plane above it
            for (uint32_t at = i; at > 0; at = (at - 1) / 2) {
                const PointKdNode& above = tree.nodes[(at - 1) / 2];
                const float from =
                    component(tree.nodes[i].position, above.axis()) - component(above.position, above.axis());
                CHECK((at % 2 == 1 ? from <= 0 : from >= 0));
            }
        }
        CHECK(find_wrong_search(view_of(tree), set, 10) == "");
    }
}

TEST_CASE("a kd-tree over points visits few of them and does not depend on the number of threads") {
    Random random(6);
    std::vector<Vec3> points;
    for (uint32_t i = 0; i < effort(100'000, 2'000'000); ++i) points.push_back(random.point(-1, 1));
    const auto built_by = [&](int threads) {
        const UseThreads use(threads);
        return build_point_kd_tree(points, nobody());
    };
    const PointKdTree tree = built_by(1), again = built_by(4);
    CHECK(std::memcmp(tree.nodes.data(), again.nodes.data(), points.size() * sizeof(PointKdNode)) == 0);
    struct Counting {
        NearestPoints nearest;
        uint64_t offered = 0;
        float limit() const { return nearest.limit(); }
        void offer(const NearPoint& p) {
            ++offered;
            nearest.offer(p);
        }
    };
    NearPoint found[50];
    uint64_t offered = 0;
    for (int i = 0; i < 100; ++i) {
        Counting counting = {NearestPoints(found, 50, kInfinity)};
        search_points(view_of(tree), random.point(-1, 1), counting);
        CHECK(counting.nearest.sort() == 50);
        offered += counting.offered;
    }
    CHECK(offered < 100 * 400);
}
