// For all triangles and settings the builder gives a valid tree: every box contains its subtree, each triangle is
// reached once, the stack suffices, and the result is deterministic.

#include "accel/builders/build_bvh.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <tuple>

#include "accel/bvh/tlas.h"
#include "base/error.h"
#include "base/limits.h"
#include "base/parallel_for.h"
#include "tests/support/bvh_bytes.h"
#include "tests/support/check_bvh.h"
#include "tests/support/meshes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

struct NamedTriangles {
    const char* name;
    std::vector<BvhTriangle> triangles;
};

std::vector<BvhTriangle> points(uint32_t count, auto&& point) {
    std::vector<BvhTriangle> triangles(count);
    for (uint32_t i = 0; i < count; ++i) {
        const Vec3 p = point(i);
        triangles[i] = {p, i, p, 0, p, 0};
    }
    return triangles;
}

std::vector<BvhTriangle> random_triangles(uint32_t count, float size, float scale) {
    Random random(1);
    std::vector<BvhTriangle> triangles(count);
    for (uint32_t i = 0; i < count; ++i) {
        const Vec3 at = random.point(-1, 1);
        const auto corner = [&] { return scale * (at + random.point(-size, size)); };
        triangles[i].a = corner();
        triangles[i].b = corner();
        triangles[i].c = corner();
        triangles[i].primitive = i;
    }
    return triangles;
}

std::vector<NamedTriangles> hard_inputs() {
    return {{"none", {}},
            {"one", random_triangles(1, 0.1f, 1)},
            {"two", random_triangles(2, 0.1f, 1)},
            {"five", random_triangles(5, 0.1f, 1)},
            {"random", random_triangles(20000, 0.02f, 1)},
            {"random and large", random_triangles(5000, 2, 1)},
            {"all at one point", points(5000,
                                        [](uint32_t) {
                                            return Vec3{1, 2, 3};
                                        })},
            {"all at the origin, of both signs",
             points(5000,
                    [](uint32_t i) {
                        return i % 2 ? Vec3{0.0f, -0.0f, 0.0f} : Vec3{-0.0f, 0.0f, -0.0f};
                    })},
            {"two points", points(5000,
                                  [](uint32_t i) {
                                      return Vec3{i % 2 ? 1.0f : 0.0f, 0, 0};
                                  })},
            {"neighbouring floats", points(5000,
                                           [](uint32_t i) {
                                               return Vec3{1 + static_cast<float>(i % 3) * 0x1p-23f, 0, 0};
                                           })},
            {"denormals", points(5000,
                                 [](uint32_t i) {
                                     return Vec3{static_cast<float>(i) * 0x1p-149f, 0, 0};
                                 })},
            {"line", points(30000,
                            [](uint32_t i) {
                                return Vec3{0, static_cast<float>(i), 0};
                            })},
            {"each twice as far as the last", // the SAH separates one box at a time
             points(160,
                    [](uint32_t i) {
                        return Vec3{float_of((i + 7) << 23), 0, 0};
                    })},
            {"the largest coordinates", random_triangles(5000, 1, 0.5f * kMaxCoordinate)}};
}

const BvhBuildSettings kSettings[] = {{},
                                      {.bins = 2, .max_leaf = 1},
                                      {.bins = 64, .max_leaf = 1},
                                      {.bins = 16, .max_leaf = 255, .leaf_cost = 1e-3f},
                                      {.max_leaf = 8, .node_cost = 0},
                                      {.max_leaf = 8, .node_cost = 100},
                                      {.max_leaf = 4, .max_depth = 13}};

} // namespace

TEST_CASE("every tree is valid for all triangles and settings") {
    for (const NamedTriangles& input : hard_inputs()) {
        CAPTURE(input.name);
        for (const BvhBuildSettings& settings : kSettings) {
            CAPTURE(settings.bins);
            CAPTURE(settings.max_leaf);
            const Bvh bvh = build_bvh(input.triangles, settings);
            const auto fault = find_fault(bvh);
            CHECK_MESSAGE(!fault, fault.value_or(""));
            CHECK(bvh.depth <= settings.max_depth);
            CHECK(largest_leaf(bvh) <= settings.max_leaf);
            CHECK(bvh.nodes.size() < std::max<std::size_t>(input.triangles.size(), 1));
            CHECK(is_finite(bvh.sah_cost));

            // Builds over the triangles in another order.
            const auto key = [](const BvhTriangle& t) { return std::tuple(t.primitive, t.a.x, t.b.y, t.c.z); };
            REQUIRE(bvh.triangles.size() == input.triangles.size());
            std::vector<BvhTriangle> sorted = bvh.triangles;
            std::sort(sorted.begin(), sorted.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
            uint64_t changed = 0;
            for (std::size_t i = 0; i < sorted.size(); ++i)
                changed += key(sorted[i]) != key(input.triangles[i]) ? 1 : 0;
            CHECK(changed == 0);
        }
    }
}

TEST_CASE("the builder keeps flags that it does not own") {
    std::vector<BvhTriangle> triangles = random_triangles(100, 0.1f, 1);
    for (BvhTriangle& t : triangles) t.flags = (t.primitive << 1) | kLastInLeaf; // a flag of an earlier tree
    const Bvh bvh = build_bvh(triangles);
    CHECK(!find_fault(bvh));
    for (const BvhTriangle& t : bvh.triangles) CHECK((t.flags >> 1) == t.primitive);
}

TEST_CASE("the tree does not depend on the number of threads") {
    const std::vector<BvhTriangle> triangles = random_triangles(200000, 0.01f, 1);
    const auto built_by = [&](int threads) {
        const UseThreads use(threads);
        return build_bvh(triangles);
    };
    const Bvh one = built_by(1);
    for (const int threads : {2, 5}) {
        const Bvh more = built_by(threads);
        CHECK(same_bytes(one.nodes, more.nodes));
        CHECK(same_bytes(one.triangles, more.triangles));
        CHECK(one.sah_cost == more.sah_cost);
    }
    CHECK(!find_fault(one));
}

TEST_CASE("splitting by cost visits fewer boxes than splitting by count") {
    const std::vector<BvhTriangle> triangles = triangles_of(make_torus(200, 100));
    const Bvh by_cost = build_bvh(triangles);
    const Bvh by_count = build_bvh(triangles, {.max_leaf = 4, .max_depth = 14}); // forces equal cuts at every level
    CHECK(by_cost.sah_cost < 0.9f * by_count.sah_cost);
    CHECK(by_count.depth <= 14);
}

TEST_CASE("more triangles than a tree can hold are refused") {
    CHECK_THROWS_AS(build_bvh(random_triangles(33, 0.1f, 1), {.max_leaf = 4, .max_depth = 3}), Error);
    CHECK(build_bvh(random_triangles(32, 0.1f, 1), {.max_leaf = 4, .max_depth = 3}).depth == 3);
}

TEST_CASE("the checker finds faults in a tree") {
    const Bvh good = build_bvh(random_triangles(500, 0.1f, 1));
    REQUIRE(!find_fault(good));
    const auto broken = [&](auto&& change) {
        Bvh bvh = good;
        change(bvh);
        return find_fault(bvh).has_value();
    };
    CHECK(broken([](Bvh& b) { b.nodes[3].child[0] = static_cast<uint32_t>(b.nodes.size()); }));
    CHECK(broken([](Bvh& b) { b.nodes[3].child[0] = 0; }));
    CHECK(broken([](Bvh& b) { b.nodes[3].child[1] = kNoLink; }));
    CHECK(broken([](Bvh& b) { b.nodes[3].child[1] = b.nodes[3].child[0]; }));
    CHECK(broken([](Bvh& b) { b.nodes.push_back(b.nodes[0]); }));
    CHECK(broken([](Bvh& b) { b.triangles.push_back(b.triangles[0]); }));
    CHECK(broken([](Bvh& b) { b.triangles.back().flags &= ~kLastInLeaf; }));
    CHECK(broken([](Bvh& b) { b.triangles[7].a.x += 10; }));
    CHECK(broken([](Bvh& b) { b.depth += 1; }));
    CHECK(broken([](Bvh& b) { b.root = kNoLink; }));
    CHECK(broken([](Bvh& b) { b.nodes[0].x[0] = kInfinity; }));
}

TEST_CASE("the TLAS boxes contain every instance's triangles, and its reach bounds their transforms") {
    Random random(2);
    const std::vector<BvhTriangle> mesh = triangles_of(make_torus(12, 8));
    const Bvh bvh = build_bvh(mesh);
    std::vector<PlacedBvh> placed;
    for (uint32_t i = 0; i < 1000; ++i) {
        const Vec3 axis = random.direction();
        const Transform turn = make_rotation(0.6f * axis.x, 0.6f * axis.y, 0.6f * axis.z, 0.8f);
        placed.push_back({compose(make_translation(random.point(-100, 100)), turn), bvh.bounds, 0, i});
    }
    placed.push_back({{}, {}, 0, 1000}); // an empty mesh
    const Tlas top = build_tlas(placed);
    REQUIRE(top.instances.size() == 1000);
    CHECK(top.depth <= kMaxTlasDepth);
    std::vector<Bounds3> boxes(top.instances.size());
    std::vector<int> seen(top.instances.size());
    for (const BvhNode& node : top.nodes) {
        for (int k = 0; k < 2; ++k) {
            if (!(node.child[k] & kLeafBit)) continue;
            boxes[node.child[k] & ~kLeafBit] = child_bounds(node, k);
            ++seen[node.child[k] & ~kLeafBit];
        }
    }
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        CHECK(seen[i] == 1);
        const Transform& m = placed[top.instances[i].instance].world_from_local;
        for (const BvhTriangle& t : mesh) {
            Bounds3 grown = boxes[i];
            const Vec3 p = transform_point(m, t.a); // itself rounded
            const float e = 0x1p-20f * top.reach * top.growth;
            grown.extend(grown.lo - Vec3{e, e, e});
            grown.extend(grown.hi + Vec3{e, e, e});
            Bounds3 with_point = grown;
            with_point.extend(p);
            REQUIRE(with_point == grown);
            REQUIRE(max_component(abs(p)) <= top.reach * (1 + 0x1p-20f));
        }
    }
}
