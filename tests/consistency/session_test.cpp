// A session's picture depends only on the current state: after any changes, and with any split of the samples, it has
// the bytes of a new render on the CPU. With --device cuda the session uses a GPU.

#include <array>

#include <doctest/doctest.h>

#include "base/error.h"
#include "image/picture_hash.h"
#include "session/session.h"
#include "tests/support/direction_integrator.h"
#include "tests/support/options.h"
#include "tests/support/random.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

Hash128 hash_of(const RenderResult& result) {
    Hasher hasher;
    test::add_picture(hasher, result);
    hasher.add_value(result.hidden_back_share);
    hasher.add_value(result.rays.total());
    hasher.add_value(result.invalid_samples);
    return hasher.result();
}

Camera camera_from(Vec3 eye) {
    Camera camera = test::mixed_scene_camera();
    camera.world_from_camera = look_at(eye, {0, 0.5f, 0}, {0, 1, 0});
    return camera;
}

constexpr uint32_t kAllAovs = kAovAlbedo | kAovNormal | kAovDepth | kAovPosition | kAovIds;

/// Two scenes, and the state of a session.
struct World {
    std::array<Scene, 2> scenes = {test::make_mixed_scene(), test::make_furnace_scene(0.5f)};
    std::array<PreparedScene, 2> prepared;
    std::array<Camera, 3> cameras = {test::mixed_scene_camera(), camera_from({4, 1, 1}), camera_from({-2, 3, -3})};

    World() {
        Messages messages;
        for (std::size_t i = 0; i < scenes.size(); ++i) prepared[i] = prepare_scene(scenes[i], {}, messages);
        cameras[2].aperture_radius = 0.1f;
    }
};

RenderSettings changing_settings() {
    RenderSettings settings;
    settings.width = 23, settings.height = 14, settings.samples = 3;
    settings.aovs = kAovAlbedo;
    return settings;
}

/// Changes a random setting of the picture or of the machine.
void change_a_setting(RenderSettings& settings, test::Random& random) {
    switch (random.below(9)) {
    case 0:
        settings.width = 9 + random.below(20), settings.height = 9 + random.below(20);
        break;
    case 1:
        settings.aovs = random.below(2) == 0 ? kAllAovs : random.below(8);
        break;
    case 2:
        settings.transparent = !settings.transparent;
        break;
    case 3:
        settings.filter = static_cast<PixelFilter>(random.below(4));
        break;
    case 4:
        settings.path.seed = random.below(3);
        break;
    case 5:
        settings.path.max_depth = random.below(5);
        break;
    case 6:
        settings.path.light = static_cast<PathLight>(random.below(3));
        break;
    case 7:
        settings.body = random.below(2) == 0 ? PathBody::Loop : PathBody::Wavefront;
        break;
    case 8:
        settings.batch = random.below(2) == 0 ? 100 : 1u << 20;
        break;
    }
}

} // namespace

TEST_CASE("a session after changes of scene, camera, size and settings has the bytes of a new render") {
    const World world;
    Queue queue = test::requested_queue(), cpu = Queue::make_cpu();
    std::size_t scene = 0, camera = 0;
    RenderSettings settings = changing_settings();
    Session session(queue, world.prepared[scene], world.cameras[camera], settings);
    test::Random random(12);
    const uint64_t steps = test::effort(120, 2000);
    for (uint64_t step = 0; step < steps; ++step) {
        CAPTURE(step);
        for (uint32_t changes = random.below(3); changes > 0; --changes) {
            const uint32_t what = random.below(4);
            if (what == 0) session.set_scene(world.prepared[scene = random.below(2)]);
            if (what == 1) session.set_camera(world.cameras[camera = random.below(3)]);
            if (what >= 2) change_a_setting(settings, random);
            if (what >= 2) session.set_settings(settings);
            if (random.below(4) == 0) session.render(1); // sometimes renders between two changes
            if (random.below(4) == 0) session.meter(ToneMap::Agx);
            if (random.below(4) == 0) session.stats();
        }
        session.render(1 + random.below(3)); // renders more samples if nothing has changed
        settings.samples = session.history().samples;
        const RenderResult fresh = render_picture(cpu, world.prepared[scene], world.cameras[camera], settings);
        const RenderResult lived = session.result();
        CHECK(lived.samples == settings.samples);
        CHECK(hash_of(lived) == hash_of(fresh));
    }
}

TEST_CASE("samples added later give the bytes of samples rendered at once") {
    const World world;
    Queue queue = test::requested_queue(), cpu = Queue::make_cpu();
    RenderSettings settings = changing_settings();
    settings.aovs = kAllAovs;
    settings.samples = 8;
    const Hash128 at_once = hash_of(render_picture(cpu, world.prepared[0], world.cameras[0], settings));
    for (const uint32_t first : {1u, 4u, 7u}) {
        for (const uint32_t pass : {0u, 1u, 3u}) {
            CAPTURE(first);
            CAPTURE(pass);
            settings.pass_samples = pass;
            Session session(queue, world.prepared[0], world.cameras[0], settings);
            CHECK(session.render(first) == first);
            session.result(); // displaying does not change the picture
            CHECK(session.render(8 - first) == 8 - first);
            CHECK(hash_of(session.result()) == at_once);
        }
    }
}

TEST_CASE("after a change of machine settings the film of another schedule continues") {
    const World world;
    Queue queue = test::requested_queue(), cpu = Queue::make_cpu();
    RenderSettings settings = changing_settings();
    settings.samples = 6;
    const Hash128 at_once = hash_of(render_picture(cpu, world.prepared[0], world.cameras[0], settings));
    Session session(queue, world.prepared[0], world.cameras[0], settings);
    session.render(2);
    settings.body = PathBody::Wavefront;
    session.set_settings(settings);
    session.render(2);
    settings.batch = 100;
    session.set_settings(settings);
    session.render(2);
    CHECK(hash_of(session.result()) == at_once);
}

TEST_CASE("two sessions on one queue do not affect each other") {
    const World world;
    Queue queue = test::requested_queue(), cpu = Queue::make_cpu();
    RenderSettings settings = changing_settings(), other = changing_settings();
    other.width = 31;
    other.filter = PixelFilter::Gaussian;
    Session a(queue, world.prepared[0], world.cameras[0], settings);
    Session b(queue, world.prepared[1], world.cameras[1], other);
    for (int i = 0; i < 3; ++i) {
        a.render(1);
        b.render(1);
    }
    CHECK(hash_of(a.result()) == hash_of(render_picture(cpu, world.prepared[0], world.cameras[0], settings)));
    CHECK(hash_of(b.result()) == hash_of(render_picture(cpu, world.prepared[1], world.cameras[1], other)));
}

TEST_CASE("a session that updates parts of a scene renders the changed scene and uploads only those parts") {
    const World world;
    Queue queue = test::requested_queue(), cpu = Queue::make_cpu();
    RenderSettings settings = changing_settings();
    Session session(queue, world.prepared[0], world.cameras[0], settings);
    session.render(settings.samples);
    Scene after = world.scenes[0];
    Messages messages;
    const auto check_change = [&](uint32_t parts, uint64_t max_bytes) {
        const PreparedScene prepared = prepare_scene(after, {}, messages);
        const Hash128 fresh = hash_of(render_picture(cpu, prepared, world.cameras[0], settings));
        CHECK(fresh != hash_of(session.result()));
        const uint64_t uploaded = queue.uploaded_bytes();
        session.update_scene(prepared, parts);
        CHECK(session.history().samples == 0);
        session.render(settings.samples);
        CHECK(queue.uploaded_bytes() - uploaded <= max_bytes);
        CHECK(hash_of(session.result()) == fresh);
    };
    for (Material& material : after.materials) material.base_color = 0.5f * material.base_color;
    check_change(kPartMaterials, 16'384);
    after.instances[1].world_from_local.translation.x += 0.125f; // a sphere
    check_change(kPartInstances | kPartTrees | kPartLights, 1 << 20);
    for (Light& light : after.lights) light.intensity = 2.0f * light.intensity;
    check_change(kPartLights, 1 << 18);
    CHECK(session.history().cuts == 0); // it is still one sequence
}

TEST_CASE("an integrator independent of the path tracer renders through the same interface") {
    const World world;
    Queue queue = test::requested_queue(), cpu = Queue::make_cpu();
    const Camera camera = camera_from({0, 0.5f, 5}); // along -z
    const auto render = [&](Queue& on, uint32_t in_first_call) {
        const SceneOnDevice scene(on, world.prepared[1]);
        FilterTable filter(on);
        Film film(on, 15, 9, 0);
        const std::unique_ptr<Integrator> integrator = std::make_unique<test::DirectionIntegrator>(on);
        const CameraRays rays =
            make_camera_rays(camera, filter.set(PixelFilter::Box, 0.5f), 15, 9, scene.view().centre);
        SceneTracer tracer(on, *world.prepared[1].structures, default_tracers(on.is_cuda()));
        integrator->begin({scene.view(), rays, false}, tracer, 8);
        integrator->render(0, in_first_call, film.view());
        integrator->render(in_first_call, 8 - in_first_call, film.view());
        CHECK(integrator->rays().camera == 15 * 9 * 8);
        film.set_samples({0, 8});
        return film.picture(false);
    };
    const Image picture = render(queue, 7);
    CHECK(picture_hash(picture) == picture_hash(render(queue, 3)));
    CHECK(picture_hash(picture) == picture_hash(render(cpu, 7)));
    const float* middle = picture.at(7, 4); // looks along -z
    CHECK(middle[0] == doctest::Approx(0.5).epsilon(0.02));
    CHECK(middle[1] == doctest::Approx(0.5).epsilon(0.02));
    CHECK(middle[2] < 0.01f);
    CHECK(picture.at(0, 4)[0] < 0.4f);  // left
    CHECK(picture.at(7, 0)[1] > 0.55f); // up
}

TEST_CASE("a picture interrupted repeatedly by its time limit is that of one render, for every integrator") {
    Queue queue = test::requested_queue();
    const Scene scene = test::make_mixed_scene();
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    for (const IntegratorKind integrator :
         {IntegratorKind::Path, IntegratorKind::Hybrid, IntegratorKind::Cast, IntegratorKind::Whitted,
          IntegratorKind::Distributed, IntegratorKind::Raster, IntegratorKind::Reyes, IntegratorKind::Light,
          IntegratorKind::Bidirectional}) {
        CAPTURE(static_cast<int>(integrator));
        RenderSettings settings;
        settings.width = 24, settings.height = 16;
        settings.integrator = integrator;
        Session whole(queue, prepared, test::mixed_scene_camera(), settings);
        CHECK(whole.render(3) == 3);
        settings.time_limit_s = 1e-9;
        Session broken_off(queue, prepared, test::mixed_scene_camera(), settings);
        for (int i = 0; i < 3; ++i) CHECK(broken_off.render(100) == 1);
        CHECK(picture_hash(broken_off.picture()) == picture_hash(whole.picture()));
    }
}

namespace {

void check_early_end(Queue& queue, const PreparedScene& prepared, RenderSettings settings) {
    settings.pass_samples = 2;
    Session whole(queue, prepared, test::mixed_scene_camera(), settings);
    whole.render(9);
    Session session(queue, prepared, test::mixed_scene_camera(), settings);
    int calls = 0;
    const uint32_t added = session.render(9, ProgressSink([&](const Progress& now) {
                                              ++calls;
                                              CHECK(now.samples_done == 2 * static_cast<uint32_t>(calls));
                                              CHECK(now.samples == 9);
                                              CHECK(now.rays >= uint64_t(24) * 16 * now.samples_done);
                                              return calls < 2;
                                          }));
    CHECK(calls == 2);
    CHECK(added == 4);
    CHECK(session.rays().camera == uint64_t(24) * 16 * 4);
    CHECK(session.history().samples == 4);
    Session four(queue, prepared, test::mixed_scene_camera(), settings);
    four.render(4);
    CHECK(picture_hash(session.picture()) == picture_hash(four.picture()));
    // An exception of the callback leaves whole samples, too.
    CHECK_THROWS_AS(
        session.render(4, ProgressSink([](const Progress&) -> bool { throw Error(ErrorCode::Interrupted, ""); })),
        Error);
    CHECK(session.history().samples == 6);
    session.render(3, ProgressSink([](const Progress& now) {
                       CHECK(now.samples == 9);
                       return true;
                   }));
    CHECK(picture_hash(session.picture()) == picture_hash(whole.picture()));
    CHECK(session.stats().rays.total() == whole.stats().rays.total());
}

} // namespace

TEST_CASE("a render stops at a whole sample on request and resumes from there") {
    Queue queue = test::requested_queue();
    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings;
    settings.width = 24, settings.height = 16;
    settings.body = PathBody::Wavefront;
    for (const IntegratorKind integrator :
         {IntegratorKind::Path, IntegratorKind::Hybrid, IntegratorKind::Cast, IntegratorKind::Whitted,
          IntegratorKind::Distributed, IntegratorKind::Light, IntegratorKind::Bidirectional}) {
        CAPTURE(static_cast<int>(integrator));
        settings.integrator = integrator;
        check_early_end(queue, prepared, settings);
    }
}
