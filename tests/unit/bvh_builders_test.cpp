// Every builder of the laboratory gives, on meshes made to break them, a sound tree that does not depend on threads and
// in which walks find what testing every triangle finds; and each is as good as its kind should be.

#include "accel/bvh/builders.h"

#include <doctest/doctest.h>

#include <cstring>

#include "accel/bvh/check_bvh.h"
#include "base/limits.h"
#include "base/parallel_for.h"
#include "base/stopwatch.h"
#include "tests/support/check_walk.h"
#include "tests/support/nasty_meshes.h"
#include "tests/support/options.h"

using namespace pertev;
using namespace pertev::test;

namespace {

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

int largest_leaf(const Bvh& bvh) {
    int largest = 0, run = 0;
    for (const BvhTriangle& t : bvh.triangles) {
        largest = std::max(largest, ++run);
        if (t.flags & kLastInLeaf) run = 0;
    }
    return largest;
}

std::string name_of(BvhBuilder builder) { return bvh_builder_name(builder); }

std::optional<std::string> fault_of(BvhBuilder builder, const Bvh& bvh, const std::vector<BvhTriangle>& mesh) {
    if (cuts_triangles(builder)) return find_split_fault(bvh, mesh);
    if (bvh.triangles.size() != mesh.size()) return "not as many triangles as the mesh";
    const auto fault = find_fault(bvh);
    return fault ? fault : find_split_fault(bvh, mesh); // that each is one of the mesh's
}

} // namespace

TEST_CASE("every builder has a name of its own") {
    for (const BvhBuilder builder : kBvhBuilders) CHECK(find_bvh_builder(bvh_builder_name(builder)) == builder);
    CHECK(!find_bvh_builder("no such builder"));
}

TEST_CASE("every builder gives a sound tree on every nasty mesh") {
    for (const NastyMesh& mesh : nasty_meshes()) {
        CAPTURE(mesh.name);
        for (const BvhBuilder builder : kBvhBuilders) {
            CAPTURE(name_of(builder));
            for (const int max_leaf : {1, 4}) {
                const Bvh bvh = build_bvh(builder, mesh.triangles, {.max_leaf = max_leaf});
                const auto fault = fault_of(builder, bvh, mesh.triangles);
                CHECK_MESSAGE(!fault, fault.value_or(""));
                CHECK(largest_leaf(bvh) <= max_leaf);
                CHECK(is_finite(bvh.sah_cost));
            }
        }
    }
}

TEST_CASE("no builder's tree depends on the number of threads") {
    std::vector<std::vector<BvhTriangle>> meshes;
    for (NastyMesh& mesh : nasty_meshes()) meshes.push_back(std::move(mesh.triangles));
    meshes.push_back(triangles_of(make_torus(200, 120))); // large enough for the builders to share the work
    for (const BvhBuilder builder : kBvhBuilders) {
        CAPTURE(name_of(builder));
        for (const std::vector<BvhTriangle>& triangles : meshes) {
            set_thread_count(1);
            const Bvh one = build_bvh(builder, triangles);
            set_thread_count(5);
            const Bvh more = build_bvh(builder, triangles);
            CHECK(same_bytes(one.nodes, more.nodes));
            CHECK(same_bytes(one.triangles, more.triangles));
            CHECK(one.sah_cost == more.sah_cost);
        }
    }
    set_thread_count(0);
}

TEST_CASE("walks find in the tree of any builder what testing every triangle finds, bit for bit") {
    for (const NastyMesh& mesh : nasty_meshes()) {
        CAPTURE(mesh.name);
        const std::vector<Ray> rays = nasty_rays(1000, mesh, 29);
        const std::vector<Hit> all = hits_by_brute_force(mesh.triangles, rays, AcceptAll{});
        const std::vector<Hit> some = hits_by_brute_force(mesh.triangles, rays, AcceptSome{});
        for (const BvhBuilder builder : kBvhBuilders) {
            CAPTURE(name_of(builder));
            const Bvh bvh = build_bvh(builder, mesh.triangles);
            check_walk(scene_of(view_of(bvh)), rays, all, AcceptAll{});
            check_walk(scene_of(view_of(bvh)), rays, some, AcceptSome{});
        }
    }
}

TEST_CASE("no builder's tree is deeper than walks go, however long the line") {
    std::vector<BvhTriangle> line;
    for (NastyMesh& mesh : nasty_meshes(static_cast<uint32_t>(effort(20'000, 1'000'000)))) {
        if (std::string_view(mesh.name) == "a line") line = std::move(mesh.triangles);
    }
    REQUIRE(!line.empty());
    std::vector<BvhTriangle> doubling; // cuts by cost, and clusters, peel off one triangle at a time
    for (uint32_t i = 0; i < 250; ++i) {
        const Vec3 p = {float_of((i / 2 + 30) << 23), 0, 0};
        doubling.push_back({p, i, p, 0, {p.x, p.x, p.x}, 0});
    }
    for (const BvhBuilder builder : kBvhBuilders) {
        CAPTURE(name_of(builder));
        for (const std::vector<BvhTriangle>* triangles : {&line, &doubling}) {
            const Stopwatch time;
            const Bvh bvh = build_bvh(builder, *triangles, {.max_leaf = 1});
            MESSAGE(name_of(builder), ": ", triangles->size(), " triangles, depth ", bvh.depth, ", ", time.seconds(),
                    " s");
            const auto fault = fault_of(builder, bvh, *triangles); // also holds the depth to kMaxBvhDepth
            CHECK_MESSAGE(!fault, fault.value_or(""));
        }
    }
}
