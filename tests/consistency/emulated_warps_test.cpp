// Code that only a GPU runs finds the hits of the host's traversals for any scheduling of warps: persistent threads,
// dynamic fetch, warp packets, postponed triangles and leaves, counts of live lanes. It runs on emulated warps
// (tests/support/emulated_warp.h). No vote may name a lane that does not arrive, each ray is stored once, and the pool
// ends at the last ray. A failure prints the seed, which replays it.

#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "accel/builders/build_bvh.h"
#include "accel/bvh/compressed_bvh.h"
#include "tests/support/check_traversal.h"
#include "tests/support/emulated_traversals.h"
#include "tests/support/instanced_scene.h"
#include "tests/support/options.h"
#include "tests/support/stress_meshes.h"
#include "trace/binary/while_while_traversal.h"
#include "trace/warps/lane_counter.h"
#include "trace/wide/compressed_traversal.h"

using namespace pertev;
using namespace pertev::test;

namespace {

constexpr uint32_t kThreads = 128; // a block

// AddressSanitizer takes twenty times as long.
#if defined(__SANITIZE_ADDRESS__)
constexpr uint32_t kRays = 67, kMaxRays = 203, kFew = 1;
#else
constexpr uint32_t kRays = 331, kMaxRays = 1000, kFew = 3;
#endif

/// Stores the host's hits as a batch does.
std::vector<Hit> as_stored(std::vector<Hit> hits, const std::vector<Ray>& rays, bool any) {
    for (std::size_t i = 0; i < hits.size(); ++i) {
        const bool found = hits[i].instance != kNoHit;
        if (any) {
            hits[i] = {.t = 0, .instance = found ? 0 : kNoHit};
        } else if (!found) {
            hits[i].t = rays[i].t_max;
        }
    }
    return hits;
}

struct Expected {
    const std::vector<Ray>& rays;
    const std::vector<Hit>& hits; // the closest hits of the host
};

/// Runs a batch on warps and compares its results with the expected ones. With a pool there are `blocks` blocks.
template <class Run>
void check_batch(const EmulatedTraversal& traversal, const Expected& expected, uint32_t blocks, uint32_t seed,
                 const Run& run, LaneCounts* lanes = nullptr) {
    const std::string way = traversal.distribution;
    const auto count = static_cast<uint32_t>(expected.rays.size());
    CAPTURE(std::string(traversal.traversal));
    CAPTURE(way);
    CAPTURE(traversal.rta);
    CAPTURE(std::string(traversal.tests));
    CAPTURE(traversal.any);
    CAPTURE(traversal.cut_outs);
    CAPTURE(count);
    CAPTURE(blocks);
    CAPTURE(seed);
    std::vector<Hit> hits(count, Hit{.t = -1});
    std::vector<uint32_t> stores(count + 1);
    uint32_t pool = 0;
    const std::string fault =
        run(EmulatedBatch{expected.rays.data(), hits.data(), stores.data(), count, &pool, blocks, seed, lanes});
    REQUIRE(fault == "");
    CHECK(std::count(stores.begin(), stores.end() - 1, 1u) == count);
    CHECK(stores[count] == 0);
    const std::vector<Hit> want = as_stored(expected.hits, expected.rays, traversal.any);
    const auto wrong = std::mismatch(hits.begin(), hits.end(), want.begin());
    if (wrong.first != hits.end()) {
        const auto i = static_cast<std::size_t>(wrong.first - hits.begin());
        FAIL_CHECK("ray ", i, ": ", text_of(expected.rays[i]), " t ", hits[i].t, " want ", want[i].t);
    }
    const uint32_t warps = blocks * (kThreads / 32);
    if (way == "one a thread") CHECK(pool == 0);
    if (way == "persistent") { // a warp continues until none of its lanes gets a ray
        CHECK(pool >= count + 32 * warps);
        CHECK(pool <= count + 64 * warps);
    }
    if (way == "dynamic fetch") {
        CHECK(pool >= count);
        CHECK(pool <= max(count, 1u) - 1 + 32 * warps); // only the last fetch of a warp may exceed the count
    }
}

/// Trees over the same triangles in every layout.
struct TestTrees {
    Bvh bvh;
    CompressedBvh compressed_bvh;
    WoopBvh woop_bvh;
    BvhView binary;
    CompressedBvhView compressed;
    WoopBvhView woop;

    explicit TestTrees(const std::vector<BvhTriangle>& triangles)
        : bvh(build_bvh(triangles)), compressed_bvh(make_compressed_bvh(bvh)), woop_bvh(make_woop_bvh(bvh)),
          binary(view_of(bvh)), compressed(view_of(compressed_bvh)), woop(view_of(woop_bvh)) {}

    std::string run(const EmulatedTraversal& traversal, const EmulatedBatch& batch) const {
        return traversal.run({&binary, &compressed, &woop}, batch);
    }
};

/// The host's hits with the same tests. With exact tests every traversal has these hits.
struct HostHits {
    std::vector<Hit> exact, cut_outs, fast_binary, fast_compressed, woop;

    HostHits(const TestTrees& trees, const std::vector<Ray>& rays) {
        constexpr TraversalOptions kFast = {.tests = TestKind::Fast}, kWoop = {.tests = TestKind::Woop};
        const SingleTree<BvhView> binary = {trees.binary};
        for (const Ray& ray : rays) {
            trace_closest(binary, ray, AcceptAll{}, exact.emplace_back());
            trace_closest(binary, ray, AcceptSome{}, cut_outs.emplace_back());
            trace_closest<WhileWhileTraversal<kFast>>(binary, ray, AcceptAll{}, fast_binary.emplace_back());
            trace_closest<CompressedTraversal<kFast>>(SingleTree<CompressedBvhView>{trees.compressed}, ray, AcceptAll{},
                                                      fast_compressed.emplace_back());
            trace_closest<WhileWhileTraversal<kWoop>>(SingleTree<WoopBvhView>{trees.woop}, ray, AcceptAll{},
                                                      woop.emplace_back());
        }
    }
    const std::vector<Hit>& of(const EmulatedTraversal& traversal) const {
        if (traversal.cut_outs) return cut_outs;
        const std::string tests = traversal.tests;
        if (tests == "woop") return woop;
        return tests == "exact"                                   ? exact
               : std::string(traversal.traversal) == "compressed" ? fast_compressed
                                                                  : fast_binary;
    }
};

} // namespace

TEST_CASE("on warps, every traversal with every distribution of rays finds each ray's hit once") {
    const uint32_t rounds = static_cast<uint32_t>(effort(1, 40));
    uint32_t seed = 0;
    for (const StressMesh& c : stress_meshes(500)) {
        CAPTURE(std::string(c.name));
        const bool has_ties = c.extent != 1 || std::string(c.name).find("soup") != 0;
        const TestTrees trees(c.triangles);
        for (uint32_t round = 0; round < rounds; ++round) {
            const std::vector<Ray> rays = stress_rays(kRays, c, 7 + round);
            const HostHits host(trees, rays);
            for (const EmulatedTraversal& traversal : emulated_traversals()) {
                // With inexact tests, the hit at a tie depends on the nodes that were skipped before.
                if (traversal.run == nullptr || traversal.counts_lanes ||
                    (traversal.tests != std::string("exact") && has_ties))
                    continue;
                check_batch(traversal, {rays, host.of(traversal)}, 2, ++seed,
                            [&](const EmulatedBatch& batch) { return trees.run(traversal, batch); });
            }
        }
    }
}

TEST_CASE("on warps, each ray's hit is found once for any number of rays and warps") {
    const StressMesh mesh = stress_meshes()[3];
    const TestTrees trees(mesh.triangles);
    uint32_t seed = 0;
    struct Size {
        uint32_t rays, blocks;
    };
    const Size sizes[] = {{0, 1}, {1, 1}, {1, 3}, {5, 2}, {31, 1}, {32, 1}, {33, 2}, {100, 4}, {257, 9}, {kMaxRays, 3}};
    for (const auto [count, blocks] : sizes) {
        const std::vector<Ray> rays = stress_rays(count, mesh, 3);
        const HostHits host(trees, rays);
        for (const EmulatedTraversal& traversal : emulated_traversals()) {
            if (traversal.run == nullptr || traversal.counts_lanes) continue;
            const uint32_t rounds = static_cast<uint32_t>(effort(count < 1000 ? kFew : 1, 100));
            for (uint32_t round = 0; round < rounds; ++round) {
                check_batch(traversal, {rays, host.of(traversal)}, blocks, ++seed,
                            [&](const EmulatedBatch& batch) { return trees.run(traversal, batch); });
            }
        }
    }
}

TEST_CASE("on warps, each ray's hit is found over instances where lanes diverge between meshes") {
    const InstancedScene s = make_instanced_scene(static_cast<uint32_t>(effort(kRays, 20'011)));
    std::vector<BvhView> views;
    std::vector<CompressedBvh> compressed;
    std::vector<CompressedBvhView> compressed_views;
    for (const Bvh& tree : s.trees) {
        views.push_back(view_of(tree));
        compressed.push_back(make_compressed_bvh(tree));
    }
    for (const CompressedBvh& tree : compressed) compressed_views.push_back(view_of(tree));
    const CompressedBvh compressed_baked = make_compressed_bvh(s.baked_tree);
    const SceneBvhView binary_scene = s.scene(views, view_of(s.baked_tree));
    const SceneTrees<CompressedBvhView> compressed_scene = s.scene(compressed_views, view_of(compressed_baked));
    std::vector<Hit> expected(s.rays.size());
    for (std::size_t i = 0; i < s.rays.size(); ++i) trace_closest(binary_scene, s.rays[i], AcceptAll{}, expected[i]);
    int runs = 0;
    for (const EmulatedTraversal& traversal : emulated_traversals()) {
        if (traversal.run_scene == nullptr) continue;
        check_batch(traversal, {s.rays, expected}, 2, static_cast<uint32_t>(++runs), [&](const EmulatedBatch& batch) {
            return traversal.run_scene({&binary_scene, &compressed_scene}, batch);
        });
    }
    CHECK(runs == 26); // four traversals with two distributions and three with dynamic fetch, for closest and any hits
}

TEST_CASE("on warps, the active lanes add up to the visits of the rays") {
    const TestTrees trees(triangles_of(make_torus(40, 24)));
    Random random(4);
    std::vector<Ray> rays(static_cast<std::size_t>(effort(kRays, 20'011)));
    std::vector<Hit> expected;
    uint64_t nodes = 0, triangles = 0;
    for (Ray& ray : rays) {
        ray.origin = random.point(-3, 3);
        ray.direction = random.point(-1, 1) - ray.origin;
        trace_closest<WhileWhileTraversal<TraversalOptions{}>>(SingleTree<BvhView>{trees.binary}, ray, AcceptAll{},
                                                               expected.emplace_back(),
                                                               TraversalCounter{&nodes, &triangles});
    }
    int runs = 0;
    for (const EmulatedTraversal& traversal : emulated_traversals()) {
        if (!traversal.counts_lanes) continue;
        CAPTURE(std::string(traversal.traversal));
        LaneCounts sums;
        check_batch(
            traversal, {rays, expected}, 2, static_cast<uint32_t>(++runs),
            [&](const EmulatedBatch& batch) { return trees.run(traversal, batch); }, &sums);
        if (std::string(traversal.traversal) == "while-while") {
            CHECK(sums.node_lanes == nodes);
            CHECK(sums.triangle_lanes == triangles);
        }
        const bool is_compressed = std::string(traversal.traversal) == "compressed";
        CHECK(sums.node_steps > 0);
        CHECK(sums.node_steps <= sums.node_lanes);
        CHECK(sums.node_lanes <= 32 * sums.node_steps);
        CHECK(sums.triangle_steps <= sums.triangle_lanes);
        CHECK(sums.triangle_lanes <= 32 * sums.triangle_steps);
        CHECK(sums.node_requests == (is_compressed ? 5 : 4) * sums.node_steps);
        CHECK(sums.triangle_requests == 3 * sums.triangle_steps);
        CHECK(sums.node_sectors >= sums.node_requests);
        CHECK(sums.node_sectors <= (is_compressed ? 5 : 4) * sums.node_lanes);
        CHECK(sums.triangle_sectors >= sums.triangle_requests);
        CHECK(sums.triangle_sectors <= 3 * sums.triangle_lanes);
    }
    CHECK(runs == 13);
}
