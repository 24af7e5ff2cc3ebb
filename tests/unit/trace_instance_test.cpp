// Instances against the same triangles, which the test moves into world space in double precision. transform_ray must
// not change t. (tests/consistency compares traversals bit for bit, but all of them transform the ray alike.)

#include <vector>

#include <doctest/doctest.h>

#include "accel/builders/build_bvh.h"
#include "accel/bvh/tlas.h"
#include "math/transform.h"
#include "tests/support/meshes.h"
#include "trace/trace_any.h"
#include "trace/trace_closest.h"

using namespace pertev;

namespace {

/// Returns the transformed point, in double precision.
struct Point {
    double x, y, z;
};
Point moved(const Transform& m, Vec3 p) {
    const auto row = [&](Vec3 r, float t) {
        return double(r.x) * double(p.x) + double(r.y) * double(p.y) + double(r.z) * double(p.z) + double(t);
    };
    return {row(m.row0, m.translation.x), row(m.row1, m.translation.y), row(m.row2, m.translation.z)};
}

} // namespace

TEST_CASE("a hit on an instance has the t, u and v of the transformed triangles") {
    const test::TriangleMesh torus = test::make_torus(24, 16);
    const Bvh tree = build_bvh(test::triangles_of(torus));
    const BvhView view = view_of(tree);
    const Transform places[] = {
        {},
        make_scale({4, 4, 4}),
        compose(make_translation({3, -1, 2}), make_scale({0.25f, 0.25f, 0.25f})),
        compose(make_rotation(0.5f, 0.5f, 0.5f, 0.5f), make_scale({2, 0.5f, -3})),
    };
    test::Random random(9);
    for (const Transform& place : places) {
        const PlacedBvh placed[] = {{place, tree.bounds, 0, 5}};
        const Tlas top = build_tlas(placed);
        const SceneBvhView scene = {{}, top.nodes.data(), top.instances.data(), &view, top.root, top.reach, top.growth};
        std::vector<BvhTriangle> baked = test::triangles_of(torus, 5);
        for (BvhTriangle& triangle : baked) {
            for (Vec3* corner : {&triangle.a, &triangle.b, &triangle.c}) {
                const Point p = moved(place, *corner);
                *corner = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
            }
        }
        uint32_t hits = 0, differ = 0;
        for (int i = 0; i < 2000; ++i) {
            const Vec3 target = baked[random.below(static_cast<uint32_t>(baked.size()))].a;
            Ray ray;
            ray.origin = place.translation + random.point(-6, 6);
            ray.direction = random.within(0.5f, 3.0f) * (target + random.point(-0.1f, 0.1f) - ray.origin);
            Hit hit, wanted;
            trace_closest(scene, ray, AcceptAll{}, hit);
            test::trace_by_brute_force(baked, ray, kNoHit, AcceptAll{}, wanted);
            hits += wanted.instance != kNoHit;
            // At an edge a neighbour may be hit, with the same t.
            const bool same = hit.instance == wanted.instance &&
                              (hit.instance == kNoHit || pertev::abs(hit.t - wanted.t) <= 1e-3f * wanted.t);
            differ += !same;
            if (!same || hit.instance == kNoHit) continue;
            Ray shorter = ray;
            shorter.t_max = 0.99f * wanted.t;
            CHECK_FALSE(trace_any(scene, shorter, AcceptAll{}));
            shorter.t_max = 1.01f * wanted.t;
            CHECK(trace_any(scene, shorter, AcceptAll{}));
        }
        CHECK(hits > 1000);
        CHECK(differ <= 10); // at grazing angles one of the two may miss an edge
    }
}
