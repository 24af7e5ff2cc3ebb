// The camera of a moving scene: missing values are completed at rest, and a scene's camera follows its node.

#include "session/opening/moving_camera.h"

#include <doctest/doctest.h>

#include "base/error.h"
#include "scene/pose/posed_scene.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

/// A sphere that starts at the origin and moves along x at 1 m/s, and a camera that moves along z.
Scene make_scene(bool with_camera) {
    Scene scene = test::make_furnace_scene(0.5f);
    scene.nodes.resize(2);
    scene.instances[0].node = 0;
    const auto go = [&](uint32_t node, Vec3 to) {
        AnimationChannel channel;
        channel.target = node;
        channel.times = {0, 10};
        channel.values = {0, 0, 0, to.x, to.y, to.z};
        scene.animations.push_back({.name = "", .origin = "", .channels = {channel}});
    };
    go(0, {10, 0, 0});
    go(1, {0, 0, 10});
    if (with_camera) scene.cameras.push_back({.name = "own", .node = 1});
    return scene;
}

Vec3 eye_of(const Camera& camera) { return camera.world_from_camera.translation; }

} // namespace

TEST_CASE("a default camera is that of the scene at rest, whatever the time") {
    PosedScene posed(make_scene(false));
    Messages messages;
    const MovingCamera moving({}, std::nullopt, posed.scene(), 1, messages);
    const Camera at_rest = moving.at(posed.scene(), std::nullopt);
    posed.set_time(8);
    CHECK(moving.at(posed.scene(), 8.0) == at_rest);
}

TEST_CASE("a scene's camera moves with its node and keeps values of settings") {
    PosedScene posed(make_scene(true));
    Messages messages;
    CameraChoice choice;
    choice.fov_deg = 30.0f;
    choice.aperture =
        0.1f; // no surface is at the picture's centre at rest, so the camera focuses on the scene's centre
    const MovingCamera moving(choice, std::nullopt, posed.scene(), 1, messages);
    const Camera at_rest = moving.at(posed.scene(), std::nullopt);
    posed.set_time(6);
    const Camera now = moving.at(posed.scene(), 6.0);
    CHECK(eye_of(now) == Vec3{0, 0, 6});
    CHECK(now.fov_y == at_rest.fov_y);
    CHECK(now.focus_distance == at_rest.focus_distance);
    choice.target = DoubleVec3{0, 0, -4};
    const MovingCamera aimed(choice, std::nullopt, posed.scene(), 1, messages);
    CHECK(aimed.at(posed.scene(), 6.0).focus_distance == 10);
}

TEST_CASE("a path moves the camera, and an error names the time of an invalid camera") {
    PosedScene posed(make_scene(true));
    Messages messages;
    const CameraPath path = {
        {{.time_s = 0, .eye = {0, 0, 4}, .target = {0, 0, 0}}, {.time_s = 2, .eye = {0, 0, -4}, .target = {0, 0, 0}}}};
    const MovingCamera moving({}, path, posed.scene(), 1, messages);
    CHECK(eye_of(moving.at(posed.scene(), std::nullopt)) == Vec3{0, 0, 4});
    CHECK(eye_of(moving.at(posed.scene(), 0.5)) == Vec3{0, 0, 2});
    CHECK_THROWS_WITH_AS(moving.at(posed.scene(), 1.0), doctest::Contains("the camera's path at 1 s"), Error);
}

TEST_CASE("a turntable orbits the target counter-clockwise and returns") {
    PosedScene posed(make_scene(true));
    Messages messages;
    CameraChoice choice;
    choice.eye = DoubleVec3{1, 2, 8}, choice.target = DoubleVec3{1, 0, 3};
    const MovingCamera moving(choice, std::nullopt, posed.scene(), 1, messages);
    const Camera camera = moving.at(posed.scene(), std::nullopt);
    CHECK(moving.turned(camera, 0) == camera);
    CHECK(moving.turned(camera, 1).world_from_camera.translation == camera.world_from_camera.translation);
    const Camera quarter = moving.turned(camera, 0.25); // from +z to +x
    CHECK(length(eye_of(quarter) - Vec3{6, 2, 3}) < 1e-5f);
    const Vec3 forward = -column(quarter.world_from_camera, 2);
    CHECK(length(normalize(Vec3{1, 0, 3} - eye_of(quarter)) - forward) < 1e-5f);
}
