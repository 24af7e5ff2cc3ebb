// Pictures by every structure, traversal, switch and ray distribution of this device, with exact tests, have one
// hash. Invalid combinations state the reason. With --device cuda those of the GPU are tested.

#include <string>

#include <doctest/doctest.h>

#include "base/error.h"
#include "session/session.h"
#include "tests/support/hang_guard.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/traversal_switches.h"
#include "tracer/traversal_kernels.h"

using namespace pertev;

namespace {

RenderSettings tracer_settings() {
    RenderSettings settings;
    settings.width = 24, settings.height = 16;
    settings.samples = 2;
    settings.path.max_depth = 5;
    settings.aovs = kAovNormal | kAovDepth | kAovIds;
    settings.transparent = true;
    return settings;
}

/// Gives each instance its own mesh, so that all are baked and the scene is one tree.
Scene make_single_tree(const Scene& scene) {
    Scene single = scene;
    single.meshes.clear();
    for (Instance& instance : single.instances) {
        single.meshes.push_back(scene.meshes[instance.mesh]);
        instance.mesh = static_cast<uint32_t>(single.meshes.size() - 1);
    }
    return single;
}

/// Makes all surfaces opaque and double sided.
Scene make_opaque(Scene scene) {
    for (Material& material : scene.materials) material.alpha_mode = AlphaMode::Opaque, material.double_sided = true;
    return scene;
}

constexpr Distribution kDistributions[] = {Distribution::OneAThread, Distribution::Persistent,
                                           Distribution::DynamicFetch};

struct Tally {
    int pictures = 0, refused = 0, wrong = 0;
};

/// Compares every tracer in one session. Unless `all_switches_everywhere`, trees of most builders are traversed only
/// with all switches on.
Tally check_all(const Scene& scene, bool all_switches_everywhere) {
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings = tracer_settings();
    Queue cpu = Queue::make_cpu();
    const Camera camera = test::mixed_scene_camera();
    const Hash128 wanted = test::render_hash(render_picture(cpu, prepared, camera, settings));
    Queue queue = test::requested_queue();
    Session session(queue, prepared, camera, settings);
    Tally tally;
    for (const StructureKind structure : kValuesOf<StructureKind>) {
        for (const TraversalKind traversal : kValuesOf<TraversalKind>) {
            for (const TraversalOptions& options : test::exact_options()) {
                for (const Distribution distribution : kDistributions) {
                    const Combination c = {structure, traversal, options, distribution};
                    if (const auto reason = why_no_tracer(c, queue.is_cuda())) {
                        tally.refused += reason->empty() ? 0 : 1;
                        continue;
                    }
                    if (!all_switches_everywhere && !test::is_first_tree(structure) && !test::is_switched_on(options))
                        continue;
                    const test::HangGuard guard(name_of(c), 20);
                    settings.tracers = same_for_all(c);
                    session.set_settings(settings);
                    session.cut();
                    session.render(settings.samples);
                    ++tally.pictures;
                    if (test::render_hash(session.result()) == wanted) continue;
                    ++tally.wrong;
                    FAIL_CHECK(name_of(c));
                }
            }
        }
    }
    return tally;
}

void check(const Scene& scene, bool all_switches_everywhere) {
    const bool all = all_switches_everywhere || test::cuda_requested() || test::effort(0, 1) != 0;
    const Tally tally = check_all(scene, all);
    CHECK(tally.wrong == 0);
    CHECK(tally.pictures > (test::cuda_requested() ? 800 : all ? 390 : 180));
    CHECK(tally.refused > 100);
}

} // namespace

TEST_CASE("every tracer gives one picture of a scene with instances, cut-outs, blended surfaces and hidden backs") {
    check(test::make_mixed_scene(), true);
}

TEST_CASE("every tracer gives one picture of a scene in one tree") {
    check(make_single_tree(test::make_mixed_scene()), false);
}

TEST_CASE("every tracer gives one picture of opaque surfaces in one tree") {
    check(make_opaque(make_single_tree(test::make_mixed_scene())), false);
}

TEST_CASE("each kind of ray can have its own tracer") {
    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings = tracer_settings();
    Queue queue = test::requested_queue();
    Session session(queue, prepared, test::mixed_scene_camera(), settings);
    session.render(settings.samples);
    const Hash128 wanted = test::render_hash(session.result());
    const Combination kd = {.structure = StructureKind::KdSah, .traversal = TraversalKind::Kd},
                      octree = {.structure = StructureKind::Octree, .traversal = TraversalKind::Octree},
                      wide = {.structure = StructureKind::SpatialSplits, .traversal = TraversalKind::Compressed};
    for (const TracerChoice& choice :
         {TracerChoice{kd, octree, wide}, TracerChoice{wide, kd, octree}, TracerChoice{octree, wide, kd}}) {
        settings.tracers = choice;
        session.set_settings(settings);
        session.cut();
        session.render(settings.samples);
        CHECK(test::render_hash(session.result()) == wanted);
    }
}

TEST_CASE("renders refuse inexact tests and traversals that the device lacks") {
    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = test::requested_queue();
    RenderSettings settings = tracer_settings();
    Session session(queue, prepared, test::mixed_scene_camera(), settings);
    session.render(1);
    const auto refuses = [&](const Combination& c) {
        settings.tracers = same_for_all(c);
        try {
            session.set_settings(settings);
        } catch (const Error& error) {
            CHECK(std::string(error.what()).find(name_of(c)) != std::string::npos);
            return error.code() == ErrorCode::BadInput;
        }
        return false;
    };
    CHECK(refuses({.traversal = TraversalKind::WhileWhile, .options = {.tests = TestKind::Fast}}));
    CHECK(refuses({.traversal = TraversalKind::WhileWhile, .options = {.tests = TestKind::Woop}}));
    CHECK(refuses({.structure = StructureKind::KdSah, .traversal = TraversalKind::WhileWhile}));
    if (queue.is_cuda()) {
        CHECK(refuses({.traversal = TraversalKind::Wide8Simd}));
    } else {
        CHECK(refuses({.traversal = TraversalKind::WhileWhile, .distribution = Distribution::DynamicFetch}));
    }
    settings.tracers.reset(); // the session continues with supported combinations
    session.set_settings(settings);
    CHECK(session.render(1) == 1);
}
