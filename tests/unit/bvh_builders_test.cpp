// Every builder of the laboratory makes a valid tree of degenerate meshes, which does not depend on threads.
// Traversals of it find the hits of brute force, and its SAH cost is as good as published.

#include "accel/builders/builders.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <string_view>

#include "accel/builders/binary_tree.h"
#include "accel/builders/build_bvh.h"
#include "accel/builders/cut_triangle.h"
#include "base/limits.h"
#include "base/parallel_for.h"
#include "base/stopwatch.h"
#include "tests/support/bvh_bytes.h"
#include "tests/support/check_bvh.h"
#include "tests/support/check_traversal.h"
#include "tests/support/options.h"
#include "tests/support/stress_meshes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

std::optional<std::string> fault_of(BvhBuilder builder, const Bvh& bvh, const std::vector<BvhTriangle>& mesh) {
    if (cuts_triangles(builder)) return find_split_fault(bvh, mesh);
    if (bvh.triangles.size() != mesh.size()) return "not as many triangles as the mesh";
    const auto fault = find_fault(bvh);
    return fault ? fault : find_split_fault(bvh, mesh); // each must be a triangle of the mesh
}

} // namespace

TEST_CASE("every builder makes a valid tree of every stress mesh") {
    for (const StressMesh& mesh : stress_meshes()) {
        CAPTURE(mesh.name);
        for (const BvhBuilder builder : kValuesOf<BvhBuilder>) {
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
    for (StressMesh& mesh : stress_meshes()) meshes.push_back(std::move(mesh.triangles));
    meshes.push_back(triangles_of(make_torus(110, 80))); // large enough for the builders to share the work
    for (const BvhBuilder builder : kValuesOf<BvhBuilder>) {
        CAPTURE(name_of(builder));
        for (const std::vector<BvhTriangle>& triangles : meshes) {
            const auto built_by = [&](int threads) {
                const UseThreads use(threads);
                return build_bvh(builder, triangles);
            };
            const Bvh one = built_by(1), more = built_by(5);
            CHECK(same_bytes(one.nodes, more.nodes));
            CHECK(same_bytes(one.triangles, more.triangles));
            CHECK(one.sah_cost == more.sah_cost);
        }
    }
}

TEST_CASE("traversals of any builder's tree match brute force bit for bit") {
    for (const StressMesh& mesh : stress_meshes()) {
        CAPTURE(mesh.name);
        const std::vector<Ray> rays = stress_rays(1000, mesh, 29);
        const std::vector<Hit> all = hits_by_brute_force(mesh.triangles, rays, AcceptAll{});
        const std::vector<Hit> some = hits_by_brute_force(mesh.triangles, rays, AcceptSome{});
        for (const BvhBuilder builder : kValuesOf<BvhBuilder>) {
            CAPTURE(name_of(builder));
            const Bvh bvh = build_bvh(builder, mesh.triangles);
            check_traversal(scene_of(view_of(bvh)), rays, all, AcceptAll{});
            check_traversal(scene_of(view_of(bvh)), rays, some, AcceptSome{});
        }
    }
}

TEST_CASE("no builder's tree exceeds the traversals' depth, however long the line") {
    std::vector<BvhTriangle> line;
    for (StressMesh& mesh : stress_meshes(static_cast<uint32_t>(effort(20'000, 1'000'000)))) {
        if (std::string_view(mesh.name) == "a line") line = std::move(mesh.triangles);
    }
    REQUIRE(!line.empty());
    std::vector<BvhTriangle> doubling; // the SAH and clustering separate one triangle at a time
    for (uint32_t i = 0; i < 250; ++i) {
        const Vec3 p = {float_of((i / 2 + 30) << 23), 0, 0};
        doubling.push_back({p, i, p, 0, {p.x, p.x, p.x}, 0});
    }
    for (const BvhBuilder builder : kValuesOf<BvhBuilder>) {
        CAPTURE(name_of(builder));
        for (const std::vector<BvhTriangle>* triangles : {&line, &doubling}) {
            const Stopwatch time;
            const Bvh bvh = build_bvh(builder, *triangles, {.max_leaf = 1});
            if (effort(0, 1))
                MESSAGE(std::string(name_of(builder)), ": ", triangles->size(), " triangles, depth ", bvh.depth, ", ",
                        time.seconds(), " s");
            const auto fault = fault_of(builder, bvh, *triangles); // checks the depth against kMaxBvhDepth, too
            CHECK_MESSAGE(!fault, fault.value_or(""));
        }
    }
}

TEST_CASE("a chain of clusters that is too deep is flattened to the traversals' depth and unchanged above") {
    const std::vector<BvhTriangle> triangles = make_soup(5000, 0);
    const std::vector<BuildReference> references = references_of(triangles);
    BinaryTree chain;
    for (uint32_t i = 0; i < references.size(); ++i) {
        chain.references.push_back(i);
        chain.nodes.push_back(make_leaf({references[i].lo, references[i].hi}, i));
        if (i == 0) continue;
        const auto last = static_cast<uint32_t>(chain.nodes.size() - 1);
        chain.nodes.push_back(make_inner(chain, i == 1 ? 0 : last - 1, last));
    }
    chain.root = static_cast<uint32_t>(chain.nodes.size() - 1);
    const Bvh bvh = make_bvh(chain, triangles, {.max_leaf = 1});
    const auto fault = find_fault(bvh);
    CHECK_MESSAGE(!fault, fault.value_or(""));
    CHECK(bvh.depth == kMaxBvhDepth);
    CHECK(bvh.triangles.size() == triangles.size());
    uint32_t levels = 0; // levels that separate one triangle, as in the chain
    for (uint32_t at = bvh.root; (bvh.nodes[at].child[0] & kLeafBit) || (bvh.nodes[at].child[1] & kLeafBit); ++levels) {
        at = bvh.nodes[at].child[bvh.nodes[at].child[0] & kLeafBit ? 1 : 0];
    }
    CHECK(levels == static_cast<uint32_t>(kMaxBvhDepth - levels_needed(5000)));

    limit_depth(chain, levels_needed(5000)); // the smallest depth that holds them
    CHECK(make_bvh(chain, triangles, {.max_leaf = 1}).depth == levels_needed(5000));
}

TEST_CASE("any number of coincident triangles neither stalls a builder nor makes a chain") {
    const std::vector<BvhTriangle> one = triangles_of(make_sphere(0, {}, 1));
    std::vector<BvhTriangle> triangles;
    for (uint32_t i = 0; i < effort(20'000, 1'000'000); ++i) {
        triangles.push_back(one[0]);
        triangles.back().primitive = i;
    }
    for (const BvhBuilder builder : kValuesOf<BvhBuilder>) {
        CAPTURE(name_of(builder));
        const Bvh bvh = build_bvh(builder, triangles);
        const auto fault = fault_of(builder, bvh, triangles);
        CHECK_MESSAGE(!fault, fault.value_or(""));
        CHECK(bvh.depth <= (builder == BvhBuilder::Insertion ? 45 : 21)); // random splits can need twice the logarithm
    }
}

TEST_CASE("a builder keeps other owners' flags and resets its own") {
    std::vector<BvhTriangle> triangles = make_soup(500, 0);
    for (BvhTriangle& t : triangles) t.flags = (t.primitive << 1) | kLastInLeaf; // a flag of an earlier tree
    for (const BvhBuilder builder : kValuesOf<BvhBuilder>) {
        CAPTURE(name_of(builder));
        const Bvh bvh = build_bvh(builder, triangles);
        CHECK(!fault_of(builder, bvh, triangles));
        for (const BvhTriangle& t : bvh.triangles) CHECK((t.flags >> 1) == t.primitive);
    }
}

TEST_CASE("spatial splits respect their limit on references and split nothing with a limit of 0") {
    for (const StressMesh& mesh : stress_meshes()) {
        CAPTURE(mesh.name);
        std::size_t most = 0;
        for (const float growth : {0.0f, 0.1f, 1.0f, 8.0f}) {
            CAPTURE(growth);
            const Bvh bvh = build_spatial_split_bvh(mesh.triangles, {}, {.min_overlap = 0, .max_growth = growth});
            const auto fault = find_split_fault(bvh, mesh.triangles);
            CHECK_MESSAGE(!fault, fault.value_or(""));
            CHECK(static_cast<double>(bvh.triangles.size()) <=
                  (1 + static_cast<double>(growth)) * static_cast<double>(mesh.triangles.size()));
            most = std::max(most, bvh.triangles.size());
            if (growth == 0) CHECK(!find_fault(bvh));
        }
        if (std::string_view(mesh.name) == "slivers") CHECK(most > mesh.triangles.size());
    }
}

TEST_CASE("spatial splits separate a grating of long diagonal strips, which boxes cannot") {
    std::vector<BvhTriangle> strips;
    for (uint32_t i = 0; i < 200; ++i) {
        const Vec3 from = {static_cast<float>(i), 0, 0}, along = {300, 300, 0};
        strips.push_back({from, 2 * i, from + along, 0, from + Vec3{0.5f, 0, 0}, 0});
    }
    const Bvh cut = build_bvh(BvhBuilder::SpatialSplits, strips), whole = build_bvh(BvhBuilder::Sweep, strips);
    CHECK(cut.triangles.size() > strips.size());
    CHECK(cut.sah_cost < 0.8f * whole.sah_cost);
    CHECK(!find_split_fault(cut, strips));
}

namespace {

/// A point in double precision. On a triangle its error is at most some 2^-52 of the coordinates.
struct ExactPoint {
    double at[3];

    bool is_in(const Bounds3& box, double slack) const {
        for (int k = 0; k < 3; ++k) {
            if (at[k] < static_cast<double>(component(box.lo, k)) - slack) return false;
            if (at[k] > static_cast<double>(component(box.hi, k)) + slack) return false;
        }
        return true;
    }
};

ExactPoint point_of(const BvhTriangle& t, double wa, double wb, double wc) {
    ExactPoint p;
    for (int k = 0; k < 3; ++k) {
        p.at[k] = wa * static_cast<double>(component(t.a, k)) + wb * static_cast<double>(component(t.b, k)) +
                  wc * static_cast<double>(component(t.c, k));
    }
    return p;
}

BvhTriangle random_triangle(Random& random, bool far, bool sliver) {
    const float scale = float_of((127 + random.below(80) - 40) << 23);
    const Vec3 away = far ? scale * random.point(-1000, 1000) : Vec3{};
    BvhTriangle t;
    t.a = away + scale * random.point(-1, 1);
    t.b = away + scale * random.point(-1, 1);
    t.c = sliver ? t.a + (scale * 1e-4f) * random.point(-1, 1) : away + scale * random.point(-1, 1);
    return t;
}

} // namespace

TEST_CASE("both parts of a split triangle together contain all of its points, and each contains those on the plane") {
    Random random(41);
    uint64_t lost = 0, lost_on_cut = 0, outside = 0, cuts = 0, wide = 0;
    for (int i = 0; i < 20000; ++i) {
        const BvhTriangle t = random_triangle(random, i % 2 == 0, i % 5 == 0);
        const Bounds3 box = {min(min(t.a, t.b), t.c), max(max(t.a, t.b), t.c)};
        const double slack = 0x1p-50 * static_cast<double>(box.max_abs());
        const int axis = i % 3;
        const float plane = lerp(component(box.lo, axis), component(box.hi, axis), i % 7 == 0 ? 0.0f : random.unit());
        const ClippedBoxes parts = cut_triangle(t, box, axis, plane);
        for (const Bounds3& part : {parts.left, parts.right}) {
            if (!part.is_empty() && intersection(part, box) != part) ++outside;
        }
        for (int k = 0; k < 20; ++k) {
            double wa = static_cast<double>(random.unit()), wb = static_cast<double>(random.unit());
            if (wa + wb > 1) wa = 1 - wa, wb = 1 - wb;
            const ExactPoint p = point_of(t, wa, wb, 1 - wa - wb);
            if (!p.is_in(parts.left, slack) && !p.is_in(parts.right, slack)) ++lost;
        }
        const Vec3 corners[3] = {t.a, t.b, t.c};
        for (int k = 0; k < 3; ++k) { // points where edges meet the plane: rounding to nearest would lose half of them
            const double a = static_cast<double>(component(corners[k], axis));
            const double b = static_cast<double>(component(corners[(k + 1) % 3], axis));
            const double w = (static_cast<double>(plane) - a) / (b - a);
            if (!(w > 0 && w < 1)) continue;
            double weights[3] = {0, 0, 0};
            weights[k] = 1 - w, weights[(k + 1) % 3] = w;
            const ExactPoint p = point_of(t, weights[0], weights[1], weights[2]);
            ++cuts;
            if (!p.is_in(parts.left, slack) || !p.is_in(parts.right, slack)) ++lost_on_cut;
        }
        const Bounds3 both = intersection(parts.left, parts.right); // the segment in which the plane cuts the triangle
        if (!both.is_empty() && component(both.size(), axis) > 0) ++wide;
    }
    CHECK(cuts > 20000);
    CHECK(lost == 0);
    CHECK(lost_on_cut == 0);
    CHECK(outside == 0);
    CHECK(wide == 0);
}

TEST_CASE("reinsertion improves any builder's tree and keeps it valid") {
    for (const StressMesh& mesh : stress_meshes()) {
        CAPTURE(mesh.name);
        const std::vector<Ray> rays = stress_rays(500, mesh, 37);
        const std::vector<Hit> all = hits_by_brute_force(mesh.triangles, rays, AcceptAll{});
        for (const BvhBuilder builder : kValuesOf<BvhBuilder>) {
            CAPTURE(name_of(builder));
            const Bvh before = build_bvh(builder, mesh.triangles);
            const Bvh after = optimise_bvh(before);
            const auto fault = fault_of(builder, after, mesh.triangles);
            CHECK_MESSAGE(!fault, fault.value_or(""));
            CHECK(after.sah_cost <= 1.00001f * before.sah_cost);
            check_traversal(scene_of(view_of(after)), rays, all, AcceptAll{});
        }
    }
}

namespace {

void check_costs(const std::vector<BvhTriangle>& triangles) {
    float cost[std::size(kValuesOf<BvhBuilder>)];
    for (const BvhBuilder builder : kValuesOf<BvhBuilder>) {
        const Stopwatch time;
        const Bvh bvh = build_bvh(builder, triangles);
        const double seconds = time.seconds();
        if (effort(0, 1))
            MESSAGE(std::string(name_of(builder)), ": cost ", bvh.sah_cost, ", references a triangle ",
                    static_cast<double>(bvh.triangles.size()) / static_cast<double>(triangles.size()), ", depth ",
                    bvh.depth, ", ", seconds, " s");
        const auto fault = fault_of(builder, bvh, triangles);
        CHECK_MESSAGE(!fault, fault.value_or(""));
        cost[static_cast<int>(builder)] = bvh.sah_cost;
    }
    const auto of = [&](BvhBuilder builder) { return cost[static_cast<int>(builder)]; };
    const float binned = of(BvhBuilder::Binned);
    CHECK(of(BvhBuilder::Sweep) <= 1.02f * binned);
    CHECK(of(BvhBuilder::SpatialSplits) <= 1.02f * binned);
    CHECK(of(BvhBuilder::Median) > binned);
    CHECK(of(BvhBuilder::EqualCounts) > binned);
    CHECK(of(BvhBuilder::Ploc) <= 1.2f * binned);
    CHECK(of(BvhBuilder::Insertion) <= 1.3f * binned);
    CHECK(of(BvhBuilder::Reinsertion) < binned);
    CHECK(of(BvhBuilder::SpatialReinsertion) < 1.001f * of(BvhBuilder::Reinsertion));
    CHECK(of(BvhBuilder::SpatialReinsertion) < of(BvhBuilder::SpatialSplits));
}

} // namespace

TEST_CASE("each builder's tree has the expected cost on a torus") { check_costs(triangles_of(make_torus(120, 80))); }

TEST_CASE("each builder's tree has the expected cost in Sponza") {
    const auto path = test_scene("crytek-sponza/sponza.obj");
    if (!path) return;
    check_costs(triangles_of(read_obj_geometry(*path)));
}

TEST_CASE("the checker notices faults of trees with spatial splits") {
    const std::vector<BvhTriangle> mesh = stress_meshes()[2].triangles; // slivers
    const Bvh good = build_bvh(BvhBuilder::SpatialSplits, mesh);
    REQUIRE(!find_split_fault(good, mesh));
    REQUIRE(good.triangles.size() > mesh.size());
    REQUIRE(find_fault(good)); // its leaves do not contain whole triangles
    const auto broken = [&](auto&& change) {
        Bvh bvh = good;
        change(bvh);
        return find_split_fault(bvh, mesh).has_value();
    };
    CHECK(!broken([](Bvh&) {}));
    CHECK(broken([](Bvh& b) { b.depth += 1; }));
    CHECK(broken([](Bvh& b) { b.nodes[3].child[1] = b.nodes[3].child[0]; }));
    CHECK(broken([](Bvh& b) { b.nodes[0].x[0] = -kInfinity; }));
    CHECK(broken([](Bvh& b) { b.triangles[7].a.x += 10; }));
    CHECK(broken([](Bvh& b) { b.triangles[7].primitive = 0xffffff; }));
    CHECK(broken([&](Bvh& b) { // one triangle is in no leaf
        for (BvhTriangle& t : b.triangles) t.primitive = t.primitive == 5 ? 6 : t.primitive;
    }));
    uint32_t noticed = 0, leaves = 0; // a leaf's box lacks a strip
    for (uint32_t i = 0; i < good.nodes.size() && leaves < 200; ++i) {
        for (int k = 0; k < 2; ++k) {
            if (!(good.nodes[i].child[k] & kLeafBit)) continue;
            ++leaves;
            noticed += broken([&](Bvh& b) { b.nodes[i].x[k] += 0.2f * (b.nodes[i].x[k + 2] - b.nodes[i].x[k]); });
        }
    }
    CHECK(leaves >= 200);
    CHECK(noticed >= leaves * 3 / 4); // the rest of the triangle may lie in the neighbour's box
}
