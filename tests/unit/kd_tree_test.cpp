// kd-trees: the builders keep their limits of depth, memory and cost for any number of threads, and the checker
// detects broken trees.

#include <doctest/doctest.h>

#include <cstring>
#include <string>

#include "accel/clip_triangle.h"
#include "accel/kd_tree/build_kd_tree.h"
#include "base/parallel_for.h"
#include "tests/support/check_kd_tree.h"
#include "tests/support/options.h"
#include "tests/support/stress_meshes.h"
#include "tests/support/triangle_points.h"

using namespace pertev;
using namespace pertev::test;

namespace {

const KdTreeSettings kKdSettings[] = {{},
                                      {.split = KdSplit::SpatialMedian},
                                      {.split = KdSplit::SpatialMedian, .max_leaf = 1, .max_references = 40},
                                      {.max_depth = 9, .max_references = 2},
                                      {.max_depth = 0},
                                      {.max_references = 1}};

bool same(const KdTree& a, const KdTree& b) {
    return a.nodes.size() == b.nodes.size() && a.references == b.references && a.depth == b.depth &&
           a.sah_cost == b.sah_cost &&
           std::memcmp(a.nodes.data(), b.nodes.data(), a.nodes.size() * sizeof(KdTreeNode)) == 0;
}

} // namespace

TEST_CASE("kd-trees over stress meshes are valid and respect their limits") {
    for (const StressMesh& c : stress_meshes()) {
        CAPTURE(c.name);
        for (const KdTreeSettings& settings : kKdSettings) {
            CAPTURE(settings.max_references);
            CAPTURE(settings.max_depth);
            const KdTree tree = build_kd_tree(c.triangles, settings);
            const auto fault = find_fault(tree);
            CHECK_MESSAGE(!fault, *fault);
            CHECK(tree.depth <= settings.max_depth);
            CHECK(tree.references.size() <= settings.max_references * c.triangles.size());
            CHECK(tree.nodes.empty() == c.triangles.empty());
        }
    }
}

TEST_CASE("a kd-tree does not depend on the number of threads") {
    const auto mesh = make_soup(static_cast<uint32_t>(effort(20000, 200000)), 0);
    for (const KdSplit split : {KdSplit::SpatialMedian, KdSplit::Sah}) {
        const auto built_by = [&](int threads) {
            const UseThreads use(threads);
            return build_kd_tree(mesh, {.split = split});
        };
        const KdTree one = built_by(1), four = built_by(4);
        CHECK(same(one, four));
        CHECK(one.nodes.size() > 1000);
    }
}

TEST_CASE("a kd-tree by SAH is cheaper than one by medians, which is cheaper than brute force") {
    const auto mesh = triangles_of(make_torus(80, 40));
    const KdTree sah = build_kd_tree(mesh), median = build_kd_tree(mesh, {.split = KdSplit::SpatialMedian});
    const KdTree none = build_kd_tree(mesh, {.max_depth = 0});
    CHECK(sah.sah_cost < median.sah_cost);
    CHECK(median.sah_cost < 0.02f * none.sah_cost);
    CHECK(none.sah_cost == static_cast<float>(mesh.size()));
}

TEST_CASE("clipping to the cells of a grid keeps every point of a triangle and nothing outside the cell") {
    Random random(9);
    for (int i = 0; i < 3000; ++i) {
        const float scale = i % 3 == 0 ? 1.0f : (i % 3 == 1 ? 0x1p38f : 0x1p-30f);
        BvhTriangle t;
        t.a = scale * random.point(-1, 1), t.b = scale * random.point(-1, 1), t.c = scale * random.point(-1, 1);
        if (i % 4 == 0) t.c.x = t.b.x = t.a.x;                             // lies in a plane
        if (i % 8 == 0) t.a.x = t.b.x = t.c.x = 0.5f * scale;              // lies in the plane between two cells
        if (i % 5 == 0) t.c = t.a + 0x1p-20f * scale * random.direction(); // is a sliver
        const Vec3 corner = scale * Vec3{0.5f, random.within(-0.5f, 0), random.within(-0.5f, 0)};
        const double slack = clip_slack(2 * scale);
        for (int cell = 0; cell < 8; ++cell) { // the octants about a corner
            Bounds3 box = {scale * Vec3{-2, -2, -2}, scale * Vec3{2, 2, 2}};
            for (int axis = 0; axis < 3; ++axis) {
                const float at = component(corner, axis);
                box = cell >> axis & 1 ? cell_above(box, axis, at) : cell_below(box, axis, at);
            }
            const Bounds3 part = clip_triangle(t, box, slack);
            if (!part.is_empty()) {
                CHECK(min(part.lo, box.lo) == box.lo);
                CHECK(max(part.hi, box.hi) == box.hi);
            }
            for (int k = 0; k < kTrianglePoints; ++k) {
                const TrianglePoint p = triangle_point(t, k);
                bool in_cell = true, in_part = true;
                for (int axis = 0; axis < 3; ++axis) {
                    const double x = p.at[axis], rounding = 0x1p-50 * static_cast<double>(scale);
                    in_cell = in_cell && x >= static_cast<double>(component(box.lo, axis)) &&
                              x <= static_cast<double>(component(box.hi, axis));
                    in_part = in_part && x >= static_cast<double>(component(part.lo, axis)) - rounding &&
                              x <= static_cast<double>(component(part.hi, axis)) + rounding;
                }
                if (in_cell) REQUIRE(in_part);
            }
        }
    }
}

TEST_CASE("the checker detects a broken kd-tree") {
    const auto mesh = triangles_of(make_torus(20, 12));
    const KdTree sound = build_kd_tree(mesh);
    REQUIRE(!find_fault(sound));
    const auto is_noticed = [&](const auto& damage) {
        KdTree broken = sound;
        damage(broken);
        return find_fault(broken).has_value();
    };
    const auto find_node = [](const KdTree& tree, const auto& which) {
        for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
            if (which(tree.nodes[i])) return i;
        }
        FAIL("no such node");
        return tree.nodes.size();
    };
    const auto big_leaf = [](const KdTreeNode& n) { return n.is_leaf() && n.count() > 1; };
    CHECK(is_noticed([](KdTree& t) { t.depth += 1; }));
    CHECK(is_noticed([](KdTree& t) { t.references.pop_back(); }));
    CHECK(is_noticed([](KdTree& t) { t.references.push_back(0); }));
    CHECK(is_noticed([](KdTree& t) { t.nodes.push_back(make_kd_leaf(0, 0)); }));
    CHECK(is_noticed([](KdTree& t) { t.nodes.clear(); }));
    CHECK(is_noticed([](KdTree& t) { t.triangles.pop_back(); }));
    CHECK(is_noticed([](KdTree& t) { t.bounds.hi.y = 0; }));
    CHECK(is_noticed([](KdTree& t) { t.nodes[0] = make_kd_inner(0, 100.0f, t.nodes[0].above()); }));
    CHECK(is_noticed([](KdTree& t) { t.nodes[0] = make_kd_inner(t.nodes[0].axis(), t.nodes[0].plane(), 0); }));
    CHECK(is_noticed([](KdTree& t) { // the plane is moved slightly
        const float size = component(t.bounds.size(), t.nodes[0].axis());
        t.nodes[0] = make_kd_inner(t.nodes[0].axis(), t.nodes[0].plane() + 0.05f * size, t.nodes[0].above());
    }));
    CHECK(is_noticed([&](KdTree& t) { // a leaf lists a triangle twice
        const KdTreeNode leaf = t.nodes[find_node(t, big_leaf)];
        t.references[leaf.first() + 1] = t.references[leaf.first()];
    }));
    CHECK(is_noticed([&](KdTree& t) { // a leaf lists a wrong triangle
        const KdTreeNode leaf = t.nodes[find_node(t, big_leaf)];
        t.references[leaf.first() + leaf.count() - 1] = static_cast<uint32_t>(t.triangles.size()) - 1;
    }));
    CHECK(is_noticed([&](KdTree& t) { // one reference is lost
        const std::size_t at = find_node(t, big_leaf);
        const KdTreeNode leaf = t.nodes[at];
        t.references.erase(t.references.begin() + leaf.first());
        t.nodes[at] = make_kd_leaf(leaf.first(), leaf.count() - 1);
        for (std::size_t i = at + 1; i < t.nodes.size(); ++i) {
            if (t.nodes[i].is_leaf()) t.nodes[i] = make_kd_leaf(t.nodes[i].first() - 1, t.nodes[i].count());
        }
    }));
}

TEST_CASE("a kd-tree of a million triangles in a line respects its limits") {
    const auto line = stress_meshes(static_cast<uint32_t>(effort(20000, 1'000'000)))[6];
    REQUIRE(line.name == std::string("a line"));
    for (const KdSplit split : {KdSplit::SpatialMedian, KdSplit::Sah}) {
        const KdTree tree = build_kd_tree(line.triangles, {.split = split});
        const auto fault = find_fault(tree);
        CHECK_MESSAGE(!fault, *fault);
        CHECK(tree.depth <= 34);
        CHECK(tree.references.size() <= 16 * line.triangles.size());
        MESSAGE(line.triangles.size(), " in a line: depth ", tree.depth, ", nodes ", tree.nodes.size(), ", references ",
                tree.references.size(), ", cost ", tree.sah_cost);
    }
}
