// A session keeps what a change does not affect, remakes the rest, and reports it. tests/consistency/session_test.cpp
// compares its pictures with those of new sessions.

#include <unistd.h>

#include <algorithm>
#include <fstream>

#include <doctest/doctest.h>

#include "base/error.h"
#include "base/limits.h"
#include "formats/read_scene.h"
#include "image/picture_hash.h"
#include "image/tone_map_image.h"
#include "render/update_scene.h"
#include "session/session.h"
#include "session/session_bytes.h"
#include "tests/support/meshes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/stop_after.h"

using namespace pertev;

namespace {

struct Prepared {
    Scene scene;
    PreparedScene prepared;
    explicit Prepared(Scene made) : scene(std::move(made)) {
        Messages messages;
        prepared = prepare_scene(scene, {}, messages);
    }
    Prepared(const Prepared&) = delete;
    Prepared& operator=(const Prepared&) = delete;
};

Camera camera_at(float x) {
    Camera camera = test::mixed_scene_camera();
    camera.world_from_camera = look_at({x, 2.2f, 6}, {0, 0.9f, 0}, {0, 1, 0});
    return camera;
}

RenderSettings queued_settings() {
    RenderSettings settings;
    settings.width = 24, settings.height = 16;
    settings.body = PathBody::Wavefront; // the wavefront has queues on the CPU, too
    return settings;
}

/// Returns the memory of this process.
std::size_t resident_bytes() {
    std::ifstream file("/proc/self/statm");
    std::size_t pages = 0, resident = 0;
    file >> pages >> resident;
    return resident * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

} // namespace

TEST_CASE("a new camera and most settings allocate no memory and upload nothing") {
    Queue queue = test::requested_queue();
    const Prepared mixed(test::make_mixed_scene());
    RenderSettings settings = queued_settings();
    Session session(queue, mixed.prepared, camera_at(0), settings);
    session.render(4);
    const uint64_t allocations = queue.allocation_count(), uploaded = queue.uploaded_bytes();
    for (int i = 1; i < 20; ++i) {
        session.set_camera(camera_at(0.1f * static_cast<float>(i)));
        session.render(4);
    }
    settings.path.max_depth = 3;
    settings.path.seed = 9;
    settings.path.light = PathLight::Indirect;
    session.set_settings(settings);
    session.render(3);
    settings.time_limit_s = 100;
    settings.transparent = true;
    settings.filter_radius = 2;
    session.set_settings(settings);
    session.render(3);
    CHECK(queue.allocation_count() == allocations);
    CHECK(queue.uploaded_bytes() == uploaded);
    settings.filter = PixelFilter::Gaussian; // this filter has its own table, for which memory is reserved
    session.set_settings(settings);
    session.render(1);
    CHECK(queue.allocation_count() == allocations);
    CHECK(queue.uploaded_bytes() == uploaded + (kFilterTableSize + 1) * sizeof(float));
}

TEST_CASE("a smaller picture allocates only a new film, and a larger one larger queues as well") {
    Queue queue = test::requested_queue();
    const Prepared furnace(test::make_furnace_scene(0.5f));
    RenderSettings settings = queued_settings();
    Session session(queue, furnace.prepared, camera_at(0), settings);
    session.render(1);
    const std::size_t bytes = queue.allocated_bytes();
    const uint64_t uploaded = queue.uploaded_bytes();
    uint64_t allocations = queue.allocation_count();
    settings.width = 12;
    session.set_settings(settings);
    session.render(1);
    CHECK(queue.allocated_bytes() == bytes - Film::predicted_bytes(24, 16, 0) + Film::predicted_bytes(12, 16, 0));
    CHECK(queue.allocation_count() - allocations <= 3); // the film's buffers
    allocations = queue.allocation_count();
    settings.width = 48;
    session.set_settings(settings);
    session.render(1);
    CHECK(queue.allocated_bytes() > bytes - Film::predicted_bytes(24, 16, 0) + Film::predicted_bytes(48, 16, 0));
    CHECK(queue.allocation_count() - allocations > 3);
    CHECK(queue.uploaded_bytes() == uploaded);
}

TEST_CASE("memory does not grow over 1000 changes of camera, size, settings and scene") {
    Queue queue = test::requested_queue();
    const Prepared a(test::make_furnace_scene(0.5f)), b(test::make_mixed_scene());
    RenderSettings settings = queued_settings();
    Session session(queue, a.prepared, camera_at(0), settings);
    std::size_t bytes_metered = 0, bytes_unmetered = 0; // a meter's buffers stay until the next change
    [[maybe_unused]] std::size_t resident = 0;
    constexpr int kCycles = 100, kWarm = 20; // cycles of 10 changes each
    for (int cycle = 0; cycle < kCycles; ++cycle) {
        for (const float x : {0.5f, -0.5f}) {
            session.set_camera(camera_at(x));
            session.render(1);
            settings.width = x > 0 ? 40 : 24;
            settings.aovs = x > 0 ? uint32_t(kAovNormal | kAovIds) : 0u;
            session.set_settings(settings);
            session.render(1);
            settings.path.seed += 1;
            session.set_settings(settings);
            session.render(1);
            session.set_scene(x > 0 ? b.prepared : a.prepared);
            session.render(1);
            settings.batch = x > 0 ? 1000 : 5000; // uses other queues
            session.set_settings(settings);
            session.render(1);
        }
        const bool meters = cycle % 5 == 0; // this takes longer than all changes of a cycle
        if (meters) session.meter(ToneMap::Agx);
        session.result();
        std::size_t& bytes = meters ? bytes_metered : bytes_unmetered;
        if (cycle < 2) bytes = queue.allocated_bytes();
        CHECK(queue.allocated_bytes() == bytes);
        if (cycle == kWarm) resident = resident_bytes();
    }
#if !defined(__SANITIZE_ADDRESS__) // this allocator keeps freed memory
    CHECK(resident > 0);
    CHECK(resident_bytes() < resident + (4u << 20)); // a film per change would take ten times that
#endif
}

TEST_CASE("1000 frames with moving instances of a large mesh and an emitter upload little and allocate no memory") {
    Queue queue = test::requested_queue();
    Messages messages;
    std::vector<Scene> scenes(1, test::make_mixed_scene());
    const test::TriangleMesh sphere = test::make_sphere(5, {0, 0, 0}, 1.0f); // 20480 triangles; instances 1 to 3
    Mesh& large = scenes[0].meshes[0];
    large.positions = large.normals = sphere.positions;
    large.indices = sphere.indices;
    scenes[0].environment->image = {512, 256, 3, std::vector<float>(std::size_t(512) * 256 * 3, 0.5f)};
    scenes[0].environment->image.pixels[1000] = 40;
    constexpr int kPlaces = 8, kFrames = 1000; // a cycle of positions; each scene is made from the previous one
    const SceneUpdate update = {.moved_instances = {1, 5}}; // instance 5 is the emitter
    scenes.reserve(kPlaces);
    std::vector<PreparedScene> prepared = {prepare_scene(scenes[0], prepare_options({}, queue.is_cuda()), messages)};
    while (scenes.size() < kPlaces) {
        Scene& scene = scenes.emplace_back(scenes.back());
        for (const uint32_t i : update.moved_instances) scene.instances[i].world_from_local.translation.x += 0.1f;
        prepared.push_back(update_scene(prepared.back(), scene, update, messages));
        CHECK(prepared.back().lights.environment == prepared[0].lights.environment);
    }
    RenderSettings settings = queued_settings();
    settings.width = 12, settings.height = 8;
    std::vector<Hash128> fresh; // renders newly prepared scenes on the CPU
    for (const Scene& scene : scenes) {
        Queue cpu = Queue::make_cpu();
        const PreparedScene afresh = prepare_scene(scene, {.centre = prepared[0].centre}, messages);
        Session session(cpu, afresh, camera_at(0), settings);
        session.render(1);
        fresh.push_back(picture_hash(session.picture()));
    }
    CHECK(fresh[0] != fresh[1]);

    Session session(queue, prepared[0], camera_at(0), settings);
    session.render(1);
    const uint64_t allocations = queue.allocation_count();
    for (int frame = 1; frame <= kFrames; ++frame) {
        const std::size_t place = frame % kPlaces;
        const uint64_t uploaded = queue.uploaded_bytes();
        session.update_scene(prepared[place], parts_of(update));
        session.render(1);
        CHECK(queue.uploaded_bytes() - uploaded < 65536);
        CHECK(picture_hash(session.picture()) == fresh[place]);
    }
    CHECK(queue.allocation_count() == allocations);
}

TEST_CASE("a session without a tracer refuses and never accesses one") {
    Queue queue = test::requested_queue();
    Scene scene = test::make_mixed_scene();
    const test::TriangleMesh sphere =
        test::make_sphere(7, {0, 0, 0}, 1.0f); // the scene has too many triangles for brute force
    scene.meshes[0].positions = scene.meshes[0].normals = sphere.positions;
    scene.meshes[0].indices = sphere.indices;
    const Prepared many(std::move(scene));
    REQUIRE(many.prepared.triangles > kMaxBruteForceTriangles);
    RenderSettings settings = queued_settings();
    Session session(queue, many.prepared, camera_at(0), settings);
    settings.tracers = same_for_all({.structure = StructureKind::Binned, .traversal = TraversalKind::BruteForce});
    CHECK_THROWS_AS(session.set_settings(settings), Error);
    CHECK_THROWS_AS(session.render(1), std::logic_error);
    CHECK_THROWS_AS(session.stats(), std::logic_error);
    settings.tracers.reset();
    session.set_settings(settings);
    CHECK(session.render(1) == 1);
}

TEST_CASE("a session leaves nothing on the device when it ends") {
    Queue queue = test::requested_queue();
    const Prepared furnace(test::make_furnace_scene(0.5f));
    {
        Session session(queue, furnace.prepared, camera_at(0), queued_settings());
        session.render(1);
        session.meter(ToneMap::Agx);
    }
    CHECK(queue.allocated_bytes() == 0);
}

TEST_CASE("memory of a session equals its prediction") {
    Queue queue = test::requested_queue();
    const Prepared furnace(test::make_furnace_scene(0.5f));
    RenderSettings settings = queued_settings();
    settings.samples = 3;
    settings.aovs = kAovAlbedo | kAovIds;
    Session session(queue, furnace.prepared, camera_at(0), settings);
    session.render(settings.samples);
    const std::size_t predicted = predicted_bytes(furnace.prepared, settings, queue.is_cuda());
    CHECK(queue.allocated_bytes() >= predicted);
    CHECK(queue.allocated_bytes() <= predicted + 4096); // a pixel filter's table, the scene's view
}

TEST_CASE("a time limit ends a call at a whole sample and applies to each call") {
    Queue queue = test::requested_queue();
    const Prepared mixed(test::make_mixed_scene());
    RenderSettings settings = queued_settings();
    settings.time_limit_s = 1e-9;
    Session session(queue, mixed.prepared, camera_at(0), settings);
    CHECK(session.render(100) == 1);
    CHECK(session.render(100) == 1);
    CHECK(session.history().samples == 2);
}

TEST_CASE("only changes of the picture restart the film") {
    Queue queue = test::requested_queue();
    const Prepared furnace(test::make_furnace_scene(0.5f));
    RenderSettings settings = queued_settings();
    Session session(queue, furnace.prepared, camera_at(0), settings);
    session.render(2);
    settings.samples = 1000;
    settings.time_limit_s = 50;
    settings.pass_samples = 1;
    settings.batch = 77;
    settings.filter_radius = default_filter_radius(settings.filter); // is set explicitly to its default
    session.set_settings(settings);
    session.set_camera(camera_at(0));
    CHECK(session.history().samples == 2);
    CHECK(session.history().cuts == 0);

    const auto restarts = [&](const auto& change) {
        session.render(1);
        change(settings);
        session.set_settings(settings);
        CHECK(session.history().samples == 0);
        for (const float value : session.picture().pixels) CHECK(value == 0); // the film has no samples
    };
    restarts([](RenderSettings& s) { s.width = 25; });
    restarts([](RenderSettings& s) { s.height = 5; });
    restarts([](RenderSettings& s) { s.filter = PixelFilter::Box; });
    restarts([](RenderSettings& s) { s.filter_radius = 3; });
    restarts([](RenderSettings& s) { s.aovs = kAovDepth; });
    restarts([](RenderSettings& s) { s.transparent = true; });
    restarts([](RenderSettings& s) { s.path.max_depth = 2; });
    restarts([](RenderSettings& s) { s.path.seed = 2; });
    restarts([](RenderSettings& s) { s.path.sampler = SamplerKind::Independent; });
    restarts([](RenderSettings& s) { s.path.clamp = 1; });
    restarts([](RenderSettings& s) { s.path.roulette_depth = 1; });
    CHECK(session.history().cuts == 11);
}

TEST_CASE("the history keeps the camera of the last samples until a cut") {
    Queue queue = test::requested_queue();
    const Prepared furnace(test::make_furnace_scene(0.5f));
    Session session(queue, furnace.prepared, camera_at(0), queued_settings());
    CHECK(!session.history().previous_camera);
    session.set_camera(camera_at(1)); // no sample used the previous camera
    CHECK(!session.history().previous_camera);
    session.render(1);
    session.set_camera(camera_at(2));
    CHECK(session.history().previous_camera == camera_at(1));
    session.set_camera(camera_at(3)); // camera 2 has no samples
    CHECK(session.history().previous_camera == camera_at(1));
    session.render(1);
    session.render(1);
    CHECK(session.history().previous_camera == camera_at(1));
    CHECK(session.history().samples == 2);
    CHECK(session.history().cuts == 0);
    session.set_scene(furnace.prepared);
    CHECK(!session.history().previous_camera);
    CHECK(session.history().samples == 0);
    CHECK(session.history().cuts == 1);
    session.render(1);
    session.set_camera(camera_at(4));
    session.cut();
    CHECK(!session.history().previous_camera);
    CHECK(session.history().cuts == 2);
}

TEST_CASE("a display has the picture's tones") {
    Queue queue = test::requested_queue();
    const Prepared mixed(test::make_mixed_scene());
    RenderSettings settings = queued_settings();
    for (const bool transparent : {false, true}) {
        settings.transparent = transparent;
        Session session(queue, mixed.prepared, camera_at(0), settings);
        session.render(2);
        for (const ToneMap tone_map : {ToneMap::Srgb, ToneMap::Agx, ToneMap::Aces, ToneMap::Neutral}) {
            session.display(tone_map, -0.7f);
            CHECK(session.displayed().width == 24);
            CHECK(session.displayed().pixels == tone_map_image(session.picture(), tone_map, -0.7f).pixels);
        }
    }
}

TEST_CASE("the meter uses the scene on the device, uploads nothing and does not change the film") {
    Queue queue = test::requested_queue();
    const Prepared mixed(test::make_mixed_scene());
    RenderSettings settings = queued_settings();
    Session session(queue, mixed.prepared, camera_at(0), settings);
    session.render(3);
    const Hash128 before = picture_hash(session.picture());
    const uint64_t uploaded = queue.uploaded_bytes();
    const float stops = session.meter(ToneMap::Agx);
    CHECK(queue.uploaded_bytes() == uploaded);
    CHECK(picture_hash(session.picture()) == before);
    CHECK(session.history().samples == 3);
    CHECK(session.stats().rays.camera == uint64_t(24) * 16 * 3);
    const uint64_t uploaded_for_stats = queue.uploaded_bytes(); // the test for hidden backs
    const uint64_t allocations = queue.allocation_count();
    CHECK(session.meter(ToneMap::Agx) == stops);
    CHECK(queue.allocation_count() == allocations); // its film and queues stay
    session.render(2);
    CHECK(queue.uploaded_bytes() == uploaded_for_stats);
    Session whole(queue, mixed.prepared, camera_at(0), settings);
    CHECK(whole.meter(ToneMap::Agx) == stops); // before any sample
    whole.render(5);
    CHECK(picture_hash(session.picture()) == picture_hash(whole.picture()));
}

TEST_CASE("the meter gives the exposure of separate renders") {
    Queue queue = test::requested_queue();
    Messages messages;
    const Prepared box(read_scene("cornell-box", {}, messages));
    RenderSettings settings;
    settings.width = 160, settings.height = 120;
    Session session(queue, box.prepared, box.scene.cameras.front(), settings);
    CHECK(session.meter(ToneMap::Agx) == 1.68f);
    settings.width = 161, settings.height = 90;
    settings.transparent = true;
    settings.path.light = PathLight::Indirect;
    settings.path.clamp = 3;
    settings.path.max_depth = 4;
    session.set_settings(settings);
    CHECK(session.meter(ToneMap::Aces) == 3.0f);
}

TEST_CASE("seconds of each kind of ray are those of the last render, not of later metering") {
    Queue queue = test::requested_queue();
    const Prepared mixed(test::make_mixed_scene());
    RenderSettings settings = queued_settings();
    settings.time_kinds = true;
    Session session(queue, mixed.prepared, camera_at(0), settings);
    session.meter(ToneMap::Agx);
    CHECK(session.stats().kind_seconds.camera == 0);
    session.render(2);
    const SceneTracer::Seconds seconds = session.stats().kind_seconds;
    CHECK(seconds.camera > 0);
    CHECK(seconds.bounce > 0);
    CHECK(seconds.shadow > 0);
    session.meter(ToneMap::Agx);
    CHECK(session.stats().kind_seconds.camera == seconds.camera);
    CHECK(session.stats().kind_seconds.bounce == seconds.bounce);
}

TEST_CASE("the share of hidden backs follows scene, camera and size") {
    Queue queue = test::requested_queue();
    const Prepared mixed(test::make_mixed_scene()), furnace(test::make_furnace_scene(0.5f));
    RenderSettings settings = queued_settings();
    const auto fresh = [&](const Prepared& scene, const Camera& camera) {
        return Session(queue, scene.prepared, camera, settings).stats().hidden_back_share;
    };
    Session session(queue, mixed.prepared, camera_at(0.3f), settings);
    const double share = session.stats().hidden_back_share;
    CHECK(share > 0.001);
    const uint64_t allocations = queue.allocation_count();
    session.render(1);
    const uint64_t after_render = queue.allocation_count();
    CHECK(after_render > allocations);
    CHECK(session.stats().hidden_back_share == share);
    CHECK(queue.allocation_count() == after_render); // it is not counted again
    session.set_camera(camera_at(-3));
    CHECK(session.stats().hidden_back_share == fresh(mixed, camera_at(-3)));
    CHECK(session.stats().hidden_back_share != share);
    settings.width = 60;
    const double narrow = session.stats().hidden_back_share;
    session.set_settings(settings);
    CHECK(session.stats().hidden_back_share == fresh(mixed, camera_at(-3)));
    CHECK(session.stats().hidden_back_share != narrow);
    session.set_scene(furnace.prepared);
    CHECK(session.stats().hidden_back_share == fresh(furnace, camera_at(-3)));
}

TEST_CASE("a separately rendered picture equals a new session's and does not change the film") {
    Queue queue = test::requested_queue();
    const Prepared mixed(test::make_mixed_scene());
    RenderSettings aside = queued_settings();
    aside.width = 5, aside.height = 4, aside.samples = 2, aside.aovs = kAovDepth | kAovIds, aside.path.max_depth = 0;
    Session fresh(queue, mixed.prepared, camera_at(1), aside);
    fresh.render(2);
    Session session(queue, mixed.prepared, camera_at(0), queued_settings());
    session.render(3);
    const auto hash = picture_hash(session.picture());
    const RenderResult seen = session.render_separately(camera_at(1), aside);
    CHECK(picture_hash(seen.picture) == picture_hash(fresh.picture()));
    CHECK(seen.ids.size() == 20);
    CHECK(seen.layers.size() == 1);
    CHECK(session.history().samples == 3);
    CHECK(picture_hash(session.picture()) == hash);
    session.render(2); // samples continue as if nothing had happened
    Session whole(queue, mixed.prepared, camera_at(0), queued_settings());
    whole.render(5);
    CHECK(picture_hash(session.picture()) == picture_hash(whole.picture()));
}

TEST_CASE("camera rays' nodes and triangles are counted for each pixel") {
    Queue queue = test::requested_queue();
    const Prepared mixed(test::make_mixed_scene());
    Session session(queue, mixed.prepared, camera_at(0), queued_settings());
    const std::vector<RayWork> work = session.count_camera_work();
    REQUIRE(work.size() == 24 * 16);
    CHECK(std::ranges::any_of(work, [](const RayWork& ray) { return ray.nodes > 0 && ray.triangles > 0; }));
}

TEST_CASE("a render that a sink stops adds nothing unfinished, and the next picture equals a fresh session's") {
    Queue queue = Queue::make_cpu(); // samples on a GPU are not interrupted
    const Prepared mixed(test::make_mixed_scene());
    RenderSettings settings = queued_settings();
    settings.body = PathBody::Loop;
    Session session(queue, mixed.prepared, camera_at(0), settings);
    CHECK(session.render(3, test::StopAfter(1)) == 0); // during the first pass
    CHECK(session.history().samples == 0);
    CHECK(session.render(1) == 1);
    settings.pass_samples = 1;
    session.set_settings(settings);
    CHECK(session.render(3, test::StopAfter(0)) == 1); // once a sample is complete, a pass is finished
    session.interrupt_passes(true);
    CHECK(session.render(3, test::StopAfter(1)) == 0);
    CHECK(session.history().samples == 2);
    Session fresh(queue, mixed.prepared, camera_at(0), settings);
    fresh.render(2);
    CHECK(picture_hash(session.picture()) == picture_hash(fresh.picture()));
    session.cut();
    struct InSecondPass final : Sink {
        void progress(const Progress&) override { is_second = true; }
        bool should_stop() override { return is_second && ++asked > 1; } // at the first check the pass has not begun
        std::atomic<bool> is_second = false;
        std::atomic<int> asked = 0;
    };
    CHECK(session.render(9, InSecondPass()) == 0); // samples of this call are not kept
    settings.denoise = Denoise::Svgf;
    session.set_settings(settings);
    CHECK(session.render(2, test::StopAfter(3)) == 0); // while the denoiser gets the surfaces
    CHECK(session.history().samples == 0);
}
