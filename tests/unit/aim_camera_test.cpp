// The default target and focus distance of a camera.

#include <doctest/doctest.h>

#include "session/survey/aim_camera.h"

using namespace pertev;

namespace {

/// Two upright squares, 2 m wide: one at z = 0, and one whose instance turns it round and moves it to z = -3.
Scene make_two_sheets() {
    Scene scene;
    Mesh mesh;
    mesh.positions = {{-1, 0, 0}, {1, 0, 0}, {1, 2, 0}, {-1, 2, 0}};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    scene.meshes.push_back(std::move(mesh));
    scene.materials.emplace_back();
    scene.instances.push_back({"front", 0, 0, {}});
    scene.instances.push_back({"back", 0, 0, compose(make_translation({0, 0, -3}), make_rotation(0, 1, 0, 0))});
    return scene;
}

} // namespace

TEST_CASE("an eye without a target looks at the scene's centre, and from the centre along the scene") {
    const Scene scene = make_two_sheets();
    const Target far = target_from(scene, {5, 6, 7});
    CHECK(far.is_middle);
    CHECK(far.position == Vec3{0, 1, -1.5f});
    const Target near = target_from(scene, {0, 1, -1.5f});
    CHECK(!near.is_middle);
    CHECK(near.position == Vec3{0, 1, -3});
}

TEST_CASE("the distance at the picture's centre is that of the nearest surface") {
    const Scene scene = make_two_sheets();
    Camera camera;
    camera.world_from_camera = look_at({0.3f, 1, 4}, {0.3f, 1, 0}, {0, 1, 0});
    CHECK(distance_in_the_middle(scene, camera).value() == doctest::Approx(4));
    camera.projection = Projection::Orthographic;
    CHECK(distance_in_the_middle(scene, camera).value() == doctest::Approx(4));
    camera.world_from_camera = look_at({0.3f, 1, -1}, {0.3f, 1, -3}, {0, 1, 0});
    CHECK(distance_in_the_middle(scene, camera).value() == doctest::Approx(2));
    camera.world_from_camera = look_at({0.3f, 1, 4}, {0.3f, 1, 9}, {0, 1, 0});
    CHECK(!distance_in_the_middle(scene, camera).has_value());
}

TEST_CASE("hidden backs do not count as the surface at the picture's centre") {
    Scene scene = make_two_sheets();
    scene.instances[1].world_from_local = make_translation({0, 0, -3}); // both face +z
    Camera camera;
    camera.world_from_camera = look_at({0.3f, 1, -5}, {0.3f, 1, 0}, {0, 1, 0});
    CHECK(distance_in_the_middle(scene, camera).value() == doctest::Approx(2));
    scene.materials[0].double_sided = false;
    CHECK(!distance_in_the_middle(scene, camera).has_value());
    scene.instances[0].world_from_local = make_rotation(0, 1, 0, 0); // the front of the far square faces the camera
    CHECK(distance_in_the_middle(scene, camera).value() == doctest::Approx(5));
    scene.instances[1].world_from_local =
        compose(make_translation({0, 0, -3}), make_scale({-1, 1, 1})); // the near square still shows its back
    CHECK(distance_in_the_middle(scene, camera).value() == doctest::Approx(5));
    scene.materials.emplace_back(); // gets its own material, whose back is visible
    scene.instances[1].material = 1;
    CHECK(distance_in_the_middle(scene, camera).value() == doctest::Approx(2));
}
