// A camera from its settings, and a scene's defaults, without a command line.

#include <doctest/doctest.h>

#include "base/error.h"
#include "math/portable_math.h"
#include "session/degrees.h"
#include "session/opening/choose_camera.h"
#include "session/opening/open_scene.h"
#include "tests/support/options.h"
#include "tests/support/thrown_error.h"
#include "tests/support/write_text.h"

using namespace pertev;

namespace {

/// A square of side 2 in the plane z = 0, with two cameras.
Scene make_scene() {
    Scene scene;
    Mesh square;
    square.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    square.indices = {0, 1, 2, 0, 2, 3};
    scene.meshes.push_back(square);
    scene.materials.resize(1);
    scene.instances.push_back({.name = "square", .mesh = 0, .material = 0, .world_from_local = {}});
    scene.cameras.push_back({.name = "first", .world_from_camera = make_translation({0, 0, 5})});
    scene.cameras.push_back({.name = "second", .world_from_camera = make_translation({0, 0, 9})});
    return scene;
}

Camera choose(const CameraChoice& choice, const Scene& scene = make_scene()) {
    Messages messages;
    return choose_camera(choice, scene, 1, messages);
}

} // namespace

TEST_CASE("the scene's first camera is used, or the one chosen by name or number") {
    CHECK(choose({}).name == "first");
    CHECK(choose({.camera = "second"}).name == "second");
    CHECK(choose({.camera = "1"}).name == "second");
    const auto error = test::thrown_error([] { choose({.camera = "third"}); });
    CHECK(test::is_about(error, ErrorCode::BadInput, "camera", "third"));
    CHECK(test::says(error, "\n  0  first\n  1  second"));
}

TEST_CASE("an eye without a target looks at the scene's centre, with a notice") {
    Messages messages;
    const Camera camera = choose_camera({.eye = DoubleVec3{0, 0, -3}}, make_scene(), 1, messages);
    CHECK(camera.world_from_camera == look_at({0, 0, -3}, {0, 0, 0}, {0, 1, 0}));
    CHECK(camera.focus_distance == 3);
    REQUIRE(messages.all().size() == 1);
    CHECK(messages.all()[0].remark.setting == "eye");
    CHECK(messages.all()[0].text.ends_with("(`eye=0,0,-3` `target=0,0,0`)"));
}

TEST_CASE("a lens without a focus distance focuses on the middle of the picture unless a target is given") {
    CHECK(choose({.eye = DoubleVec3{0, 0, 4}, .aperture = 0.1f}).focus_distance == 4);
    CHECK(choose({.camera = "second", .aperture = 0.1f}).focus_distance == 9);
    CHECK(choose({.eye = DoubleVec3{0, 0, 4}, .target = DoubleVec3{0, 0, 2}, .aperture = 0.1f}).focus_distance == 2);
    CHECK(choose({.aperture = 0.1f, .focus = 7.0f}).focus_distance == 7);
}

TEST_CASE("the shape of an aperture is taken, and a part of it without effect is warned of") {
    const CameraChoice shaped = {.aperture = 0.1f, .aperture_blades = 6, .aperture_rotation = 15, .aperture_ratio = 2};
    CHECK(choose(shaped).aperture == ApertureShape{6, 15, 2});
    CameraChoice stated;
    state_lens(choose(shaped), stated);
    CHECK(choose(stated).aperture == choose(shaped).aperture);
    const auto warned_of = [](CameraChoice choice) {
        Messages messages;
        choose_camera(choice, make_scene(), 1, messages);
        std::string all;
        for (const auto& message : messages.all()) all += message.remark.setting + " ";
        return all;
    };
    CHECK(warned_of({.aperture_blades = 5, .aperture_rotation = 9, .aperture_ratio = 2}) ==
          "aperture_blades aperture_rotation aperture_ratio ");
    CHECK(warned_of({.aperture = 1.0f, .aperture_rotation = 9, .focus = 2.0f}) == "aperture_rotation ");
    CHECK(warned_of({.aperture = 1.0f, .aperture_blades = 5, .aperture_rotation = 9, .focus = 2.0f}).empty());
}

TEST_CASE("an orthographic view of a perspective camera has the same height at its target") {
    CameraChoice choice = {.eye = DoubleVec3{0, 0, 4}, .target = DoubleVec3{0, 0, 0}, .fov_deg = 90.0f};
    choice.projection = Projection::Orthographic;
    CHECK(choose(choice).projection == Projection::Orthographic);
    CHECK(choose(choice).ortho_height == doctest::Approx(8));
    choice.view_height = 3.0f;
    CHECK(choose(choice).ortho_height == 3);
}

TEST_CASE("open_scene gives a scene without light a sky or the requested environment") {
    const std::filesystem::path file =
        test::write_text(test::scratch_folder() / "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    Messages messages;
    SceneOptions options = {.scene = file.string()};
    options.environment_scale = 2;
    const Scene sky = open_scene(options, messages);
    REQUIRE(sky.environment.has_value());
    CHECK(!sky.environment->image.pixels.empty());
    CHECK(sky.environment->scale == Rgb{2, 2, 2});

    options.environment = "0.5,0.25,0.125";
    options.environment_rotation_deg = 180;
    const Scene even = open_scene(options, messages);
    CHECK(even.environment->image.pixels.empty());
    CHECK(even.environment->scale == Rgb{1, 0.5f, 0.25f});
    CHECK(even.environment->rotation == doctest::Approx(kPi));

    options.environment = "-1,0,0";
    const auto negative = test::thrown_error([&] { open_scene(options, messages); });
    CHECK(test::is_about(negative, ErrorCode::BadInput, "environment", "-1,0,0"));
    options.environment = "nowhere.exr";
    CHECK_THROWS_AS(open_scene(options, messages), Error);
}
