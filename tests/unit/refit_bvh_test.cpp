// A refitted tree is valid, and traversals find the hits of a newly built one.

#include "accel/builders/refit_bvh.h"

#include <doctest/doctest.h>

#include <cstring>

#include "accel/builders/build_bvh.h"
#include "accel/bvh/compressed_bvh.h"
#include "accel/bvh/wide_bvh.h"
#include "base/error.h"
#include "base/parallel_for.h"
#include "tests/support/check_bvh.h"
#include "tests/support/check_traversal.h"
#include "tests/support/check_wide_bvh.h"
#include "tracer/binary_trees.h"

using namespace pertev;
using namespace pertev::test;

namespace {

/// Numbers the primitives of one instance from 0, as in scenes.
std::vector<BvhTriangle> numbered(std::vector<BvhTriangle> triangles) {
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        triangles[i].primitive = static_cast<uint32_t>(i), triangles[i].instance = 0;
    }
    return triangles;
}

/// Rotates about z, scales along z, and shears.
std::vector<BvhTriangle> deformed(std::vector<BvhTriangle> triangles) {
    for (BvhTriangle& t : triangles) {
        for (Vec3* p : {&t.a, &t.b, &t.c}) *p = {p->y + 0.25f * p->z, -p->x, 0.5f * p->z};
    }
    return triangles;
}

} // namespace

TEST_CASE("a refitted tree of each builder is valid and matches brute force on stress meshes") {
    for (const StressMesh& stress : stress_meshes()) {
        CAPTURE(stress.name);
        const std::vector<BvhTriangle> before = numbered(stress.triangles), after = deformed(before);
        StressMesh mesh = stress;
        mesh.triangles = after;
        mesh.centre = {stress.centre.y + 0.25f * stress.centre.z, -stress.centre.x, 0.5f * stress.centre.z};
        const std::vector<Ray> rays = stress_rays(500, mesh, 41);
        const std::vector<Hit> hits = hits_by_brute_force(after, rays, AcceptAll{});
        for (const BvhBuilder builder : kValuesOf<BvhBuilder>) {
            CAPTURE(std::string(name_of(builder)));
            const Bvh refitted = refit_bvh(build_bvh(builder, before), after);
            const auto fault = cuts_triangles(builder) ? find_split_fault(refitted, after) : find_fault(refitted);
            CHECK_MESSAGE(!fault, fault.value_or(""));
            CHECK(is_finite(refitted.sah_cost));
            check_traversal(scene_of(view_of(refitted)), rays, hits, AcceptAll{});
        }
    }
}

TEST_CASE("a tree refitted to unmoved triangles equals the built one") {
    const std::vector<BvhTriangle> triangles = triangles_of(make_torus(80, 60));
    for (const BvhBuilder builder : {BvhBuilder::Binned, BvhBuilder::Reinsertion}) {
        const Bvh built = build_bvh(builder, triangles);
        for (const int threads : {1, 5}) {
            const UseThreads use(threads);
            const Bvh refitted = refit_bvh(refit_bvh(built, deformed(triangles)), triangles);
            CHECK(std::memcmp(refitted.nodes.data(), built.nodes.data(), built.nodes.size() * sizeof(BvhNode)) == 0);
            CHECK(std::memcmp(refitted.triangles.data(), built.triangles.data(),
                              built.triangles.size() * sizeof(BvhTriangle)) == 0);
            CHECK(refitted.bounds == built.bounds);
            CHECK(refitted.sah_cost == doctest::Approx(built.sah_cost).epsilon(1e-4));
        }
    }
}

TEST_CASE("a tree is not refitted to other triangles, and trees with split triangles are refused with the reason") {
    const std::vector<BvhTriangle> triangles = triangles_of(make_torus(20, 10));
    std::vector<BvhTriangle> fewer = triangles;
    fewer.pop_back();
    CHECK_THROWS_AS(refit_bvh(build_bvh(triangles), fewer), Error);
    for (const BvhBuilder builder : kValuesOf<BvhBuilder>)
        CHECK(why_no_refit(builder).has_value() == cuts_triangles(builder));
}

TEST_CASE("an update shares unchanged trees, refits deformed ones and rebuilds those that refitting degraded") {
    const std::vector<BvhTriangle> torus = triangles_of(make_torus(40, 30));
    SceneTriangles before;
    before.baked = torus;
    before.meshes = {torus, torus, torus};
    const auto soup = [&] { // moves the triangles to random positions
        std::vector<BvhTriangle> moved = torus;
        for (BvhTriangle& t : moved) {
            const Vec3 by = {static_cast<float>(t.primitive * 7919u % 101u), static_cast<float>(t.primitive % 97u), 0};
            t.a = t.a + by, t.b = t.b + by, t.c = t.c + by;
        }
        return moved;
    };
    SceneTriangles after;
    after.meshes = {deformed(torus), soup(), triangles_of(make_torus(10, 10))};
    const std::vector<PartChange> changes = {PartChange::None, PartChange::Deformed, PartChange::Deformed,
                                             PartChange::Replaced};
    for (const BvhBuilder builder : kValuesOf<BvhBuilder>) {
        CAPTURE(std::string(name_of(builder)));
        const BinaryTrees built = build_binary_trees(before, builder);
        const BinaryTrees updated = update_binary_trees(built, builder, changes, after);
        CHECK(updated.parts[0] == built.parts[0]);
        const auto same_links = [](const Bvh& a, const Bvh& b) {
            for (std::size_t i = 0; i < a.nodes.size() && i < b.nodes.size(); ++i) {
                if (a.nodes[i].child[0] != b.nodes[i].child[0] || a.nodes[i].child[1] != b.nodes[i].child[1])
                    return false;
            }
            return a.nodes.size() == b.nodes.size();
        };
        if (cuts_triangles(builder)) {
            CHECK(updated.builders[1] == kRefittedBuilder);
            const BinaryTrees again = update_binary_trees(updated, builder, changes, after);
            CHECK(same_links(*again.parts[1], *updated.parts[1])); // the tree is refitted from now on
        } else {
            CHECK(same_links(*updated.parts[1], *built.parts[1]));
            CHECK(updated.builders[1] == builder);
        }
        CHECK(updated.builders[3] == builder);
        CHECK(updated.parts[2]->sah_cost <= kMaxRefitCost * updated.built_cost[2]);
        CHECK(updated.parts[3]->sah_cost == build_bvh(builder, after.meshes[2]).sah_cost);
        CHECK(updated.triangle_count() == 3 * torus.size() + after.meshes[2].size());
    }
}
