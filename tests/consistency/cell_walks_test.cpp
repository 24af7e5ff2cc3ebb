// The walks of trees that cut space, kd-tree and octree: the hits of testing every triangle, bit for bit, whatever is
// switched in the walk, also where triangles lie in the planes that cut, and rays along them.

#include <doctest/doctest.h>

#include <vector>

#include "accel/bvh/top_level_bvh.h"
#include "accel/kd_tree/build_kd_tree.h"
#include "tests/support/check_walk.h"
#include "tests/support/nasty_meshes.h"
#include "tests/support/options.h"
#include "trace/kd_tree_walk.h"

using namespace pertev;
using namespace pertev::test;

namespace {

const KdTreeSettings kKdSettings[] = {{},
                                      {.split = KdSplit::SpatialMedian, .max_leaf = 1},
                                      {.split = KdSplit::SpatialMedian, .max_depth = 7, .max_leaf = 6},
                                      {.max_references = 64, .node_cost = 0.01f, .empty_bonus = 0.9f}};

template <template <WalkOptions> class Walk, class Tree>
void check_all_options(const SceneTrees<Tree>& scene, const std::vector<Ray>& rays, const std::vector<Hit>& expected,
                       const auto& accept) {
    check_walk<Walk<WalkOptions{}>>(scene, rays, expected, accept);
    check_walk<Walk<WalkOptions{.rta = false}>>(scene, rays, expected, accept);
    check_walk<Walk<WalkOptions{.near_first = false}>>(scene, rays, expected, accept);
    check_walk<Walk<WalkOptions{.rta = false, .near_first = false}>>(scene, rays, expected, accept);
}

} // namespace

TEST_CASE("a kd-tree of any build setting gives the hits of testing every triangle, bit for bit") {
    for (const NastyMesh& c : nasty_meshes()) {
        CAPTURE(c.name);
        const std::vector<Ray> rays = nasty_rays(static_cast<uint32_t>(effort(800, 20000)), c, 41);
        const std::vector<Hit> all = hits_by_brute_force(c.triangles, rays, AcceptAll{});
        const std::vector<Hit> some = hits_by_brute_force(c.triangles, rays, AcceptSome{});
        for (const KdTreeSettings& settings : kKdSettings) {
            CAPTURE(settings.max_leaf);
            CAPTURE(settings.max_references);
            const KdTree tree = build_kd_tree(c.triangles, settings);
            check_all_options<KdTreeWalk>(scene_of(view_of(tree)), rays, all, AcceptAll{});
            check_all_options<KdTreeWalk>(scene_of(view_of(tree)), rays, some, AcceptSome{});
        }
    }
}
