// Wide and compressed trees give the hits of brute force, bit for bit: by every traversal, with and without redundant
// traversal avoidance, with children in either order, for all meshes and instances.

#include <doctest/doctest.h>

#include <type_traits>
#include <vector>

#include "accel/builders/build_bvh.h"
#include "accel/bvh/compressed_bvh.h"
#include "accel/bvh/tlas.h"
#include "accel/bvh/wide_bvh.h"
#include "math/random.h"
#include "tests/support/check_traversal.h"
#include "tests/support/options.h"
#include "trace/wide/compressed_traversal.h"
#include "trace/wide/traverse_wide.h"
#include "trace/wide/wide_traversal.h"

using namespace pertev;
using namespace pertev::test;

namespace {

constexpr TraversalOptions kBoth = {}, kWithoutRta = {.rta = false}, kBuildersOrder = {.near_first = false},
                           kNeither = {.rta = false, .near_first = false}, kAtNodes = {.rta_at_pops = false};

/// Calls check.operator()<Traversal>() for a traversal with every choice that must not change hits.
template <template <TraversalOptions> class Traversal>
void with_each_choice(auto&& check) {
    check.template operator()<Traversal<kBoth>>();
    check.template operator()<Traversal<kWithoutRta>>();
    check.template operator()<Traversal<kBuildersOrder>>();
    check.template operator()<Traversal<kNeither>>();
}

/// All trees over one set of triangles.
struct Trees {
    WideBvh<4> wide4;
    WideBvh<8> wide8;
    CompressedBvh compressed;

    explicit Trees(const Bvh& bvh, const CollapseSettings& settings = {})
        : wide4(make_wide_bvh<4>(bvh, settings)), wide8(make_wide_bvh<8>(bvh, settings)),
          compressed(make_compressed_bvh(bvh)) {}
};

struct ExpectedPair {
    const std::vector<Ray>& rays;
    std::vector<Hit> all, some;
};

template <template <TraversalOptions> class Traversal, class Tree>
void check_tree(const Tree& tree, const ExpectedPair& expected) {
    const auto check = [&]<class OneTraversal>() {
        check_traversal<OneTraversal>(scene_of(tree), expected.rays, expected.all, AcceptAll{});
        check_traversal<OneTraversal>(scene_of(tree), expected.rays, expected.some, AcceptSome{});
    };
    with_each_choice<Traversal>(check);
    if constexpr (std::is_same_v<Tree, CompressedBvhView>) check.template operator()<Traversal<kAtNodes>>();
}

} // namespace

TEST_CASE("traversals of wide and compressed trees match brute force bit for bit") {
    for (const StressMesh& c : stress_meshes(static_cast<uint32_t>(effort(3000, 1'000'000)))) {
        CAPTURE(c.name);
        const bool million = c.triangles.size() > 100'000; // brute force is slow
        const std::vector<Ray> rays = stress_rays(million ? 40 : static_cast<uint32_t>(effort(1000, 10'000)), c, 91);
        const ExpectedPair expected = {rays, hits_by_brute_force(c.triangles, rays, AcceptAll{}),
                                       hits_by_brute_force(c.triangles, rays, AcceptSome{})};
        const Bvh bvh = build_bvh(c.triangles);
        const Trees trees(bvh);
        check_tree<Wide4Traversal>(view_of(trees.wide4), expected);
        check_tree<Wide8Traversal>(view_of(trees.wide8), expected);
        check_tree<Wide8SimdTraversal>(view_of(trees.wide8), expected);
        check_tree<CompressedTraversal>(view_of(trees.compressed), expected);
    }
}

namespace {

/// CompressedTraversal in a warp whose other lanes have no triangles. The ray's own triangles are postponed, for
/// random times or until it cannot continue without them.
template <TraversalOptions kOptions, bool kAlways>
struct PostponingTraversal {
    using Traversal = CompressedTraversal<kOptions>;
    using Tree = CompressedBvhView;
    static inline int max_entries = 0; // on the stack

    template <class Visitor, class Counter>
    static bool traverse(const CompressedBvhView& bvh, const Ray& ray, uint32_t instance, Visitor& visitor,
                         const Counter& counter) {
        constexpr LaneMask kAlone = 1;
        typename Traversal::State::Slot slots[Traversal::State::kSlots];
        typename Traversal::State place(slots);
        Traversal::start(bvh, ray, visitor, place);
        for (uint32_t turns = 0; !place.is_done(); ++turns) {
            const bool waits = place.nodes.is_empty();
            const bool alone = waits || (!kAlways && hash_word(bits_of(ray.direction.x) + turns) % 4 == 0);
            if (Traversal::step(bvh, ray, instance, place, visitor, counter, kAlone, alone ? 1 : 32)) return true;
            max_entries = max(max_entries, place.size);
        }
        return false;
    }
};
template <TraversalOptions kOptions>
using TraversalPostponedAtRandom = PostponingTraversal<kOptions, false>;
template <TraversalOptions kOptions>
using TraversalPostponedAlways = PostponingTraversal<kOptions, true>;

} // namespace

TEST_CASE("postponed triangle tests give the same hits") {
    for (const StressMesh& c : stress_meshes()) {
        CAPTURE(c.name);
        const std::vector<Ray> rays = stress_rays(static_cast<uint32_t>(effort(700, 20'000)), c, 17);
        const ExpectedPair expected = {rays, hits_by_brute_force(c.triangles, rays, AcceptAll{}),
                                       hits_by_brute_force(c.triangles, rays, AcceptSome{})};
        const CompressedBvh tree = make_compressed_bvh(build_bvh(c.triangles));
        check_tree<TraversalPostponedAtRandom>(view_of(tree), expected);
        check_tree<TraversalPostponedAlways>(view_of(tree), expected);
        CHECK(PostponingTraversal<kBoth, true>::max_entries <= 2 * tree.depth);
        PostponingTraversal<kBoth, true>::max_entries = 0;
    }
}

TEST_CASE("leaf sizes and costs of a collapse do not change hits") {
    const StressMesh mesh = stress_meshes()[3];
    const std::vector<Ray> rays = stress_rays(1500, mesh, 12);
    const ExpectedPair expected = {rays, hits_by_brute_force(mesh.triangles, rays, AcceptAll{}),
                                   hits_by_brute_force(mesh.triangles, rays, AcceptSome{})};
    for (const int build_leaf : {1, 30}) {
        const Bvh bvh = build_bvh(mesh.triangles, {.max_leaf = build_leaf, .leaf_cost = 0.1f});
        for (const int max_leaf : {1, 2, 7, 100}) {
            for (const float triangle_cost : {0.0f, 0.3f, 5.0f}) {
                CAPTURE(build_leaf);
                CAPTURE(max_leaf);
                CAPTURE(triangle_cost);
                const Trees trees(bvh, {.max_leaf = max_leaf, .triangle_cost = triangle_cost});
                check_traversal<Wide4Traversal<kBoth>>(scene_of(view_of(trees.wide4)), rays, expected.all, AcceptAll{});
                check_traversal<Wide8Traversal<kBoth>>(scene_of(view_of(trees.wide8)), rays, expected.some,
                                                       AcceptSome{});
                check_traversal<Wide8SimdTraversal<kBoth>>(scene_of(view_of(trees.wide8)), rays, expected.all,
                                                           AcceptAll{});
            }
        }
        const Trees trees(bvh);
        check_tree<CompressedTraversal>(view_of(trees.compressed), expected);
    }
}

namespace {

struct WidelyPlacedMeshes {
    std::vector<std::vector<BvhTriangle>> meshes;
    std::vector<PlacedBvh> placed;

    WidelyPlacedMeshes(std::vector<std::vector<BvhTriangle>> m, const std::vector<Trees>& trees)
        : meshes(std::move(m)) {
        Random random(8);
        for (uint32_t i = 0; i < 40; ++i) {
            const uint32_t mesh = i % static_cast<uint32_t>(meshes.size());
            const Vec3 axis = random.direction();
            const float w = random.within(-1, 1), s = sqrt(1 - w * w);
            Transform place = make_rotation(s * axis.x, s * axis.y, s * axis.z, w);
            if (i % 5 == 0) place = Transform{}; // the identity is exact, and has ties with its neighbours
            if (i % 3 == 0) place = compose(place, make_scale({0.5f, random.within(0.01f, 4), -1}));
            if (i % 7 == 0) place = compose(place, make_scale({1e4f, 1e4f, 1e4f}));
            place = compose(make_translation(i % 5 == 0 ? Vec3{} : random.point(-3, 3)), place);
            placed.push_back({place, trees[mesh].wide8.bounds, mesh, i * 3 + 1});
        }
    }

    Hit nearest(const Ray& ray) const {
        Hit best;
        for (const PlacedBvh& p : placed) {
            const Ray local = transform_ray(inverse(p.world_from_local), ray);
            trace_by_brute_force(meshes[p.blas], local, p.instance, AcceptSome{}, best);
        }
        return best;
    }
};

template <template <TraversalOptions> class Traversal, class Tree>
void check_instances(const Tlas& top, const std::vector<Trees>& trees, Tree Trees::*which, const std::vector<Ray>& rays,
                     const std::vector<Hit>& expected) {
    std::vector<decltype(view_of(trees[0].*which))> views;
    for (const Trees& t : trees) views.push_back(view_of(t.*which));
    const SceneTrees<typename decltype(views)::value_type> scene = {
        {}, top.nodes.data(), top.instances.data(), views.data(), top.root, top.reach, top.growth};
    with_each_choice<Traversal>(
        [&]<class OneTraversal>() { check_traversal<OneTraversal>(scene, rays, expected, AcceptSome{}); });
}

} // namespace

TEST_CASE("traversals of wide and compressed trees over instances match brute force bit for bit") {
    const std::vector<std::vector<BvhTriangle>> meshes = {triangles_of(make_torus(16, 12)), make_soup(300, 0),
                                                          triangles_of(make_sphere(0, {}, 1)), make_soup(2, 0)};
    std::vector<Trees> trees;
    for (const auto& mesh : meshes) trees.emplace_back(build_bvh(mesh));
    const WidelyPlacedMeshes placed(meshes, trees);
    const Tlas top = build_tlas(placed.placed);
    const std::vector<Ray> rays = stress_rays(1500, {"torus", meshes[0], {}, 1}, 29);
    std::vector<Hit> expected;
    uint64_t hits = 0;
    for (const Ray& ray : rays) {
        expected.push_back(placed.nearest(ray));
        hits += expected.back().instance != kNoHit ? 1 : 0;
    }
    CHECK(hits > rays.size() / 5);
    check_instances<Wide4Traversal>(top, trees, &Trees::wide4, rays, expected);
    check_instances<Wide8Traversal>(top, trees, &Trees::wide8, rays, expected);
    check_instances<Wide8SimdTraversal>(top, trees, &Trees::wide8, rays, expected);
    check_instances<CompressedTraversal>(top, trees, &Trees::compressed, rays, expected);
}

TEST_CASE("in the compressed traversal RTA at pops saves more nodes than RTA at nodes and changes no hit") {
    const std::vector<BvhTriangle> soup = make_soup(20'000, 0);
    const Trees trees(build_bvh(soup));
    const std::vector<Ray> rays = stress_rays(2000, {"soup", soup, {}, 1}, 31);
    std::vector<Hit> expected;
    uint64_t at_pops = 0, at_nodes = 0, without = 0, triangles = 0, triangles_at_nodes = 0, unused = 0;
    for (const Ray& ray : rays) {
        const SingleTree<CompressedBvhView> scene = {view_of(trees.compressed)};
        Hit hit;
        trace_closest<CompressedTraversal<kWithoutRta>>(scene, ray, AcceptAll{}, hit,
                                                        TraversalCounter{&without, &unused});
        expected.push_back(hit);
        trace_closest<CompressedTraversal<kBoth>>(scene, ray, AcceptAll{}, hit, TraversalCounter{&at_pops, &triangles});
        trace_closest<CompressedTraversal<kAtNodes>>(scene, ray, AcceptAll{}, hit,
                                                     TraversalCounter{&at_nodes, &triangles_at_nodes});
    }
    CHECK(at_pops < at_nodes);
    CHECK(at_nodes < without);
    CHECK(triangles == triangles_at_nodes);
    check_traversal<CompressedTraversal<kAtNodes>>(scene_of(view_of(trees.compressed)), rays, expected, AcceptAll{});
}

namespace {

/// Many small spheres inside a large one, so that each ray hits a surface.
std::vector<BvhTriangle> things_in_a_room() {
    std::vector<BvhTriangle> triangles = triangles_of(make_sphere(1, {}, 10));
    Random random(6);
    for (int i = 0; i < 80; ++i) {
        for (BvhTriangle triangle : triangles_of(make_sphere(2, random.point(-5, 5), 0.3f))) {
            triangle.primitive = static_cast<uint32_t>(triangles.size());
            triangles.push_back(triangle);
        }
    }
    return triangles;
}

/// Returns the visited nodes of any-hit rays that end far outside the scene, relative to the same rays without an end.
template <class Traversal>
double nodes_saved_by_no_end(const typename Traversal::Tree& tree) {
    Random random(7);
    uint64_t with_end = 0, without = 0, triangles = 0, missed = 0;
    for (int i = 0; i < 2000; ++i) {
        Ray ray;
        ray.origin = random.point(-5, 5);
        ray.direction = random.direction();
        ray.t_max = 1e30f;
        missed +=
            trace_any<Traversal>(scene_of(tree), ray, AcceptAll{}, TraversalCounter{&with_end, &triangles}) ? 0 : 1;
        ray.t_max = kInfinity;
        missed +=
            trace_any<Traversal>(scene_of(tree), ray, AcceptAll{}, TraversalCounter{&without, &triangles}) ? 0 : 1;
    }
    CHECK(missed == 0);
    return static_cast<double>(with_end) / static_cast<double>(without);
}

} // namespace

TEST_CASE("any-hit traversal of an infinite ray starts at its far end and visits fewer nodes") {
    const Trees trees(build_bvh(things_in_a_room()));
    CHECK(nodes_saved_by_no_end<CompressedTraversal<for_any_hit(kBoth)>>(view_of(trees.compressed)) > 1.3);
    CHECK(nodes_saved_by_no_end<Wide8SimdTraversal<for_any_hit(kBoth)>>(view_of(trees.wide8)) > 1.3);
    CHECK(nodes_saved_by_no_end<Wide8SimdTraversal<for_any_hit(kBuildersOrder)>>(view_of(trees.wide8)) > 1.1);
}

namespace {

constexpr TraversalOptions kFast = {.tests = TestKind::Fast};

template <class Traversal>
void check_nearly_equal(const typename Traversal::Tree& tree, const std::vector<Ray>& rays,
                        const std::vector<Hit>& expected) {
    uint64_t equal = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        Hit hit;
        trace_closest<Traversal>(scene_of(tree), rays[i], AcceptAll{}, hit);
        equal += hit.instance == expected[i].instance &&
                 (hit.instance == kNoHit || hit.primitive == expected[i].primitive) &&
                 trace_any<Traversal>(scene_of(tree), rays[i], AcceptAll{}) == (hit.instance != kNoHit);
    }
    CHECK(static_cast<double>(equal) > 0.99 * static_cast<double>(rays.size()));
}

} // namespace

TEST_CASE("with the laboratory's fast tests nearly all hits are the same") {
    const std::vector<BvhTriangle> torus = triangles_of(make_torus(40, 24));
    Random random(4);
    std::vector<Ray> rays(20'000);
    for (Ray& ray : rays) {
        ray.origin = random.point(-4, 4);
        ray.direction = random.point(-1, 1) - ray.origin;
    }
    const std::vector<Hit> expected = hits_by_brute_force(torus, rays, AcceptAll{});
    const Trees trees(build_bvh(torus));
    check_nearly_equal<Wide4Traversal<kFast>>(view_of(trees.wide4), rays, expected);
    check_nearly_equal<Wide8Traversal<kFast>>(view_of(trees.wide8), rays, expected);
    check_nearly_equal<Wide8SimdTraversal<kFast>>(view_of(trees.wide8), rays, expected);
    check_nearly_equal<CompressedTraversal<kFast>>(view_of(trees.compressed), rays, expected);
}
