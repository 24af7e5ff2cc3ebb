// The device builder makes valid trees of every mesh, with the published SAH cost and the same bytes for any number of
// threads. emulated_warps_hploc_test.cpp tests that warps make these bytes, too.

#include "tracer/hploc/device_builder.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>

#include "accel/builders/builders.h"
#include "tests/support/built_trees.h"
#include "tests/support/check_bvh.h"
#include "tests/support/check_wide_bvh.h"
#include "tests/support/options.h"
#include "tests/support/stress_meshes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

CompressedBvh build(Queue& queue, const std::vector<BvhTriangle>& triangles, bool balanced = false) {
    const auto count = static_cast<uint32_t>(triangles.size());
    const Buffer<BvhTriangle> there(queue, std::span(triangles), "triangles");
    DeviceBuilder builder(queue, count);
    builder.set_balanced(balanced);
    builder.start(there.data(), count);
    builder.finish();
    return builder.download();
}

} // namespace

TEST_CASE("trees built on the device are valid and contain each triangle once") {
    Queue queue = Queue::make_cpu();
    for (const StressMesh& mesh : builder_meshes()) {
        for (const bool balanced : {false, true}) {
            CAPTURE(mesh.name);
            CAPTURE(mesh.triangles.size());
            CAPTURE(balanced);
            const CompressedBvh bvh = build(queue, mesh.triangles, balanced);
            CHECK(bvh.triangles.size() == mesh.triangles.size());
            const auto fault = find_fault(bvh);
            CHECK_MESSAGE(!fault, fault.value_or(""));
            std::vector<bool> seen(mesh.triangles.size());
            for (const BvhTriangle& t : bvh.triangles) {
                const auto at = std::ranges::find_if(mesh.triangles, [&](const BvhTriangle& m) {
                    return m.instance == t.instance && m.primitive == t.primitive &&
                           std::memcmp(&m.a, &t.a, sizeof(Vec3)) == 0 &&
                           !seen[static_cast<std::size_t>(&m - mesh.triangles.data())];
                });
                REQUIRE(at != mesh.triangles.end());
                seen[static_cast<std::size_t>(at - mesh.triangles.begin())] = true;
            }
        }
    }
}

TEST_CASE("trees built on the device cost rays little more than those of PLOC on the host") {
    Queue queue = Queue::make_cpu();
    for (const StressMesh& mesh : stress_meshes()) {
        if (mesh.triangles.size() < 1000) continue;
        CAPTURE(mesh.name);
        const float by_host = make_compressed_bvh(build_ploc_bvh(mesh.triangles)).sah_cost;
        CHECK(build(queue, mesh.triangles).sah_cost < 1.06f * by_host);
        // A tree that halves the Morton curve ignores the triangles' boxes, so it must not be much better.
        CHECK(build(queue, mesh.triangles).sah_cost <= 1.05f * build(queue, mesh.triangles, true).sah_cost);
    }
}

TEST_CASE("a builder can be reused for meshes of other sizes") {
    Queue queue = Queue::make_cpu();
    const std::vector<BvhTriangle> large = make_soup(1000, 0), small = make_soup(40, 5);
    DeviceBuilder builder(queue, 1000);
    for (const auto* mesh : {&large, &small, &large}) {
        builder.start(mesh->data(), static_cast<uint32_t>(mesh->size()));
        CHECK(builder.finish().triangles == mesh->size());
        CHECK(are_same(builder.download(), build(queue, *mesh)));
    }
}

namespace {

/// Returns the mesh, bent.
std::vector<BvhTriangle> bent(std::vector<BvhTriangle> triangles) {
    for (BvhTriangle& t : triangles) {
        for (Vec3* p : {&t.a, &t.b, &t.c}) *p = {p->y - 3.0f, 0.5f * p->x + 0.25f * p->z, 2.0f * p->z + p->x};
    }
    return triangles;
}

/// Returns the tree over `triangles`, refitted to `moved`.
CompressedBvh refit(Queue& queue, const std::vector<BvhTriangle>& triangles, const std::vector<BvhTriangle>& moved) {
    const auto count = static_cast<uint32_t>(triangles.size());
    const Buffer<BvhTriangle> there(queue, std::span(triangles), "triangles");
    const Buffer<BvhTriangle> moved_there(queue, std::span(moved), "moved triangles");
    DeviceBuilder builder(queue, count);
    builder.start(there.data(), count);
    builder.finish();
    for (int i = 0; i < 2; ++i) builder.start_refit(moved_there.data()); // the second uses memory left by the first
    builder.finish();
    return builder.download();
}

} // namespace

TEST_CASE("a tree refitted to unmoved triangles has the bytes of the build") {
    Queue queue = Queue::make_cpu();
    for (const StressMesh& mesh : builder_meshes()) {
        CAPTURE(mesh.name);
        CHECK(are_same(refit(queue, mesh.triangles, mesh.triangles), build(queue, mesh.triangles)));
    }
}

TEST_CASE("a tree refitted to moved triangles is valid, with tight boxes and the same leaves") {
    Queue queue = Queue::make_cpu();
    for (const StressMesh& mesh : builder_meshes()) {
        CAPTURE(mesh.name);
        const std::vector<BvhTriangle> moved = bent(mesh.triangles);
        const CompressedBvh bvh = refit(queue, mesh.triangles, moved), built = build(queue, mesh.triangles);
        const auto fault = find_fault(bvh);
        CHECK_MESSAGE(!fault, fault.value_or(""));
        Bounds3 bounds;
        for (const BvhTriangle& t : moved) {
            for (const Vec3 p : {t.a, t.b, t.c}) bounds.extend(p);
        }
        CHECK(bvh.bounds == bounds);
        REQUIRE(bvh.triangles.size() == built.triangles.size());
        for (std::size_t i = 0; i < bvh.triangles.size(); ++i) {
            CHECK(bvh.triangles[i].primitive == built.triangles[i].primitive);
            CHECK(bvh.triangles[i].flags == built.triangles[i].flags);
        }
    }
}

TEST_CASE("a GPU builds the bytes that the CPU builds") {
    if (!cuda_requested()) return;
    Queue cpu = Queue::make_cpu(), gpu = Queue::make_cuda(0);
    std::vector<StressMesh> all = builder_meshes();
    all.push_back({"a large soup", make_soup(100001, 0), {}});
    for (const StressMesh& mesh : all) {
        CAPTURE(mesh.name);
        CAPTURE(mesh.triangles.size());
        for (const bool balanced : {false, true}) {
            const CompressedBvh wanted = build(cpu, mesh.triangles, balanced);
            CHECK(are_same(build(gpu, mesh.triangles, balanced), wanted));
            CHECK(are_same(build(gpu, mesh.triangles, balanced), wanted)); // the order of warps differs
        }
        const std::vector<BvhTriangle> moved = bent(mesh.triangles);
        CHECK(are_same(refit(gpu, mesh.triangles, moved), refit(cpu, mesh.triangles, moved)));
    }
}
