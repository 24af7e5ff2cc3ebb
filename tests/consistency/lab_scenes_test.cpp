// In public scenes every combination of structure, traversal and switches finds the hits of the reference traversal,
// bit for bit, and the reference traversal those of brute force.

#include <doctest/doctest.h>

#include <cmath>
#include <optional>

#include "formats/read_scene.h"
#include "session/survey/default_camera.h"
#include "tests/support/lab_combinations.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

// The number of rays of each kind. Sanitizers take fifty times as long per ray and tree.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr uint64_t kSceneRays = 3'000, kOtherTreeRays = 3'000;
constexpr bool kTwoScenes = false;
#else
constexpr uint64_t kSceneRays = 20'000, kOtherTreeRays = 5'000;
constexpr bool kTwoScenes = true;
#endif
constexpr const char *kSponzaFile = "crytek-sponza/sponza.obj", *kSibenikFile = "sibenik/sibenik.obj";

/// Lists every traversal with every switch over the first trees. With `half` it lists all switches on, and every
/// second one of the other switches: the two halves together have all.
std::vector<Combination> over_first_trees(bool is_cuda, std::optional<std::size_t> half) {
    std::vector<Combination> list;
    const LabSettings all = all_combinations(is_cuda, false);
    for (const Distribution distribution : all.distributions) {
        for (const TraversalKind traversal : all.traversals) {
            for (const StructureKind structure : all.structures) {
                if (!is_first_tree(structure) || why_not(structure, traversal)) continue;
                const std::size_t pair = static_cast<std::size_t>(traversal) + static_cast<std::size_t>(structure);
                for (std::size_t i = 0; i < all.options.size(); ++i) {
                    if (half && !is_switched_on(all.options[i]) && (pair + i) % 2 != *half) continue;
                    list.push_back({structure, traversal, all.options[i], distribution});
                }
            }
        }
    }
    return list;
}

/// Lists every traversal with all switches on over all other trees, in the long setting with RTA at nodes alone too.
std::vector<Combination> over_other_trees(bool is_cuda) {
    std::vector<Combination> list;
    const bool at_nodes = test::effort(0, 1) != 0;
    const LabSettings all = all_combinations(is_cuda, false);
    for (const Distribution distribution : all.distributions) {
        for (const TraversalKind traversal : all.traversals) {
            for (const StructureKind structure : all.structures) {
                if (is_first_tree(structure) || why_not(structure, traversal)) continue;
                list.push_back({structure, traversal, {}, distribution});
                if (at_nodes) list.push_back({structure, traversal, {.rta_at_pops = false}, distribution});
            }
        }
    }
    return list;
}

std::vector<Combination> over_all_trees(bool is_cuda) {
    std::vector<Combination> list = over_first_trees(is_cuda, {});
    const std::vector<Combination> others = over_other_trees(is_cuda);
    list.insert(list.end(), others.begin(), others.end());
    return list;
}

std::optional<Scene> read_geometry(const char* name) {
    const auto file = test_scene(name);
    if (!file) return {};
    Messages messages;
    ReadOptions options;
    options.geometry_only = true;
    return read_scene(*file, options, messages);
}

/// Keeps the triangles whose first vertex is at x or beyond.
void keep_beyond(float x, Scene& scene) {
    for (Mesh& mesh : scene.meshes) {
        std::vector<uint32_t> kept;
        for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
            if (mesh.positions[mesh.indices[i]].x < x) continue;
            kept.insert(kept.end(), &mesh.indices[i], &mesh.indices[i] + 3);
        }
        mesh.indices = std::move(kept);
    }
}

void check_scene_by(Queue& queue, const Scene& scene, std::vector<Combination> combinations, uint64_t rays) {
    LabSettings settings = all_combinations(queue.is_cuda(), false);
    settings.only = std::move(combinations);
    settings.width = static_cast<uint32_t>(std::sqrt(static_cast<double>(rays) * 4 / 3)) + 1;
    settings.height = settings.width * 3 / 4 + 1;
    settings.depth = 2;
    Messages messages;
    const Camera camera = make_default_camera(scene, 4.0f / 3.0f, messages);
    const LabReport report = run_lab(queue, scene, camera, settings);
    REQUIRE(report.sets.size() == 3);
    CHECK(report.sets[0].rays >= rays);
    for (const SetFigures& set : report.sets) CHECK(set.brute_force_rays >= 2200);
    check_report(report, 36);
}

/// Traces each combination over all triangles of both scenes, for a GPU and for the long setting.
void check_all_scenes(Queue& queue) {
    for (const char* name : {kSponzaFile, kSibenikFile}) {
        const auto scene = read_geometry(name);
        if (scene) check_scene_by(queue, *scene, over_all_trees(queue.is_cuda()), 1'000'000);
    }
}

} // namespace

TEST_CASE(
    "each traversal with each switch gives the same hits on 20,000 rays of each kind in Sponza, Sibenik or both") {
    Queue queue = Queue::make_cpu();
    if (effort(0, 1) != 0) return check_all_scenes(queue);
    if (kTwoScenes) {
        auto sponza = read_geometry(kSponzaFile);
        if (sponza) {
            keep_beyond(
                46,
                *sponza); // a quarter of the triangles, with which brute force and builders take a quarter of the time
            check_scene_by(queue, *sponza, over_first_trees(false, 0), kSceneRays);
        }
    }
    const auto sibenik = read_geometry(kSibenikFile);
    if (!sibenik) return;
    check_scene_by(queue, *sibenik, over_first_trees(false, kTwoScenes ? std::optional<std::size_t>(1) : std::nullopt),
                   kSceneRays);
}

TEST_CASE("each traversal gives the same hits over each tree on 5,000 rays of each kind in Sibenik") {
    if (effort(0, 1) != 0) return; // the long setting tests these on all rays of both scenes
    const auto sibenik = read_geometry(kSibenikFile);
    if (!sibenik) return;
    Queue queue = Queue::make_cpu();
    check_scene_by(queue, *sibenik, over_other_trees(false), kOtherTreeRays);
}

TEST_CASE("CUDA: every combination gives the same hits in public scenes") {
    if (!cuda_requested()) return;
    Queue queue = make_cuda_queue();
    check_all_scenes(queue);
}
