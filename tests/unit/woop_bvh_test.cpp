// Woop's unit triangles: transforms map corners to the unit triangle, rays away from edges have the hits of the exact
// test, and degenerate triangles are never hit.

#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "accel/builders/build_bvh.h"
#include "accel/bvh/woop_bvh.h"
#include "tests/support/check_traversal.h"
#include "tests/support/meshes.h"
#include "tests/support/stress_meshes.h"
#include "trace/binary/while_while_traversal.h"
#include "trace/intersect/woop_tests.h"

using namespace pertev;
using namespace pertev::test;

namespace {

double along(Vec3 row, float shift, Vec3 p) {
    return static_cast<double>(row.x) * static_cast<double>(p.x) +
           static_cast<double>(row.y) * static_cast<double>(p.y) +
           static_cast<double>(row.z) * static_cast<double>(p.z) + static_cast<double>(shift);
}

void check_corner(const WoopTriangle& w, Vec3 corner, double u, double v) {
    CHECK(std::abs(along(w.normal, w.height, corner)) < 2e-6);
    CHECK(along(w.u_row, w.u_shift, corner) == doctest::Approx(u).epsilon(1e-5));
    CHECK(along(w.v_row, w.v_shift, corner) == doctest::Approx(v).epsilon(1e-5));
}

} // namespace

TEST_CASE("Woop's transform maps a triangle to the unit triangle with heights in metres") {
    Random random(11);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 a = random.point(-1, 1), b = random.point(-1, 1), c = random.point(-1, 1);
        if (length(cross(b - a, c - a)) < 0.05f) continue;
        const WoopTriangle w = make_woop_triangle(a, b, c, i % 2 == 1);
        check_corner(w, a, 0, 0);
        check_corner(w, b, 1, 0);
        check_corner(w, c, 0, 1);
        CHECK(std::abs(along(w.normal, w.height, a + 2.0f * normalize(cross(b - a, c - a))) - 2) < 4e-6);
        CHECK((bits_of(w.normal.x) & kLastInLeaf) == (i % 2 == 1 ? kLastInLeaf : 0));
    }
}

TEST_CASE("rays inside a triangle hit it as in the exact test, and rays outside miss it") {
    Random random(12);
    int inside = 0, outside = 0;
    for (int i = 0; i < 20'000; ++i) {
        const Vec3 a = random.point(-1, 1), b = random.point(-1, 1), c = random.point(-1, 1);
        const Vec3 n = cross(b - a, c - a);
        Ray ray = {random.point(-2, 2), 0, random.direction(), 100};
        if (i % 2 == 0)
            ray.direction = (1.25f + 0.75f * random.point(-1, 1).x) * (0.25f * a + 0.25f * b + 0.5f * c - ray.origin);
        if (length(n) < 0.05f || std::abs(dot(ray.direction, n)) < 0.05f * length(n) * length(ray.direction)) continue;
        const RayShear shear = make_ray_shear(ray.direction);
        TriangleHit exact, woop;
        const bool hits = intersect_triangle(ray.origin, shear, ray.t_min, ray.t_max, a, b, c, exact);
        const bool hits_woop = WoopTests::intersect(ray, make_woop_triangle(a, b, c, true), woop);
        if (hits && (exact.u < 1e-3f || exact.v < 1e-3f || exact.u + exact.v > 0.999f))
            continue;             // the ray is at an edge
        if (!hits && hits_woop) { // equal
            CHECK((woop.u < 1e-3f || woop.v < 1e-3f || woop.u + woop.v > 0.999f));
            continue;
        }
        CHECK(hits == hits_woop);
        (hits ? inside : outside) += 1;
        if (!hits) continue;
        CHECK(woop.t == doctest::Approx(exact.t).epsilon(1e-3));
        CHECK(std::abs(woop.u - exact.u) < 1e-3f);
        CHECK(std::abs(woop.v - exact.v) < 1e-3f);
    }
    CHECK(inside > 5000);
    CHECK(outside > 2000);
}

TEST_CASE("triangles without area, and those too small or too large, are never hit") {
    const Vec3 o = {0, 0, 0}, x = {1, 0, 0}, y = {0, 1, 0};
    const float tiny = 0x1p-149f;
    const Vec3 corners[][3] = {
        {x, x, x}, {o, x, 2.0f * x}, {o, x, x}, {o, tiny * x, tiny * y}, {o, 0x1p-140f * x, 0x1p-140f * y}, {x, y, x}};
    for (const auto& t : corners) {
        for (const bool last : {false, true}) {
            const WoopTriangle w = make_woop_triangle(t[0], t[1], t[2], last);
            CHECK((bits_of(w.normal.x) & kLastInLeaf) == (last ? kLastInLeaf : 0));
            for (const Vec3 from : {Vec3{0, 0, 5}, Vec3{0.3f, 0.3f, 1}, Vec3{-3, 0, 0}}) {
                for (const Vec3 to : {Vec3{0, 0, -1}, Vec3{1, 0, 0}, Vec3{0.1f, -0.2f, -0.9f}}) {
                    for (const float length : {0x1p-40f, 1.0f, 0x1p25f, 0x1p40f}) {
                        TriangleHit hit;
                        CHECK_FALSE(WoopTests::intersect({from, 0, length * to, kInfinity}, w, hit));
                    }
                }
            }
        }
    }
}

TEST_CASE("unit-triangle traversals match brute force except for a few rays at edges") {
    for (const StressMesh& c : stress_meshes()) {
        if (std::string(c.name).find("soup") != 0 || c.extent != 1) continue; // there are no ties
        CAPTURE(std::string(c.name));
        const WoopBvh bvh = make_woop_bvh(build_bvh(c.triangles));
        REQUIRE(bvh.transforms.size() == bvh.triangles.size());
        const WoopBvhView view = view_of(bvh);
        const std::vector<Ray> rays = stress_rays(2000, c, 5);
        const std::vector<Hit> expected = hits_by_brute_force(c.triangles, rays, AcceptAll{});
        uint64_t differ = 0, hits = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            using Traversal = WhileWhileTraversal<TraversalOptions{.tests = TestKind::Woop}>;
            Hit hit;
            trace_closest<Traversal>(SingleTree<WoopBvhView>{view}, rays[i], AcceptAll{}, hit);
            differ += hit.instance != expected[i].instance || hit.primitive != expected[i].primitive ? 1 : 0;
            hits += hit.instance != kNoHit ? 1 : 0;
        }
        CHECK(hits > rays.size() / 10);
        CHECK(differ <= rays.size() / 20); // many of these rays aim at edges
    }
}
