// The hits do not depend on the distribution of rays to threads: one ray per thread and, with --device cuda,
// persistent threads with a pool, dynamic fetch, and packets of a warp. Counts of live lanes add up to the visits of
// the rays.

#include <doctest/doctest.h>

#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "accel/builders/build_bvh.h"
#include "accel/bvh/compressed_bvh.h"
#include "accel/bvh/parent_links.h"
#include "device/buffer.h"
#include "tests/support/check_traversal.h"
#include "tests/support/instanced_scene.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/stress_meshes.h"
#include "tests/support/traversal_launches.h"
#include "trace/binary/while_while_traversal.h"

using namespace pertev;
using namespace pertev::test;

namespace {

struct TreeOnDevice {
    Buffer<BvhNode> nodes;
    Buffer<BvhTriangle> triangles;
    BvhView view;

    TreeOnDevice(Queue& queue, const Bvh& bvh)
        : nodes(queue, std::span<const BvhNode>(bvh.nodes), "nodes"),
          triangles(queue, std::span<const BvhTriangle>(bvh.triangles), "triangles"), view(view_of(bvh)) {
        view.nodes = nodes.data();
        view.triangles = triangles.data();
    }
};

struct CompressedOnDevice {
    CompressedBvh bvh;
    Buffer<CompressedBvhNode> nodes;
    Buffer<BvhTriangle> triangles;
    CompressedBvhView view;

    CompressedOnDevice(Queue& queue, const Bvh& binary)
        : bvh(make_compressed_bvh(binary)),
          nodes(queue, std::span<const CompressedBvhNode>(bvh.nodes), "compressed nodes"),
          triangles(queue, std::span<const BvhTriangle>(bvh.triangles), "compressed triangles"), view(view_of(bvh)) {
        if (view.nodes == nullptr) return;
        view.nodes = nodes.data();
        view.triangles = triangles.data();
    }
};

struct BatchOnDevice {
    Buffer<Ray> rays;
    Buffer<Hit> hits;
    Buffer<uint32_t> pool;

    BatchOnDevice(Queue& queue, const std::vector<Ray>& values)
        : rays(queue, std::span<const Ray>(values), "rays"), hits(queue, values.size(), "hits"),
          pool(queue, 1, "pool") {}
    /// Returns the batch of one launch. It resets the pool.
    TraversalBatch view() {
        pool.zero();
        return {rays.data(), hits.data(), static_cast<uint32_t>(rays.size()), pool.data()};
    }
};

Bvh linked_bvh(const std::vector<BvhTriangle>& triangles) {
    Bvh bvh = build_bvh(triangles);
    add_parent_links(bvh);
    return bvh;
}

uint64_t count_wrong(const std::vector<Hit>& hits, const std::vector<Hit>& expected, const std::vector<Ray>& rays,
                     bool any) {
    uint64_t wrong = 0;
    for (std::size_t i = 0; i < hits.size(); ++i) {
        Hit want = expected[i];
        const bool found = want.instance != kNoHit;
        if (any) {
            want = {.t = 0, .instance = found ? 0 : kNoHit};
        } else if (!found) {
            want.t = rays[i].t_max;
        }
        wrong += hits[i] == want ? 0 : 1;
    }
    return wrong;
}

} // namespace

TEST_CASE("every distribution of rays to threads finds each ray's hit") {
    Queue queue = requested_queue();
    for (const StressMesh& c : stress_meshes()) {
        CAPTURE(std::string(c.name));
        const std::vector<Ray> rays = stress_rays(static_cast<uint32_t>(effort(333, 20011)), c, 43);
        const std::vector<Hit> expected = hits_by_brute_force(c.triangles, rays, AcceptAll{});
        const Bvh bvh = linked_bvh(c.triangles);
        const TreeOnDevice tree(queue, bvh);
        const CompressedOnDevice compressed(queue, bvh);
        for (const TraversalLaunch& launch : traversal_launches(queue.is_cuda())) {
            CAPTURE(std::string(launch.traversal));
            CAPTURE(std::string(launch.distribution));
            CAPTURE(launch.any);
            CAPTURE(launch.rta);
            BatchOnDevice batch(queue, rays);
            batch.hits.zero();
            launch.run(queue, {tree.view, compressed.view}, batch.view());
            queue.wait();
            CHECK(count_wrong(batch.hits.download(), expected, rays, launch.any) == 0);
        }
    }
}

TEST_CASE("every distribution of rays to threads finds each ray's hit over instances, including divergent packets") {
    Queue queue = requested_queue();
    InstancedScene s = make_instanced_scene(static_cast<uint32_t>(effort(300, 20011)));
    std::vector<TreeOnDevice> trees;
    std::vector<CompressedOnDevice> compressed;
    std::vector<BvhView> views;
    std::vector<CompressedBvhView> compressed_views;
    for (Bvh& tree : s.trees) {
        add_parent_links(tree);
        trees.emplace_back(queue, tree);
        compressed.emplace_back(queue, tree);
        views.push_back(trees.back().view);
        compressed_views.push_back(compressed.back().view);
    }
    add_parent_links(s.baked_tree);
    const TreeOnDevice baked(queue, s.baked_tree);
    const CompressedOnDevice compressed_baked(queue, s.baked_tree);
    const Buffer<BvhNode> tlas_nodes(queue, std::span<const BvhNode>(s.top.nodes), "top nodes");
    const Buffer<InstanceRecord> instances(queue, std::span<const InstanceRecord>(s.top.instances), "instances");
    const Buffer<BvhView> meshes(queue, std::span<const BvhView>(views), "meshes");
    const Buffer<CompressedBvhView> compressed_meshes(queue, std::span<const CompressedBvhView>(compressed_views),
                                                      "compressed meshes");
    const auto scene_over = [&](const auto& tree, const auto& mesh_trees) {
        return SceneTrees<std::remove_cvref_t<decltype(tree)>>{
            tree, tlas_nodes.data(), instances.data(), mesh_trees.data(), s.top.root, s.top.reach, s.top.growth};
    };
    const TraversalScenes scenes = {scene_over(baked.view, meshes),
                                    scene_over(compressed_baked.view, compressed_meshes)};
    std::vector<Hit> expected(s.rays.size());
    for (std::size_t i = 0; i < s.rays.size(); ++i) {
        trace_by_brute_force(s.baked, s.rays[i], kNoHit, AcceptAll{}, expected[i]);
        for (const PlacedBvh& p : s.placed) {
            const Ray local = transform_ray(inverse(p.world_from_local), s.rays[i]);
            trace_by_brute_force(s.meshes[p.blas], local, p.instance, AcceptAll{}, expected[i]);
        }
    }
    int launches = 0;
    for (const TraversalLaunch& launch : traversal_launches(queue.is_cuda())) {
        if (launch.run_scene == nullptr) continue;
        CAPTURE(std::string(launch.traversal));
        CAPTURE(std::string(launch.distribution));
        CAPTURE(launch.any);
        BatchOnDevice batch(queue, s.rays);
        batch.hits.zero();
        launch.run_scene(queue, scenes, batch.view());
        queue.wait();
        CHECK(count_wrong(batch.hits.download(), expected, s.rays, launch.any) == 0);
        ++launches;
    }
    // Nine traversals for closest and any hits; on a GPU also from a pool, and three with dynamic fetch.
    CHECK(launches == (queue.is_cuda() ? 42 : 18));
}

TEST_CASE("the active lanes add up to the visits of the rays") {
    Queue queue = requested_queue();
    const Bvh bvh = linked_bvh(triangles_of(make_torus(60, 40)));
    const TreeOnDevice tree(queue, bvh);
    Random random(4);
    std::vector<Ray> rays(static_cast<std::size_t>(effort(3001, 100'003)));
    uint64_t nodes = 0, triangles = 0;
    for (Ray& ray : rays) {
        ray.origin = random.point(-3, 3);
        ray.direction = random.point(-1, 1) - ray.origin;
        Hit hit;
        trace_closest<WhileWhileTraversal<TraversalOptions{}>>(SingleTree<BvhView>{view_of(bvh)}, ray, AcceptAll{}, hit,
                                                               TraversalCounter{&nodes, &triangles});
    }
    BatchOnDevice batch(queue, rays);
    for (const LaneLaunch count_lanes : lane_launches(queue.is_cuda())) {
        Buffer<LaneCounts> counts(queue, 1, "counts");
        counts.zero();
        count_lanes(queue, tree.view, batch.view(), counts.data());
        queue.wait();
        const LaneCounts sums = counts.download()[0];
        CHECK(sums.node_lanes == nodes);
        CHECK(sums.triangle_lanes == triangles);
        const uint64_t warp = queue.is_cuda() ? 32 : 1;
        CHECK(sums.node_steps <= nodes);
        CHECK(sums.node_steps * warp >= nodes);
        CHECK(sums.triangle_steps * warp >= triangles);
        CHECK(sums.node_requests == 4 * sums.node_steps); // 64 bytes in steps of 16
        CHECK(sums.triangle_requests == 3 * sums.triangle_steps);
        CHECK(sums.node_sectors >= sums.node_requests);
        CHECK(sums.node_sectors <= 4 * sums.node_lanes);
        CHECK(sums.triangle_sectors <= 3 * sums.triangle_lanes);
    }
}
