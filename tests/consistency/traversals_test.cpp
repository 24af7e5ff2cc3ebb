// The hit is a function of the scene, not of the traversal: trees of every build setting give the hits of brute force,
// bit for bit. Cases include many triangles at the same t and rays along the planes of boxes.

#include <doctest/doctest.h>

#include <vector>

#include "accel/builders/build_bvh.h"
#include "accel/bvh/tlas.h"
#include "accel/bvh/wide_bvh.h"
#include "tests/support/check_traversal.h"
#include "tests/support/instanced_scene.h"
#include "tests/support/stress_meshes.h"
#include "trace/wide/traverse_wide.h"

using namespace pertev;
using namespace pertev::test;

namespace {

const BvhBuildSettings kSettings[] = {{},
                                      {.bins = 2, .max_leaf = 1},
                                      {.bins = 64, .max_leaf = 16, .leaf_cost = 0.1f},
                                      {.bins = 7, .max_leaf = 3, .max_depth = 13}};

using SimdTraversal = Wide8SimdTraversal<TraversalOptions{}>;

} // namespace

TEST_CASE("binary trees of all build settings match brute force bit for bit") {
    for (const StressMesh& c : stress_meshes()) {
        CAPTURE(c.name);
        const std::vector<Ray> rays = stress_rays(2000, c, 17);
        const std::vector<Hit> all = hits_by_brute_force(c.triangles, rays, AcceptAll{});
        const std::vector<Hit> some = hits_by_brute_force(c.triangles, rays, AcceptSome{});
        uint64_t hits = 0;
        for (const Hit& hit : all) hits += hit.instance != kNoHit ? 1 : 0;
        if (c.triangles.size() > 1) CHECK(hits > rays.size() / 20);
        for (const BvhBuildSettings& settings : kSettings) {
            CAPTURE(settings.bins);
            const Bvh bvh = build_bvh(c.triangles, settings);
            check_traversal(scene_of(view_of(bvh)), rays, all, AcceptAll{});
            check_traversal(scene_of(view_of(bvh)), rays, some, AcceptSome{});
            const WideBvh<kWideChildren> wide = make_wide_bvh<kWideChildren>(bvh, kSimdCollapse);
            check_traversal<SimdTraversal>(scene_of(view_of(wide)), rays, all, AcceptAll{});
            check_traversal<SimdTraversal>(scene_of(view_of(wide)), rays, some, AcceptSome{});
        }
    }
}

TEST_CASE("instances match brute force bit for bit") {
    const InstancedScene s = make_instanced_scene(3000);
    std::vector<BvhView> views;
    for (const Bvh& tree : s.trees) views.push_back(view_of(tree));
    std::vector<WideBvh<kWideChildren>> wide;
    for (const Bvh& tree : s.trees) wide.push_back(make_wide_bvh<kWideChildren>(tree, kSimdCollapse));
    const WideBvh<kWideChildren> wide_baked = make_wide_bvh<kWideChildren>(s.baked_tree, kSimdCollapse);
    std::vector<WideBvhView<kWideChildren>> wide_views;
    for (const auto& tree : wide) wide_views.push_back(view_of(tree));
    for (const bool with_baked : {false, true}) {
        const std::vector<Hit> expected = s.hits_by_brute_force(with_baked);
        const SceneBvhView scene = s.scene(views, with_baked ? view_of(s.baked_tree) : BvhView{});
        check_traversal(scene, s.rays, expected, AcceptSome{});
        const HostTrees trees = s.scene(wide_views, with_baked ? view_of(wide_baked) : WideBvhView<kWideChildren>{});
        check_traversal<SimdTraversal>(trees, s.rays, expected, AcceptSome{});
    }
}

TEST_CASE("the TLAS loses no rays at the edges of instances with tight boxes") {
    const std::vector<BvhTriangle> quad = {{{0, 0, 0}, 0, {1, 0, 0}, 0, {1, 1, 0}, 0},
                                           {{0, 0, 0}, 1, {1, 1, 0}, 0, {0, 1, 0}, 0}};
    const Bvh bvh = build_bvh(quad);
    const BvhView mesh = view_of(bvh);
    Random random(31);
    std::vector<PlacedBvh> placed;
    for (uint32_t i = 0; i < 30; ++i) { // without rotation the quad's edges are those of the world box
        const Transform place = compose(make_translation(random.point(-1000, 1000)), make_scale(random.point(0.3f, 3)));
        placed.push_back({place, bvh.bounds, 0, i});
    }
    const Tlas top = build_tlas(placed);
    const SceneBvhView scene = {{}, top.nodes.data(), top.instances.data(), &mesh, top.root, top.reach, top.growth};
    std::vector<Ray> rays(20000);
    std::vector<Hit> expected(rays.size());
    uint64_t hits = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const PlacedBvh& at = placed[random.below(30)];
        const float along = random.unit(), side = static_cast<float>(random.below(2));
        const Vec3 edge = random.below(2) ? Vec3{along, side, 0} : Vec3{side, along, 0};
        rays[i].origin = random.point(-1000, 1000);
        rays[i].direction = transform_point(at.world_from_local, edge) - rays[i].origin;
        for (const PlacedBvh& p : placed) {
            const Ray local = transform_ray(inverse(p.world_from_local), rays[i]);
            trace_by_brute_force(quad, local, p.instance, AcceptAll{}, expected[i]);
        }
        hits += expected[i].instance != kNoHit ? 1 : 0;
    }
    CHECK(hits > 5000);
    check_traversal(scene, rays, expected, AcceptAll{});
}
