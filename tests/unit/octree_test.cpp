// Octrees: the builder keeps its limits of depth and memory for any number of threads, and the checker detects broken
// trees.

#include <doctest/doctest.h>

#include <cstring>
#include <string>

#include "accel/octree/build_octree.h"
#include "base/parallel_for.h"
#include "tests/support/check_octree.h"
#include "tests/support/options.h"
#include "tests/support/stress_meshes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

const OctreeSettings kOctreeSettings[] = {{},
                                          {.max_leaf = 1},
                                          {.max_depth = 20, .max_leaf = 1, .max_references = 50},
                                          {.max_depth = 4, .max_references = 2},
                                          {.max_depth = 0},
                                          {.max_references = 1}};

} // namespace

TEST_CASE("octrees over stress meshes are valid and respect their limits") {
    for (const StressMesh& c : stress_meshes()) {
        CAPTURE(c.name);
        for (const OctreeSettings& settings : kOctreeSettings) {
            CAPTURE(settings.max_references);
            CAPTURE(settings.max_depth);
            const Octree tree = build_octree(c.triangles, settings);
            const auto fault = find_fault(tree);
            CHECK_MESSAGE(!fault, *fault);
            CHECK(tree.depth <= settings.max_depth);
            CHECK(tree.references.size() <= settings.max_references * c.triangles.size());
            CHECK(tree.nodes.empty() == c.triangles.empty());
            if (settings.max_depth > 0 && settings.max_references >= 16 && c.triangles.size() > 500)
                CHECK(tree.depth > 2);
        }
    }
}

TEST_CASE("an octree can be built over a point, a line, and bounds at any position and of any size") {
    const Vec3 places[] = {
        {0, 0, 0}, {-0x1p40f, 0x1p40f, 0x1.fffffep39f}, {0x1p-140f, -0x1p-140f, 0}, {3, -0x1p30f, 1}};
    const float sizes[] = {0, 0x1p-149f, 0x1p-100f, 1e-6f, 1, 0x1p39f};
    for (const Vec3 place : places) {
        for (const float size : sizes) {
            std::vector<BvhTriangle> mesh;
            Random random(4);
            for (uint32_t i = 0; i < 100; ++i) {
                const auto corner = [&] { return place + size * random.point(-1, 1); };
                const Vec3 a = corner(), b = corner();
                const auto in_range = [](Vec3 p) {
                    return max(min(p, Vec3{0x1p40f, 0x1p40f, 0x1p40f}), Vec3{-0x1p40f, -0x1p40f, -0x1p40f});
                };
                mesh.push_back({in_range(a), i, in_range(b), 0, i % 2 ? in_range(a) : in_range(corner()), 0});
            }
            const auto fault = find_fault(build_octree(mesh, {.max_depth = 20, .max_leaf = 1}));
            CHECK_MESSAGE(!fault, *fault, " size ", size, " at ", place.x);
        }
    }
}

TEST_CASE("an octree does not depend on the number of threads") {
    const auto mesh = make_soup(static_cast<uint32_t>(effort(30000, 200000)), 0);
    const auto built_by = [&](int threads) {
        const UseThreads use(threads);
        return build_octree(mesh);
    };
    const Octree one = built_by(1), four = built_by(4);
    CHECK(!find_fault(four));
    CHECK(one.nodes.size() > mesh.size() / 16);
    CHECK(one.depth == four.depth);
    CHECK(one.sah_cost == four.sah_cost);
    // Subtrees that are built in parallel have positions that depend on their sizes, not on the threads.
    REQUIRE(one.nodes.size() == four.nodes.size());
    CHECK(std::memcmp(one.nodes.data(), four.nodes.data(), one.nodes.size() * sizeof(OctreeNode)) == 0);
    CHECK(one.references == four.references);
}

TEST_CASE("an octree is cheaper than brute force") {
    const auto mesh = triangles_of(make_torus(80, 40));
    const Octree tree = build_octree(mesh), none = build_octree(mesh, {.max_depth = 0});
    CHECK(tree.sah_cost < 0.03f * none.sah_cost);
    CHECK(none.sah_cost == static_cast<float>(mesh.size()));
}

TEST_CASE("the checker detects a broken octree") {
    const auto mesh = triangles_of(make_torus(20, 12));
    const Octree sound = build_octree(mesh);
    REQUIRE(!find_fault(sound));
    const auto is_noticed = [&](const auto& damage) {
        Octree broken = sound;
        damage(broken);
        return find_fault(broken).has_value();
    };
    std::size_t big = 0;
    while (!(sound.nodes[big].is_leaf() && sound.nodes[big].count() > 1)) ++big;
    const OctreeNode leaf = sound.nodes[big];
    CHECK(is_noticed([](Octree& t) { t.depth += 1; }));
    CHECK(is_noticed([](Octree& t) { t.references.pop_back(); }));
    CHECK(is_noticed([](Octree& t) { t.references.push_back(0); }));
    CHECK(is_noticed([](Octree& t) { t.nodes.push_back({0, kLeafBit}); }));
    CHECK(is_noticed([](Octree& t) { t.nodes.clear(); }));
    CHECK(is_noticed([](Octree& t) { t.triangles.pop_back(); }));
    CHECK(is_noticed([](Octree& t) { t.bounds.hi.y = 0; }));
    CHECK(is_noticed([](Octree& t) { t.bounds.hi.y = 1e6f; }));
    CHECK(is_noticed([](Octree& t) { t.corner.x += 1e-7f; }));
    CHECK(is_noticed([](Octree& t) { t.side *= 2; }));
    CHECK(is_noticed([](Octree& t) { t.nodes[0].first = 0; }));
    CHECK(is_noticed([](Octree& t) { t.nodes[0].link = 0; }));
    CHECK(is_noticed([](Octree& t) { t.nodes[0].link |= 0x100; }));
    CHECK(is_noticed([&](Octree& t) { t.nodes[big].first += 1; }));
    CHECK(is_noticed([&](Octree& t) { t.nodes[big].link -= 1; }));
    CHECK(is_noticed([&](Octree& t) { t.references[leaf.first + 1] = t.references[leaf.first]; }));
    CHECK(is_noticed([&](Octree& t) {
        t.references[leaf.first + leaf.count() - 1] = static_cast<uint32_t>(t.triangles.size()) - 1;
    }));
    CHECK(is_noticed([&](Octree& t) { // one reference is lost
        t.references.erase(t.references.begin() + leaf.first);
        for (OctreeNode& n : t.nodes) {
            if (n.is_leaf() && n.first > leaf.first) --n.first;
        }
        t.nodes[big].link -= 1;
    }));
}

TEST_CASE("an octree of a million triangles in a line respects its limits") {
    const auto line = stress_meshes(static_cast<uint32_t>(effort(20000, 1'000'000)))[6];
    REQUIRE(line.name == std::string("a line"));
    const Octree tree = build_octree(line.triangles);
    const auto fault = find_fault(tree);
    CHECK_MESSAGE(!fault, *fault);
    CHECK(tree.depth <= 16);
    CHECK(tree.references.size() <= 16 * line.triangles.size());
    MESSAGE(line.triangles.size(), " in a line: depth ", tree.depth, ", nodes ", tree.nodes.size(), ", references ",
            tree.references.size(), ", cost ", tree.sah_cost);
}
