// Time in the viewer: its clock (scene_clock.h), and the camera's motion (view_camera.h).

#include <doctest/doctest.h>

#include "apps/viewer/scene_clock.h"
#include "apps/viewer/view_camera.h"
#include "scene/scene_origin.h"
#include "session/opening/choose_camera.h"
#include "tests/support/random.h"

using namespace pertev;

namespace {

ClientMessage step_forward() { return {.kind = MessageKind::Move, .forward = 1, .seconds = 0.1f}; }

/// A scene with one camera that an animation may move. The test sets its position at a time.
Scene scene_with_camera() {
    Scene scene;
    Camera camera;
    camera.world_from_camera = look_at({0, 1, 5}, {0, 1, 0}, {0, 1, 0});
    scene.cameras.push_back(camera);
    scene.animations.emplace_back();
    return scene;
}

StartCamera start_at(const Scene& scene) {
    StartCamera start;
    start.camera = scene.cameras[0];
    start.pose = pose_of(start.camera, {}, {}, 5);
    start.name = "0";
    start.at = [&scene](double) { return CameraSource{.camera = scene.cameras[0]}; };
    start.moves = true;
    return start;
}

} // namespace

TEST_CASE("time starts at 0, runs at its speed, loops or stops at its end and continues from there") {
    SceneClock clock = {.end_s = 4};
    clock.advance(1);
    CHECK_FALSE(clock.time_s.has_value()); // the clock is stopped
    clock.play(true);
    clock.advance(1);
    CHECK(clock.time_s == 0);
    clock.speed = 0.5;
    clock.advance(3);
    CHECK(clock.time_s == 1.5);
    clock.speed = 1;
    clock.advance(3);
    CHECK(clock.time_s == 0.5);
    clock.loops = false;
    clock.advance(10);
    CHECK(clock.time_s == 4);
    CHECK_FALSE(clock.plays);
    clock.play(true);
    CHECK(clock.time_s == 0);
    clock.seek(9);
    CHECK(clock.time_s == 4);
}

TEST_CASE("time moves a scene's camera until a user moves it, and again after they go home") {
    Scene scene = scene_with_camera();
    const StartCamera start = start_at(scene);
    ViewCamera view(start, scene);
    Camera lens = start.camera;
    CHECK(view.moves_with_time());
    scene.cameras[0].world_from_camera = look_at({1, 1, 5}, {0, 1, 0}, {0, 1, 0});
    scene.cameras[0].fov_y = 0.5f;
    view.seek(1.0, lens);
    CHECK(view.camera(lens).world_from_camera == scene.cameras[0].world_from_camera);
    CHECK(lens.fov_y == 0.5f);
    lens.fov_y = 0.6f; // the user moved the camera, so it stays
    scene.cameras[0].fov_y = 0.4f;
    view.seek(1.5, lens);
    CHECK(lens.fov_y == 0.6f);
    view.step(step_forward(), lens, 1);
    CHECK(view.is_own());
    CHECK_FALSE(view.moves_with_time());
    const Camera own = view.camera(lens);
    scene.cameras[0].world_from_camera = look_at({2, 1, 5}, {0, 1, 0}, {0, 1, 0});
    view.seek(2.0, lens);
    CHECK(view.camera(lens) == own);
    view.return_to_start(2.0, lens);
    CHECK(view.camera(lens).world_from_camera == scene.cameras[0].world_from_camera);
    CHECK(lens.fov_y == 0.4f);
    CHECK(view.moves_with_time());
}

TEST_CASE("flags state a camera's position to the bit, or the name of the scene's camera if they cannot") {
    Scene scene = scene_with_camera();
    Transform turned = look_at({0, 1, 5}, {0.3f, 1.1f, 0}, {0, 1, 0});
    turned.row0.x = std::nextafter(turned.row0.x, 0.0f); // no look_at has this value
    scene.cameras[0].world_from_camera = turned;
    const StartCamera start = start_at(scene);
    ViewCamera view(start, scene);
    Camera lens = start.camera;
    CHECK_FALSE(view.is_given_by_pose());
    CHECK(view.flags(lens, 1.25).starts_with("--camera 0 --fov "));
    CHECK(view.flags(lens, 1.25).ends_with(" --time 1.25"));
    view.step(step_forward(), lens, 1);
    CHECK(view.is_given_by_pose());
    CHECK(view.flags(lens, {}).find("--eye") != std::string::npos);
    CHECK(view.flags(lens, {}).find("--time") == std::string::npos);
}

TEST_CASE("recorded keys are ordered by time, and the camera passes through them to the bit") {
    const Scene scene = scene_with_camera();
    const StartCamera start = start_at(scene);
    ViewCamera view(start, scene);
    Camera lens = start.camera;
    CHECK_FALSE(view.follow_path(0.0, lens)); // there is no key
    view.step(step_forward(), lens, 1);
    const Camera second = view.camera(lens);
    CHECK(view.add_key(2, lens));
    view.step(step_forward(), lens, 5);
    lens.fov_y = 0.5f;
    const Camera first = view.camera(lens);
    CHECK(view.add_key(0.5f, lens));
    REQUIRE(view.path().keys.size() == 2);
    CHECK(view.path().keys[0].time_s == 0.5);
    CHECK(view.follow_path(0.5, lens));
    CHECK(view.moves_with_time());
    CHECK(view.camera(lens).world_from_camera == first.world_from_camera);
    CHECK(view.camera(lens).fov_y == first.fov_y);
    view.seek(2.0, lens);
    CHECK(view.camera(lens).world_from_camera == second.world_from_camera);
    CHECK(view.is_given_by_pose());
    CHECK(view.add_key(2, lens)); // replaces the key at that time
    CHECK(view.path().keys.size() == 2);
    view.remove_key(7);
    view.remove_key(0);
    view.remove_key(0);
    CHECK(view.path().keys.empty());
    CHECK(view.camera(lens).world_from_camera == second.world_from_camera); // the camera stays at its position
    view.return_to_start(2.0, lens);
    CHECK(view.camera(lens).world_from_camera == start.camera.world_from_camera);
    for (std::size_t i = 0; i < ViewCamera::kMaxKeys; ++i) CHECK(view.add_key(static_cast<float>(i), lens));
    CHECK_FALSE(view.add_key(1e6f, lens));
    CHECK(view.add_key(3, lens));
}

TEST_CASE("a path given at the start moves the camera, and home returns to that path") {
    const Scene scene = scene_with_camera();
    StartCamera start = start_at(scene);
    start.path.keys = {{.time_s = 0, .eye = {0, 0, 3}, .target = {0, 0, 0}},
                       {.time_s = 1, .eye = {0, 0, 1}, .target = {0, 0, 0}},
                       {.time_s = 2, .eye = {0, 0, -1}, .target = {0, 0, 0}}};
    start.camera.world_from_camera = look_at({0, 0, 3}, {0, 0, 0}, {0, 1, 0});
    ViewCamera view(start, scene);
    Camera lens = start.camera;
    CHECK(view.moves_with_time());
    CHECK(view.path().keys[0].fov_deg > 0); // so that keys can be added to it
    view.seek(1.0, lens);
    CHECK(view.camera(lens).world_from_camera.translation == Vec3{0, 0, 1});
    CHECK(view.camera(lens).fov_y == start.camera.fov_y);
    const Camera before = view.camera(lens);
    view.seek(1.5, lens); // the eye passes through its target, so there is no view
    CHECK(is_finite(view.camera(lens).world_from_camera.row0));
    view.seek(1.0, lens);
    CHECK(view.camera(lens) == before);
    view.step(step_forward(), lens, 1);
    view.return_to_start(1.0, lens);
    CHECK(view.camera(lens) == before);
}

TEST_CASE("a default view adapts to the window's aspect until a user moves") {
    const Scene scene;
    StartCamera start;
    start.framed = [](float aspect) {
        CameraSource source;
        source.target = {0, 0, 0};
        source.camera.world_from_camera =
            look_at({0, 0, 4 / aspect}, {0, 0, 0}, {0, 1, 0}); // the window is narrow, so the camera is farther away
        return source;
    };
    start.camera = start.framed(2).camera;
    start.pose = {{0, 0, 2}, {0, 0, 0}, {0, 1, 0}, {0, 0, 0}};
    start.at = [&](double) { return CameraSource{.camera = start.camera}; };
    ViewCamera camera(start, scene);
    Camera lens = start.camera;
    const auto away = [&] { return camera.camera(lens).world_from_camera.translation.z; };
    CHECK(away() == 2);
    camera.fit(0.5f, lens);
    CHECK(away() == 8);
    CHECK(camera.is_given_by_pose()); // the flags give the same picture
    camera.seek(0.5, lens);           // time does not move it
    CHECK(away() == 8);
    ClientMessage zoom;
    zoom.kind = MessageKind::Zoom;
    zoom.steps = 1;
    camera.step(zoom, lens, 1);
    const float own = away();
    CHECK(own < 8);
    camera.fit(1, lens);
    CHECK(away() == own);
    camera.return_to_start(std::nullopt, lens);
    CHECK(away() == 4);
}

TEST_CASE("a default view is stated to the bit by eye and target before any motion") {
    test::Random random(5);
    for (int i = 0; i < 200; ++i) {
        Scene scene;
        scene.materials.emplace_back();
        Mesh mesh;
        const Vec3 corner = {random.within(-9, 9), random.within(-9, 9), random.within(-9, 9)};
        mesh.positions = {corner, corner + Vec3{1, 0.1f, 0}, corner + Vec3{0, random.within(0.1f, 5), 1}};
        mesh.indices = {0, 1, 2};
        scene.meshes.push_back(std::move(mesh));
        scene.instances.emplace_back();
        Messages ignored;
        const float aspect = random.within(0.5f, 2);
        StartCamera start;
        start.camera = choose_camera({}, scene, aspect, ignored);
        start.pose = pose_of(CameraSource{.camera = start.camera}, scene, 3);
        CHECK(length(start.pose.centre - start.pose.eye) == doctest::Approx(3));
        const ViewCamera view(start, scene);
        CHECK(view.is_given_by_pose());
        const Pose pose = view.pose();
        const CameraChoice choice = {
            .eye = in_file(scene, pose.eye), .target = in_file(scene, pose.target), .up = pose.up};
        CHECK(choose_camera(choice, scene, aspect, ignored).world_from_camera == start.camera.world_from_camera);
    }
}
