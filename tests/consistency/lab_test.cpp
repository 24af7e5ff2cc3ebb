// Every combination of structure, traversal and switches gives the hits of the proven traversal, bit for bit, and that
// traversal those of brute force: in public scenes and in meshes made to break them, with instances and without.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "base/parallel_for.h"
#include "formats/read_scene.h"
#include "lab/record_scenes.h"
#include "lab/run_lab.h"
#include "session/survey/default_camera.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/stress_meshes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

// Number of each kind in all public scenes together; sanitizers take fifty times as long per ray and tree.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr uint64_t kRaysAKind = 3'000;
constexpr const char* kFiles[] = {"sibenik/sibenik.obj"};
#else
constexpr uint64_t kRaysAKind = 50'000;
constexpr const char* kFiles[] = {"crytek-sponza/sponza.obj", "sibenik/sibenik.obj"};
#endif

std::vector<TraversalOptions> exact_options() {
    std::vector<TraversalOptions> options;
    for (const bool rta : {true, false}) {
        for (const bool near_first : {true, false}) options.push_back({rta, near_first});
    }
    options.push_back({.rta_at_pops = false});
    return options;
}

/// Everything that is there on a device; brute force only where a scene is small.
LabSettings all_combinations(bool is_cuda, bool brute_force) {
    LabSettings settings;
    settings.structures.assign(kValuesOf<StructureKind>.begin(), kValuesOf<StructureKind>.end());
    settings.traversals.assign(kValuesOf<TraversalKind>.begin(), kValuesOf<TraversalKind>.end());
    if (!brute_force) std::erase(settings.traversals, TraversalKind::BruteForce);
    settings.options = exact_options();
    if (is_cuda) {
        settings.distributions = {Distribution::OneAThread, Distribution::Persistent, Distribution::DynamicFetch};
    }
    settings.runs = settings.warm_ups = 0;
    settings.heat_maps = false;
    return settings;
}

/// Lists every traversal with every switch over trees with spatial splits, kd-trees and octrees, and every structure
/// with all switches on, in the long setting with RTA at nodes alone too. A GPU and the long setting trace each
/// combination in all scenes. The short setting traces those of the first trees with all switches on in both scenes,
/// and each other combination in one of the two: a fourth of the pairs of structure and traversal in the larger one,
/// and half of the switches. Thus each structure, each traversal and each switch still meets the rays of both scenes.
LabSettings some_combinations(bool is_cuda, std::size_t scene) {
    const bool all_scenes = is_cuda || test::effort(0, 1) != 0 || std::size(kFiles) == 1,
               at_nodes = test::effort(0, 1) != 0;
    const LabSettings all = all_combinations(is_cuda, false);
    LabSettings settings = all;
    for (const Distribution distribution : all.distributions) {
        for (const TraversalKind traversal : all.traversals) {
            for (const StructureKind structure : all.structures) {
                if (why_not(structure, traversal)) continue;
                const bool every_switch = structure == StructureKind::SpatialSplits || traversal == TraversalKind::Kd ||
                                          traversal == TraversalKind::Octree;
                const std::size_t pair = static_cast<std::size_t>(traversal) + static_cast<std::size_t>(structure);
                const std::size_t dealt_to = pair % 4 == 0 ? 0 : 1;
                for (std::size_t i = 0; i < all.options.size(); ++i) {
                    const TraversalOptions& options = all.options[i];
                    const bool switched_on = options.rta && options.near_first && (options.rta_at_pops || at_nodes);
                    const bool here = every_switch ? switched_on || (pair + i) % 2 == scene : dealt_to == scene;
                    if ((every_switch || switched_on) && (here || all_scenes)) {
                        settings.only.push_back({structure, traversal, options, distribution});
                    }
                }
            }
        }
    }
    return settings;
}

void check(const LabReport& report) {
    uint64_t checked = 0;
    for (const CombinationFigures& c : report.combinations) {
        CAPTURE(c.name);
        CAPTURE(c.refused);
        CHECK_FALSE(c.refused.starts_with("WRONG"));
        CHECK_FALSE(c.refused == "not compiled");
        for (const RunFigures& run : c.runs) CHECK(run.different == 0);
        checked += c.runs.empty() ? 0 : 1;
    }
    CHECK(checked >= 40);
}

void check_file(std::size_t number, Queue& queue, uint64_t rays) {
    const auto file = test_scene(kFiles[number]);
    if (!file) return;
    Messages messages;
    ReadOptions options;
    options.geometry_only = true;
    const Scene scene = read_scene(*file, options, messages);
    LabSettings settings = some_combinations(queue.is_cuda(), number);
    settings.width = static_cast<uint32_t>(std::sqrt(static_cast<double>(rays) * 4 / 3)) + 1;
    settings.height = settings.width * 3 / 4 + 1;
    settings.depth = 2;
    const Camera camera = make_default_camera(scene, 4.0f / 3.0f, messages);
    const LabReport report = run_lab(queue, scene, camera, settings, {});
    REQUIRE(report.sets.size() == 3);
    CHECK(report.sets[0].rays >= rays);
    for (const SetFigures& set : report.sets) CHECK(set.brute_force_rays >= 2200);
    check(report);
}

/// The mesh's triangles as one instance a given number.
Scene scene_of(const StressMesh& stress) {
    Scene scene;
    scene.materials.resize(1);
    scene.meshes.resize(1);
    for (const BvhTriangle& t : stress.triangles) {
        for (const Vec3 corner : {t.a, t.b, t.c}) {
            scene.meshes[0].indices.push_back(static_cast<uint32_t>(scene.meshes[0].positions.size()));
            scene.meshes[0].positions.push_back(corner);
        }
    }
    scene.instances.push_back({.name = "nasty", .mesh = 0, .material = 0, .world_from_local = {}});
    return scene;
}

void check_stress_meshes(Queue& queue, uint32_t side) {
    for (const StressMesh& stress : stress_meshes()) {
        if (stress.triangles.empty()) continue;
        CAPTURE(stress.name);
        const Scene scene = scene_of(stress);
        LabSettings settings = all_combinations(queue.is_cuda(), true);
        settings.width = settings.height = side;
        settings.depth = 3;
        Camera camera;
        camera.world_from_camera =
            look_at(stress.centre + stress.extent * Vec3{1.5f, 0.7f, 3}, stress.centre, {0, 1, 0});
        check(run_lab(queue, scene, camera, settings, {}));
    }
}

} // namespace

TEST_CASE("every combination gives the same hits in the mixed scene with instances") {
    Queue queue = Queue::make_cpu();
    const Scene scene = make_mixed_scene();
    LabSettings settings = all_combinations(false, true);
    settings.width = 64, settings.height = 48, settings.depth = 3;
    const LabReport report = run_lab(queue, scene, mixed_scene_camera(), settings, {});
    check(report);
}

TEST_CASE("every combination gives the same hits in stress meshes") {
    Queue queue = Queue::make_cpu();
    check_stress_meshes(queue, static_cast<uint32_t>(effort(12, 48)));
}

TEST_CASE("every combination gives the same hits on 50,000 rays of each kind in Sponza, Sibenik or both") {
    Queue queue = Queue::make_cpu();
    for (std::size_t file = 0; file < std::size(kFiles); ++file) {
        check_file(file, queue, effort(kRaysAKind, 1'000'000));
    }
}

TEST_CASE("CUDA: every combination gives the same hits") {
    if (!cuda_requested()) return;
    Queue queue = make_cuda_queue();
    check_stress_meshes(queue, static_cast<uint32_t>(effort(64, 256)));
    const Scene mixed = make_mixed_scene(); // has instances
    LabSettings settings = all_combinations(true, true);
    settings.width = 64, settings.height = 48, settings.depth = 3;
    settings.runs = 1; // timed and counted too
    check(run_lab(queue, mixed, mixed_scene_camera(), settings, {}));
    for (std::size_t file = 0; file < std::size(kFiles); ++file) check_file(file, queue, 1'000'000);
}

TEST_CASE("inexact tests miss a few rays, which are counted") {
    Queue queue = requested_queue();
    const Vec3 centre = {1.5e5f, 0, -1.5e5f}; // 150 km away: a float's last bits are centimetres there
    const Scene scene = scene_of({"soup", make_soup(1500, 1.5e5f), centre});
    LabSettings settings;
    for (const TestKind tests : kValuesOf<TestKind>) {
        for (const TraversalKind traversal : {TraversalKind::WhileWhile, TraversalKind::Speculative}) {
            for (const Distribution distribution : all_combinations(queue.is_cuda(), false).distributions) {
                settings.only.push_back({StructureKind::Binned, traversal, {.tests = tests}, distribution});
            }
        }
    }
    settings.width = settings.height = 128;
    settings.runs = 1, settings.warm_ups = 0;
    Camera camera;
    camera.world_from_camera = look_at(centre + Vec3{1.5f, 0.7f, 3}, centre, {0, 1, 0});
    const LabReport report = run_lab(queue, scene, camera, settings, {});
    std::map<TestKind, uint64_t> bytes;
    for (const CombinationFigures& c : report.combinations) {
        CAPTURE(c.name);
        CAPTURE(c.refused);
        REQUIRE(c.runs.size() == 3);
        CHECK((c.runs[0].different == 0) == c.combination.options.is_exact());
        CHECK(c.runs[0].different < report.sets[0].rays / 2);
        if (c.combination.distribution == Distribution::OneAThread) { // the others are not counted
            CHECK(c.runs[0].nodes > 1);
            CHECK(c.runs[0].triangles > 0);
        }
        CHECK(c.runs[0].median_s > 0);
        bytes[c.combination.options.tests] = report.structures[c.structure.value()].bytes;
    }
    CHECK(bytes[TestKind::Fast] == bytes[TestKind::Exact]);
    CHECK(bytes[TestKind::Woop] == bytes[TestKind::Exact] + 1500 * sizeof(WoopTriangle));
}

TEST_CASE("Woop's tests traverse instances and differ from exact tests on few rays") {
    Queue queue = requested_queue();
    LabSettings settings;
    for (const TraversalKind traversal : {TraversalKind::WhileWhile, TraversalKind::Speculative}) {
        settings.only.push_back({StructureKind::SpatialSplits, traversal, {.tests = TestKind::Woop}});
    }
    settings.width = 256, settings.height = 192;
    settings.runs = settings.warm_ups = 0;
    const LabReport report = run_lab(queue, make_mixed_scene(), mixed_scene_camera(), settings, {});
    CHECK(report.instances > 1);
    for (const CombinationFigures& c : report.combinations) {
        CAPTURE(c.name);
        CAPTURE(c.refused);
        REQUIRE(c.runs.size() == report.sets.size());
        for (const RunFigures& run : c.runs) CHECK(run.different <= report.sets[run.set].rays / 500);
    }
}

TEST_CASE("an interrupted laboratory keeps what it has measured") {
    Queue queue = Queue::make_cpu();
    const Scene scene = scene_of({"torus", triangles_of(make_torus(20, 10), 0), {}});
    LabSettings settings = all_combinations(false, false);
    settings.width = settings.height = 16;
    Camera camera;
    camera.world_from_camera = look_at({1.5f, 0.7f, 3}, {}, {0, 1, 0});
    const LabReport report =
        run_lab(queue, scene, camera, settings, [](const LabProgress& now) { return now.share < 0.5; });
    CHECK(report.interrupted);
    const auto measured = std::ranges::count_if(report.combinations, [](const auto& c) { return !c.runs.empty(); });
    CHECK(measured > 10);
    CHECK(static_cast<std::size_t>(measured) < report.combinations.size());
}

TEST_CASE("the laboratory can be stopped inside each stage of long work and reports its progress") {
    Queue queue = Queue::make_cpu();
    const Scene scene = scene_of({"torus", triangles_of(make_torus(20, 10), 0), {}});
    LabSettings settings = all_combinations(false, false);
    settings.width = settings.height = 32;
    set_thread_count(1); // pieces are as many rays as threads want
    Camera camera;
    camera.world_from_camera = look_at({1.5f, 0.7f, 3}, {}, {0, 1, 0});
    for (const char* stage : {"making rays", "against brute force", "what the proven traversal hits", "building binned",
                              "converting binned", "binned if-if"}) {
        CAPTURE(stage);
        bool stopped = false;
        double share = 0;
        const LabReport report = run_lab(queue, scene, camera, settings, [&](const LabProgress& now) {
            CHECK_FALSE(stopped);
            stopped = now.doing.find(stage) != std::string::npos;
            share = now.share_of_that;
            // Where a stage has pieces, in its middle.
            const std::string name = stage;
            const bool in_pieces = name.starts_with("against") || name.starts_with("what") || name.ends_with("if-if");
            if (in_pieces) stopped = stopped && share > 0 && share < 1;
            return !stopped;
        });
        CHECK(stopped);
        CHECK(report.interrupted);
        CHECK_FALSE(has_findings(report));
    }
    set_thread_count(0);
}

TEST_CASE("a scene without triangles is refused with a clear message") {
    Queue queue = Queue::make_cpu();
    const LabSettings settings = all_combinations(false, false);
    CHECK_THROWS_WITH(run_lab(queue, Scene{}, Camera{}, settings, {}), "the scene has no triangles: nothing to trace");
}
