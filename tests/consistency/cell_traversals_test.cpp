// Traversals of kd-trees and octrees find the hits of brute force, bit for bit, with all switches. Triangles in
// splitting planes and rays along these planes are included.

#include <doctest/doctest.h>

#include <utility>
#include <vector>

#include "accel/bvh/tlas.h"
#include "accel/kd_tree/build_kd_tree.h"
#include "accel/octree/build_octree.h"
#include "tests/support/check_traversal.h"
#include "tests/support/options.h"
#include "tests/support/stress_meshes.h"
#include "trace/cells/kd_tree_traversal.h"
#include "trace/cells/octree_traversal.h"

using namespace pertev;
using namespace pertev::test;

namespace {

const KdTreeSettings kKdSettings[] = {{},
                                      {.split = KdSplit::SpatialMedian, .max_leaf = 1},
                                      {.split = KdSplit::SpatialMedian, .max_depth = 7, .max_leaf = 6},
                                      {.max_references = 64, .node_cost = 0.01f, .empty_bonus = 0.9f}};

const OctreeSettings kOctreeSettings[] = {
    {}, {.max_leaf = 1}, {.max_depth = 3, .max_leaf = 2}, {.max_depth = 20, .max_leaf = 1, .max_references = 100}};

template <template <TraversalOptions> class Traversal, class Tree>
void check_all_options(const SceneTrees<Tree>& scene, const std::vector<Ray>& rays, const std::vector<Hit>& expected,
                       const auto& accept) {
    check_traversal<Traversal<TraversalOptions{}>>(scene, rays, expected, accept);
    check_traversal<Traversal<TraversalOptions{.rta = false}>>(scene, rays, expected, accept);
    check_traversal<Traversal<TraversalOptions{.near_first = false}>>(scene, rays, expected, accept);
    check_traversal<Traversal<TraversalOptions{.rta = false, .near_first = false}>>(scene, rays, expected, accept);
}

} // namespace

TEST_CASE("kd-trees of all build settings match brute force bit for bit") {
    for (const StressMesh& c : stress_meshes()) {
        CAPTURE(c.name);
        const std::vector<Ray> rays = stress_rays(static_cast<uint32_t>(effort(600, 20000)), c, 41);
        const std::vector<Hit> all = hits_by_brute_force(c.triangles, rays, AcceptAll{});
        const std::vector<Hit> some = hits_by_brute_force(c.triangles, rays, AcceptSome{});
        for (const KdTreeSettings& settings : kKdSettings) {
            CAPTURE(settings.max_leaf);
            CAPTURE(settings.max_references);
            const KdTree tree = build_kd_tree(c.triangles, settings);
            check_all_options<KdTreeTraversal>(scene_of(view_of(tree)), rays, all, AcceptAll{});
            check_all_options<KdTreeTraversal>(scene_of(view_of(tree)), rays, some, AcceptSome{});
        }
    }
}

TEST_CASE("octrees of all build settings match brute force bit for bit") {
    for (const StressMesh& c : stress_meshes()) {
        CAPTURE(c.name);
        const std::vector<Ray> rays = stress_rays(static_cast<uint32_t>(effort(600, 20000)), c, 43);
        const std::vector<Hit> all = hits_by_brute_force(c.triangles, rays, AcceptAll{});
        const std::vector<Hit> some = hits_by_brute_force(c.triangles, rays, AcceptSome{});
        for (const OctreeSettings& settings : kOctreeSettings) {
            CAPTURE(settings.max_depth);
            CAPTURE(settings.max_leaf);
            const Octree tree = build_octree(c.triangles, settings);
            check_all_options<OctreeTraversal>(scene_of(view_of(tree)), rays, all, AcceptAll{});
            check_all_options<OctreeTraversal>(scene_of(view_of(tree)), rays, some, AcceptSome{});
        }
    }
}

namespace {

/// Meshes with transforms that rotate, scale and mirror, and the hits of brute force.
struct PlacedMeshes {
    std::vector<BvhTriangle> meshes[4] = {
        triangles_of(make_torus(16, 12)), make_soup(300, 0), make_soup(200, 1000.0f), {}};
    std::vector<BvhTriangle> baked = triangles_of(make_torus(20, 16), 7);
    std::vector<PlacedBvh> placed;
    std::vector<Ray> rays;
    std::vector<Hit> expected;

    PlacedMeshes() {
        Random random(6);
        for (uint32_t i = 0; i < 40; ++i) {
            const uint32_t mesh = i % 4;
            const Vec3 axis = random.direction();
            const float w = random.within(-1, 1), s = sqrt(1 - w * w);
            Transform place = make_rotation(s * axis.x, s * axis.y, s * axis.z, w);
            if (i % 5 == 0) place = Transform{}; // the identity is exact, and has ties with its neighbours
            if (i % 3 == 0) place = compose(place, make_scale({0.5f, random.within(0.01f, 4), -1}));
            place = compose(make_translation(i % 5 == 0 ? Vec3{} : random.point(-3, 3)), place);
            if (mesh == 2) place = compose(place, make_translation({-1000, 0, 1000})); // far from the mesh's origin
            Bounds3 bounds;
            for (const BvhTriangle& t : meshes[mesh]) bounds.extend(t.a), bounds.extend(t.b), bounds.extend(t.c);
            placed.push_back({place, bounds, mesh, i * 3 + 1});
        }
        rays = stress_rays(static_cast<uint32_t>(effort(1500, 30000)), {"torus", baked, {}, 1}, 47);
        expected = hits_by_brute_force(baked, rays, AcceptSome{});
        for (std::size_t i = 0; i < rays.size(); ++i) {
            for (const PlacedBvh& p : placed) {
                const Ray local = transform_ray(inverse(p.world_from_local), rays[i]);
                trace_by_brute_force(meshes[p.blas], local, p.instance, AcceptSome{}, expected[i]);
            }
        }
    }

    template <template <TraversalOptions> class Traversal, class Build>
    void check(const Build& build) const {
        using Tree = decltype(build(baked));
        using View = decltype(view_of(std::declval<Tree>()));
        std::vector<Tree> trees;
        std::vector<View> views;
        for (const auto& mesh : meshes) trees.push_back(build(mesh));
        for (const Tree& tree : trees) views.push_back(view_of(tree));
        const Tree baked_tree = build(baked);
        const Tlas top = build_tlas(placed);
        const SceneTrees<View> scene = {
            view_of(baked_tree), top.nodes.data(), top.instances.data(), views.data(), top.root, top.reach, top.growth};
        check_all_options<Traversal>(scene, rays, expected, AcceptSome{});
    }
};

} // namespace

TEST_CASE("instances of kd-trees and octrees match brute force bit for bit") {
    const PlacedMeshes scene;
    scene.check<KdTreeTraversal>([](const auto& mesh) { return build_kd_tree(mesh); });
    scene.check<KdTreeTraversal>(
        [](const auto& mesh) { return build_kd_tree(mesh, {.split = KdSplit::SpatialMedian}); });
    scene.check<OctreeTraversal>([](const auto& mesh) { return build_octree(mesh); });
}
