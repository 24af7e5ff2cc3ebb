// Every combination of structure, traversal and switches finds the hits of the reference traversal, bit for bit, and
// the reference traversal those of brute force, in stress meshes with and without instances. Public scenes are in
// lab_scenes_test.cpp.

#include <doctest/doctest.h>

#include <algorithm>
#include <map>

#include "base/parallel_for.h"
#include "lab/record_scenes.h"
#include "lab/run_lab.h"
#include "tests/support/lab_combinations.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/stress_meshes.h"
#include "tests/support/thrown_error.h"

using namespace pertev;
using namespace pertev::test;

namespace {

/// The mesh's triangles as one instance.
Scene scene_with(const StressMesh& stress) {
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
        const Scene scene = scene_with(stress);
        LabSettings settings = all_combinations(queue.is_cuda(), true);
        settings.width = settings.height = side;
        settings.depth = 3;
        Camera camera;
        camera.world_from_camera =
            look_at(stress.centre + stress.extent * Vec3{1.5f, 0.7f, 3}, stress.centre, {0, 1, 0});
        check_report(run_lab(queue, scene, camera, settings));
    }
}

} // namespace

TEST_CASE("every combination gives the same hits in the mixed scene with instances") {
    Queue queue = Queue::make_cpu();
    const Scene scene = make_mixed_scene();
    LabSettings settings = all_combinations(false, true);
    settings.width = 64, settings.height = 48, settings.depth = 3;
    check_report(run_lab(queue, scene, mixed_scene_camera(), settings));
}

TEST_CASE("every combination gives the same hits in stress meshes") {
    Queue queue = Queue::make_cpu();
    check_stress_meshes(queue, static_cast<uint32_t>(effort(12, 48)));
}

TEST_CASE("CUDA: every combination gives the same hits in stress meshes and in the mixed scene") {
    if (!cuda_requested()) return;
    Queue queue = make_cuda_queue();
    check_stress_meshes(queue, static_cast<uint32_t>(effort(64, 256)));
    const Scene mixed = make_mixed_scene(); // has instances
    LabSettings settings = all_combinations(true, true);
    settings.width = 64, settings.height = 48, settings.depth = 3;
    settings.runs = 1; // rays are timed and counted, too
    check_report(run_lab(queue, mixed, mixed_scene_camera(), settings));
}

TEST_CASE("inexact tests miss a few rays, which are counted") {
    Queue queue = requested_queue();
    const Vec3 centre = {1.5e5f, 0, -1.5e5f}; // 150 km away, where floats are centimetres apart
    const Scene scene = scene_with({"soup", make_soup(1500, 1.5e5f), centre});
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
    const LabReport report = run_lab(queue, scene, camera, settings);
    std::map<TestKind, uint64_t> bytes;
    for (const CombinationFigures& c : report.combinations) {
        CAPTURE(c.name);
        CAPTURE(c.refused);
        REQUIRE(c.runs.size() == 3);
        CHECK((c.runs[0].different == 0) == c.combination.options.is_exact());
        CHECK(c.runs[0].different < report.sets[0].rays / 2);
        if (c.combination.distribution == Distribution::OneAThread) { // other differences are not counted
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
    const LabReport report = run_lab(queue, make_mixed_scene(), mixed_scene_camera(), settings);
    CHECK(report.instances > 1);
    for (const CombinationFigures& c : report.combinations) {
        CAPTURE(c.name);
        CAPTURE(c.refused);
        REQUIRE(c.runs.size() == report.sets.size());
        for (const RunFigures& run : c.runs) CHECK(run.different <= report.sets[run.set].rays / 500);
    }
}

TEST_CASE("an interrupted laboratory keeps its measurements") {
    Queue queue = Queue::make_cpu();
    const Scene scene = scene_with({"torus", triangles_of(make_torus(20, 10), 0), {}});
    LabSettings settings = all_combinations(false, false);
    settings.width = settings.height = 16;
    Camera camera;
    camera.world_from_camera = look_at({1.5f, 0.7f, 3}, {}, {0, 1, 0});
    ProgressSink first_half([](const Progress& now) { return now.share < 0.5; });
    const LabReport report = run_lab(queue, scene, camera, settings, first_half);
    CHECK(report.interrupted);
    const auto measured = std::ranges::count_if(report.combinations, [](const auto& c) { return !c.runs.empty(); });
    CHECK(measured > 10);
    CHECK(static_cast<std::size_t>(measured) < report.combinations.size());
}

TEST_CASE("the laboratory can be stopped inside each stage of long work and reports its progress") {
    const UseThreads one(1); // the number of rays per piece depends on the threads
    Queue queue = Queue::make_cpu();
    const Scene scene = scene_with({"torus", triangles_of(make_torus(20, 10), 0), {}});
    LabSettings settings = all_combinations(false, false);
    settings.structures = {StructureKind::Binned}, settings.traversals = {TraversalKind::IfIf};
    settings.options.resize(1);
    settings.shadow = settings.diffuse = false;
    settings.width = settings.height = 32;
    Camera camera;
    camera.world_from_camera = look_at({1.5f, 0.7f, 3}, {}, {0, 1, 0});
    struct Stage {
        std::string name;
        bool has_pieces = false;
    };
    std::vector<Stage> stages;
    const auto is_inside = [](const Progress& now) { return now.share_of_step > 0 && now.share_of_step < 1; };
    ProgressSink recorder([&](const Progress& now) {
        if (stages.empty() || stages.back().name != now.doing) stages.push_back({now.doing});
        stages.back().has_pieces |= is_inside(now);
        return true;
    });
    CHECK(has_findings(run_lab(queue, scene, camera, settings, recorder)));
    REQUIRE(stages.size() == 8); // the tree, the rays, two for the set, three for the combination, and the end
    stages.pop_back();
    CHECK(std::ranges::count(stages, true, &Stage::has_pieces) == 3);
    for (const Stage& stage : stages) {
        CAPTURE(stage.name);
        bool stopped = false;
        ProgressSink sink([&](const Progress& now) {
            CHECK_FALSE(stopped);
            stopped = now.doing == stage.name && (!stage.has_pieces || is_inside(now));
            return !stopped;
        });
        const LabReport report = run_lab(queue, scene, camera, settings, sink);
        CHECK(stopped);
        CHECK(report.interrupted);
        CHECK_FALSE(has_findings(report));
    }
}

TEST_CASE("a scene without triangles is refused with a clear message") {
    Queue queue = Queue::make_cpu();
    const LabSettings settings = all_combinations(false, false);
    const auto error = test::thrown_error([&] { run_lab(queue, Scene{}, Camera{}, settings); });
    CHECK(test::is_about(error, ErrorCode::BadInput, "scene"));
}
