// Every traversal of the laboratory over binary trees, with every switch, gives the hits of brute force, bit for bit:
// closest and any, over meshes that break traversals, over instances, and over trees with spatial splits, where hits
// lie outside the boxes of their leaves. The tests also compare the nodes that each traversal visits with its
// description.

#include <doctest/doctest.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "accel/builders/build_bvh.h"
#include "accel/bvh/parent_links.h"
#include "accel/bvh/skip_bvh.h"
#include "tests/support/check_traversal.h"
#include "tests/support/instanced_scene.h"
#include "tests/support/options.h"
#include "tests/support/split_bvh.h"
#include "tests/support/stress_meshes.h"
#include "trace/binary/if_if_traversal.h"
#include "trace/binary/octant_traversal.h"
#include "trace/binary/parent_links_traversal.h"
#include "trace/binary/short_stack_traversal.h"
#include "trace/binary/skip_links_traversal.h"
#include "trace/binary/speculative_traversal.h"
#include "trace/binary/warp_packet_traversal.h"
#include "trace/binary/while_while_traversal.h"
#include "trace/brute_force_traversal.h"
#include "trace/packet_traversal.h"

using namespace pertev;
using namespace pertev::test;

namespace {

/// AcceptAll and AcceptSome as one type.
struct AcceptSomeOrAll {
    bool all;
    HD bool operator()(uint32_t instance, uint32_t primitive, float u, float v) const {
        return all || AcceptSome{}(instance, primitive, u, v);
    }
};

/// Calls f.operator()<Traversal<options>>() for RTA and near-first order, on and off.
template <template <TraversalOptions> class Traversal, class F>
void with_all_options(const F& f) {
    f.template operator()<Traversal<TraversalOptions{.rta = true, .near_first = true}>>("RTA, near first");
    f.template operator()<Traversal<TraversalOptions{.rta = true, .near_first = false}>>("RTA, builder's order");
    f.template operator()<Traversal<TraversalOptions{.rta = false, .near_first = true}>>("no RTA, near first");
    f.template operator()<Traversal<TraversalOptions{.rta = false, .near_first = false}>>("no RTA, builder's order");
}

template <template <TraversalOptions> class Traversal, class Tree>
void check_options(const std::string& name, const SceneTrees<Tree>& scene, const std::vector<Ray>& rays,
                   const std::vector<Hit>& expected, AcceptSomeOrAll accept) {
    CAPTURE(name);
    with_all_options<Traversal>([&]<class W>(const std::string& options) {
        CAPTURE(options);
        check_traversal<W>(scene, rays, expected, accept);
    });
}

/// Calls check for all traversals of a BvhView. The tree has parent links.
void check_binary_traversals(const SceneBvhView& scene, const std::vector<Ray>& rays, const std::vector<Hit>& expected,
                             AcceptSomeOrAll accept) {
    check_options<WhileWhileTraversal>("while-while", scene, rays, expected, accept);
    check_options<IfIfTraversal>("if-if", scene, rays, expected, accept);
    check_options<SpeculativeTraversal>("speculative", scene, rays, expected, accept);
    check_options<OctantTraversal>("octants", scene, rays, expected, accept);
    check_options<RestartTrailTraversal>("restart trail", scene, rays, expected, accept);
    check_options<ShortStackTraversal>("short stack", scene, rays, expected, accept);
    check_options<ParentLinksTraversal>("parent links", scene, rays, expected, accept);
    check_options<WarpPacketTraversal>("warp packet", scene, rays, expected, accept);
}

Bvh with_parent_links(Bvh bvh) {
    add_parent_links(bvh);
    return bvh;
}

void check_all_traversals(const Bvh& bvh, const std::vector<Ray>& rays, const std::vector<Hit>& expected,
                          AcceptSomeOrAll accept) {
    check_binary_traversals(scene_of(view_of(bvh)), rays, expected, accept);
    const SkipBvh skip = make_skip_bvh(bvh);
    check_options<SkipLinksTraversal>("skip links", scene_of(view_of(skip)), rays, expected, accept);
    check_options<BruteForceTraversal>("brute force", scene_of(triangle_array_of(bvh)), rays, expected, accept);
}

struct Visits {
    uint64_t nodes = 0, triangles = 0;
    bool operator==(const Visits&) const = default;
};

template <class Traversal, class Tree>
Visits count_visits(const Tree& tree, const Ray& ray, bool any = false) {
    Visits visits;
    const TraversalCounter counter = {&visits.nodes, &visits.triangles};
    Hit hit;
    if (any) {
        trace_any<Traversal>(scene_of(tree), ray, AcceptAll{}, counter);
    } else {
        trace_closest<Traversal>(scene_of(tree), ray, AcceptAll{}, hit, counter);
    }
    return visits;
}

/// A closed mesh with many triangles behind each hit, and rays that mostly hit it.
std::vector<BvhTriangle> shells() {
    std::vector<BvhTriangle> triangles;
    for (uint32_t i = 0; i < 6; ++i) {
        const std::vector<BvhTriangle> shell =
            triangles_of(make_sphere(3, {0.01f * static_cast<float>(i), 0, 0}, 1 + 0.2f * static_cast<float>(i)), i);
        triangles.insert(triangles.end(), shell.begin(), shell.end());
    }
    return triangles;
}
std::vector<Ray> rays_at_shells(uint32_t count) {
    Random random(8);
    std::vector<Ray> rays(count);
    for (Ray& ray : rays) {
        ray.origin = random.point(-3, 3);
        ray.direction = random.point(-1, 1) - ray.origin;
    }
    return rays;
}

template <template <TraversalOptions> class Traversal, class Tree>
void check_rta_saves(const std::string& name, const Tree& tree, const std::vector<Ray>& rays) {
    CAPTURE(name);
    uint64_t with = 0, without = 0, wrong = 0;
    for (const Ray& ray : rays) {
        const Visits a = count_visits<Traversal<TraversalOptions{.rta = true}>>(tree, ray);
        const Visits b = count_visits<Traversal<TraversalOptions{.rta = false}>>(tree, ray);
        wrong += a.nodes > b.nodes || a.triangles > b.triangles ? 1 : 0;
        with += a.nodes, without += b.nodes;
    }
    CHECK(wrong == 0);
    CHECK(with < without);
}

} // namespace

TEST_CASE(
    "every traversal with every switch gives the hits of testing every triangle, over meshes that break traversals") {
    for (const StressMesh& c : stress_meshes(static_cast<uint32_t>(effort(3000, 50'000)))) {
        CAPTURE(std::string(c.name));
        const std::vector<Ray> rays = stress_rays(static_cast<uint32_t>(effort(100, 1000)), c, 29);
        for (const bool all : {true, false}) {
            const AcceptSomeOrAll accept = {all};
            const std::vector<Hit> expected = hits_by_brute_force(c.triangles, rays, accept);
            check_all_traversals(with_parent_links(build_bvh(c.triangles)), rays, expected, accept);
            if (all) continue;
            check_all_traversals(with_parent_links(build_bvh(c.triangles, {.bins = 7, .max_leaf = 1})), rays, expected,
                                 accept);
        }
    }
}

TEST_CASE("every traversal matches brute force over trees with spatial splits") {
    for (const StressMesh& c : stress_meshes()) {
        CAPTURE(std::string(c.name));
        const Bvh bvh = with_parent_links(build_split_bvh(c.triangles, 6));
        const std::vector<Ray> rays = stress_rays(static_cast<uint32_t>(effort(70, 1000)), c, 37);
        const AcceptSomeOrAll accept = {true};
        check_all_traversals(bvh, rays, hits_by_brute_force(c.triangles, rays, accept), accept);
    }
}

TEST_CASE("every traversal matches brute force over instances, with and without a baked tree") {
    InstancedScene s = make_instanced_scene(static_cast<uint32_t>(effort(200, 5000)));
    std::vector<BvhView> views;
    std::vector<SkipBvh> skips;
    std::vector<SkipBvhView> skip_views;
    std::vector<TriangleArrayView> arrays;
    for (Bvh& tree : s.trees) {
        add_parent_links(tree);
        views.push_back(view_of(tree));
        skips.push_back(make_skip_bvh(tree));
        arrays.push_back(triangle_array_of(tree));
    }
    for (const SkipBvh& skip : skips) skip_views.push_back(view_of(skip));
    add_parent_links(s.baked_tree);
    const SkipBvh baked_skip = make_skip_bvh(s.baked_tree);
    for (const bool with_baked : {false, true}) {
        const std::vector<Hit> expected = s.hits_by_brute_force(with_baked);
        check_binary_traversals(s.scene(views, with_baked ? view_of(s.baked_tree) : BvhView{}), s.rays, expected,
                                {false});
        check_options<SkipLinksTraversal>("skip links",
                                          s.scene(skip_views, with_baked ? view_of(baked_skip) : SkipBvhView{}), s.rays,
                                          expected, {false});
        check_options<BruteForceTraversal>(
            "brute force", s.scene(arrays, with_baked ? triangle_array_of(s.baked_tree) : TriangleArrayView{}), s.rays,
            expected, {false});
    }
}

TEST_CASE("a box entered exactly at the nearest hit is traversed: the first of coincident triangles counts") {
    // The boxes have no thickness, the fast tests do not enlarge them, and no number is rounded, so entry and hit are
    // equal.
    constexpr TraversalOptions kFast = {.tests = TestKind::Fast};
    std::vector<BvhTriangle> triangles;
    for (uint32_t i = 0; i < 100; ++i) {
        triangles.push_back({.a = {1, 0, 0}, .primitive = (i * 37 + 50) % 100, .b = {1, 2, 0}, .c = {1, 0, 2}});
    }
    const Bvh bvh = with_parent_links(build_bvh(triangles, {.max_leaf = 1}));
    const SkipBvh skip = make_skip_bvh(bvh);
    const Ray ray = {{0, 0.25f, 0.25f}, 0, {1, 0, 0}, kInfinity};
    const auto check = [&]<class Traversal>(const std::string& name, const typename Traversal::Tree& tree) {
        CAPTURE(name);
        Hit hit;
        CHECK(trace_closest<Traversal>(scene_of(tree), ray, AcceptAll{}, hit));
        CHECK(hit.t == 1);
        CHECK(hit.primitive == 0);
    };
    check.template operator()<WhileWhileTraversal<kFast>>("while-while", view_of(bvh));
    check.template operator()<IfIfTraversal<kFast>>("if-if", view_of(bvh));
    check.template operator()<SpeculativeTraversal<kFast>>("speculative", view_of(bvh));
    check.template operator()<OctantTraversal<kFast>>("octants", view_of(bvh));
    check.template operator()<RestartTrailTraversal<kFast>>("restart trail", view_of(bvh));
    check.template operator()<ShortStackTraversal<kFast>>("short stack", view_of(bvh));
    check.template operator()<ParentLinksTraversal<kFast>>("parent links", view_of(bvh));
    check.template operator()<WarpPacketTraversal<kFast>>("warp packet", view_of(bvh));
    check.template operator()<SkipLinksTraversal<kFast>>("skip links", view_of(skip));
    RayPacket packet;
    packet.fill(ray);
    std::array<Hit, kPacketRays> hits;
    CHECK(trace_packet_closest<kFast>(scene_of(view_of(bvh)), packet, 0xff, PacketAccepts<AcceptAll>{}, hits) == 0xff);
    for (const Hit& hit : hits) CHECK((hit.t == 1 && hit.primitive == 0));
}

TEST_CASE("redundant traversal avoidance never visits more nodes and saves some") {
    const Bvh bvh = with_parent_links(build_bvh(shells()));
    const SkipBvh skip = make_skip_bvh(bvh);
    const std::vector<Ray> rays = rays_at_shells(2000);
    check_rta_saves<WhileWhileTraversal>("while-while", view_of(bvh), rays);
    check_rta_saves<IfIfTraversal>("if-if", view_of(bvh), rays);
    check_rta_saves<SpeculativeTraversal>("speculative", view_of(bvh), rays);
    check_rta_saves<OctantTraversal>("octants", view_of(bvh), rays);
    check_rta_saves<RestartTrailTraversal>("restart trail", view_of(bvh), rays);
    check_rta_saves<ShortStackTraversal>("short stack", view_of(bvh), rays);
    check_rta_saves<ParentLinksTraversal>("parent links", view_of(bvh), rays);
    check_rta_saves<SkipLinksTraversal>("skip links", view_of(skip), rays);
}

TEST_CASE(
    "traversals with a stack visit equally many nodes, those without one visit more, and brute force visits all") {
    constexpr TraversalOptions kAll = {};
    const Bvh bvh = with_parent_links(build_bvh(shells()));
    uint64_t by_stack = 0, by_short_stack = 0, by_trail = 0, far_first = 0, near_first = 0, wrong = 0;
    const auto compare = [&]<TraversalOptions kOptions>(const Ray& ray, bool any) {
        const Visits stack = count_visits<WhileWhileTraversal<kOptions>>(view_of(bvh), ray, any);
        wrong += count_visits<SpeculativeTraversal<kOptions>>(view_of(bvh), ray, any) != stack ? 1 : 0;
        wrong += count_visits<WarpPacketTraversal<kOptions>>(view_of(bvh), ray, any) != stack ? 1 : 0;
        wrong += count_visits<IfIfTraversal<kOptions>>(view_of(bvh), ray, any) != stack ? 1 : 0;
        const Visits trail = count_visits<RestartTrailTraversal<kOptions>>(view_of(bvh), ray, any);
        const Visits some = count_visits<ShortStackTraversal<kOptions>>(view_of(bvh), ray, any);
        wrong += trail.triangles > stack.triangles || some.triangles > stack.triangles ? 1 : 0;
        by_stack += stack.nodes, by_short_stack += some.nodes, by_trail += trail.nodes;
    };
    for (const Ray& ray : rays_at_shells(2000)) {
        compare.template operator()<kAll>(ray, false);
        compare.template operator()<for_any_hit({.near_first = false})>(ray, true); // the options of pictures
        near_first += count_visits<WhileWhileTraversal<kAll>>(view_of(bvh), ray).nodes;
        far_first += count_visits<WhileWhileTraversal<TraversalOptions{.near_first = false}>>(view_of(bvh), ray).nodes;
        const Visits all = count_visits<BruteForceTraversal<kAll>>(triangle_array_of(bvh), ray);
        wrong += all.nodes != 0 || all.triangles != bvh.triangles.size() ? 1 : 0;
    }
    CHECK(wrong == 0);
    CHECK(by_stack < by_short_stack);
    CHECK(by_short_stack < by_trail);
    CHECK(near_first < far_first);
}

TEST_CASE("with the laboratory's fast tests every traversal finds the same surfaces, except at edges") {
    constexpr TraversalOptions kFast = {.tests = TestKind::Fast};
    const Bvh bvh = with_parent_links(build_bvh(shells()));
    const SkipBvh skip = make_skip_bvh(bvh);
    const std::vector<Ray> rays = rays_at_shells(1001);
    const std::vector<Hit> exact = hits_by_brute_force(bvh.triangles, rays, AcceptAll{});
    uint64_t hits = 0;
    for (const Hit& hit : exact) hits += hit.instance != kNoHit ? 1 : 0;
    CHECK(hits > rays.size() / 2);
    const auto check = [&]<class Traversal>(const std::string& name, const typename Traversal::Tree& tree) {
        CAPTURE(name);
        uint64_t differ = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            Hit hit;
            const bool found = trace_closest<Traversal>(scene_of(tree), rays[i], AcceptAll{}, hit);
            const bool any = trace_any<Traversal>(SingleTree<typename Traversal::Tree>{tree}, rays[i], AcceptAll{});
            const bool same = hit.instance == exact[i].instance && hit.primitive == exact[i].primitive;
            differ += same && any == found ? 0 : 1;
        }
        CHECK(differ <= rays.size() / 1000);
    };
    check.template operator()<WhileWhileTraversal<kFast>>("while-while", view_of(bvh));
    check.template operator()<IfIfTraversal<kFast>>("if-if", view_of(bvh));
    check.template operator()<SpeculativeTraversal<kFast>>("speculative", view_of(bvh));
    check.template operator()<OctantTraversal<kFast>>("octants", view_of(bvh));
    check.template operator()<RestartTrailTraversal<kFast>>("restart trail", view_of(bvh));
    check.template operator()<ShortStackTraversal<kFast>>("short stack", view_of(bvh));
    check.template operator()<ParentLinksTraversal<kFast>>("parent links", view_of(bvh));
    check.template operator()<WarpPacketTraversal<kFast>>("warp packet", view_of(bvh));
    check.template operator()<SkipLinksTraversal<kFast>>("skip links", view_of(skip));
    check.template operator()<BruteForceTraversal<kFast>>("brute force", triangle_array_of(bvh));
}
