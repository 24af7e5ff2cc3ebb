// Motion vectors of pixels for moving cameras, instances and skies. Still pictures have no motion.

#include "denoise/motion_vectors.h"

#include <cmath>

#include <doctest/doctest.h>

#include "render/update_scene.h"
#include "session/session.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

RenderSettings motion_settings() {
    RenderSettings settings;
    settings.width = 64, settings.height = 48;
    settings.samples = 1;
    settings.path.max_depth = 0;
    settings.aovs = kAovMotion;
    return settings;
}

/// A ball of radius 1 about the origin, 5 m away.
Camera camera_of_ball() {
    Camera camera;
    camera.world_from_camera = make_translation({0, 0, 5});
    return camera;
}

Vec2 at(const Image& motion, uint32_t x, uint32_t y) {
    const float* pixel = &motion.pixels[2 * (std::size_t(y) * motion.width + x)];
    return {pixel[0], pixel[1]};
}

/// The number of pixels per metre at a distance of 4 m.
float pixels_a_metre(const CameraView& view) { return 0.5f * 64 / (4 * view.half_width); }

} // namespace

TEST_CASE("an object that moves right and up has that motion in pixels") {
    Messages messages;
    Queue queue = test::requested_queue();
    const Camera camera = camera_of_ball();
    const RenderSettings settings = motion_settings();
    Scene scene = test::make_furnace_scene(0.5f);
    scene.instances.push_back(scene.instances[0]); // another instance, so that the mesh has its own BLAS
    scene.instances[1].world_from_local = make_translation({0, 0, -40});
    PreparedScene prepared = prepare_scene(scene, {}, messages);
    Session session(queue, prepared, camera, settings);
    session.store_previous();
    scene.instances[0].world_from_local = make_translation({0.1f, 0.05f, 0});
    SceneUpdate update;
    update.moved_instances = {0};
    prepared = update_scene(prepared, scene, update, messages);
    session.update_scene(prepared, parts_of(update));
    session.render(1);
    const RenderResult result = session.result();
    REQUIRE(result.layers.size() == 1);
    CHECK(result.layers[0].name == "motion");
    CHECK(result.layers[0].channels == std::vector<std::string>{"u", "v"});
    const Image& motion = result.layers[0].image;
    const float scale = pixels_a_metre(make_camera_view(camera, 64, 48));
    const Vec2 ball = at(motion, 32, 24), sky = at(motion, 1, 1);
    CHECK(ball.x == doctest::Approx(0.1f * scale).epsilon(0.02));
    CHECK(ball.y == doctest::Approx(0.05f * scale).epsilon(0.02));
    CHECK(length(Vec3{sky.x, sky.y, 0}) < 1e-3f);
}

TEST_CASE("a camera moving right moves near objects to the left, and a turning one the sky as well") {
    Messages messages;
    Queue queue = test::requested_queue();
    const Scene scene = test::make_furnace_scene(0.5f);
    const Camera camera = camera_of_ball();
    const RenderSettings settings = motion_settings();
    Session session(queue, prepare_scene(scene, {}, messages), camera, settings);
    session.store_previous();
    Camera aside = camera;
    aside.world_from_camera.translation.x += 0.1f;
    session.set_camera(aside);
    const CameraView view = make_camera_view(camera, 64, 48);
    Image motion = session.motion();
    CHECK(at(motion, 32, 24).x == doctest::Approx(-0.1f * pixels_a_metre(view)).epsilon(0.02));
    CHECK(std::abs(at(motion, 1, 1).x) < 1e-3f); // the sky is infinitely far away

    Camera turned = camera; // by a hundredth to the left
    turned.world_from_camera.row0 = {1, 0, 0.01f};
    turned.world_from_camera.row2 = {-0.01f, 0, 1};
    session.set_camera(turned);
    motion = session.motion();
    const float expected = 0.01f * 0.5f * 64 / view.half_width;
    CHECK(at(motion, 32, 2).x == doctest::Approx(expected).epsilon(0.05)); // sky
    CHECK(at(motion, 32, 24).x == doctest::Approx(expected).epsilon(0.05));
    CHECK(std::abs(at(motion, 32, 24).y) < 1e-2f);
}

TEST_CASE("there is no motion without a previous frame, and none of surfaces that were behind the camera or hidden") {
    Messages messages;
    Queue queue = test::requested_queue();
    Scene scene = test::make_furnace_scene(0.5f);
    const Camera camera = camera_of_ball();
    const auto largest = [](const Image& motion) {
        float most = 0;
        for (const float value : motion.pixels) most = max(most, std::abs(value));
        return most;
    };
    PreparedScene prepared = prepare_scene(scene, {}, messages);
    Session session(queue, prepared, camera, motion_settings());
    CHECK(largest(session.motion()) == 0);
    Camera away = camera;
    away.world_from_camera.row0.x = away.world_from_camera.row2.z = -1;
    session.set_camera(away);
    session.store_previous();
    session.set_camera(camera);
    CHECK(largest(session.motion()) == 0);
    session.cut();
    session.store_previous();
    CHECK(largest(session.motion()) < 1e-4f); // equal up to rounding

    scene.instances.push_back(scene.instances[0]);
    scene.instances[1].world_from_local = make_translation({0, 0, -40});
    scene.instances[0].is_hidden = true;
    prepared = prepare_scene(scene, {}, messages);
    session.set_scene(prepared);
    session.store_previous();
    scene.instances[0].is_hidden = false;
    scene.instances[0].world_from_local = make_translation({0.5f, 0, 0});
    SceneUpdate update;
    update.moved_instances = {0};
    prepared = update_scene(prepared, scene, update, messages);
    session.update_scene(prepared, parts_of(update));
    CHECK(largest(session.motion()) < 1e-4f);
}

TEST_CASE("memory of motion vectors equals its prediction, and their bytes are the same on every device") {
    Messages messages;
    Queue cpu = Queue::make_cpu();
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    const auto motion_on = [&](Queue& queue, PathBody body) {
        Messages notes;
        RenderSettings settings = motion_settings();
        settings.body = body;
        const PreparedScene own = prepare_scene(scene, {}, notes);
        Session session(queue, own, test::mixed_scene_camera(), settings);
        session.store_previous();
        Camera moved = test::mixed_scene_camera();
        moved.world_from_camera.translation.y += 0.2f;
        session.set_camera(moved);
        return session.motion().pixels;
    };
    const std::vector<float> expected = motion_on(cpu, PathBody::Loop);
    CHECK(motion_on(cpu, PathBody::Wavefront) == expected);
    Queue dry = Queue::make_dry_run(false);
    const MotionVectorMemory memory(dry, 64, 48);
    CHECK(dry.allocated_bytes() == 64 * 48 * 64);
    if (!test::cuda_requested()) return;
    Queue cuda = test::make_cuda_queue();
    CHECK(motion_on(cuda, PathBody::Wavefront) == expected);
}

TEST_CASE("motion of a real-time frame is that since the frame before, at any resolution of light, and 0 after a cut") {
    Messages messages;
    Queue queue = test::requested_queue();
    const Camera camera = camera_of_ball();
    const RenderSettings settings = motion_settings();
    Scene scene = test::make_furnace_scene(0.5f);
    scene.instances.push_back(scene.instances[0]); // another instance, so that the mesh has its own BLAS
    scene.instances[1].world_from_local = make_translation({0, 0, -40});
    PreparedScene prepared = prepare_scene(scene, {}, messages);
    const float scale = pixels_a_metre(make_camera_view(camera, 64, 48));
    for (const float resolution : {1.0f, 0.5f}) {
        CAPTURE(resolution);
        const ReconstructionSettings reconstruction = {.resolution_scale = resolution};
        Session session(queue, prepared, camera, settings);
        float x = 0;
        const auto move_by = [&](float metres) {
            x += metres;
            scene.instances[0].world_from_local = make_translation({x, 0, 0});
            SceneUpdate update;
            update.moved_instances = {0};
            prepared = update_scene(prepared, scene, update, messages);
            session.update_scene(prepared, parts_of(update));
        };
        uint32_t number = 0;
        const auto ball = [&] {
            REQUIRE(session.render_frame(number++, reconstruction));
            const RenderResult result = session.frame_result();
            REQUIRE(result.layers.size() == 1);
            CHECK(result.layers[0].name == "motion");
            const Image& motion = result.layers[0].image;
            REQUIRE((motion.width == 64 && motion.height == 48 && motion.channels == 2));
            return at(motion, 32, 24).x;
        };
        CHECK(ball() == 0);
        move_by(0.1f);
        CHECK(ball() == doctest::Approx(0.1f * scale).epsilon(0.02));
        CHECK(std::abs(ball()) < 1e-3f); // it rests
        move_by(0.05f);
        move_by(0.05f); // two steps between frames
        CHECK(ball() == doctest::Approx(0.1f * scale).epsilon(0.05));
        Camera aside = camera;
        aside.world_from_camera.translation.x += 0.1f;
        session.set_camera(aside);
        CHECK(ball() == doctest::Approx(-0.1f * scale).epsilon(0.05));
        session.cut();
        CHECK(ball() == 0);
        session.set_camera(camera);
        session.cut();
        move_by(-0.2f);
        CHECK(ball() == 0);
        move_by(0.1f);
        CHECK(ball() == doctest::Approx(0.1f * scale).epsilon(0.05));
        move_by(-0.1f);
    }
}
