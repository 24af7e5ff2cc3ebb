#include <doctest/doctest.h>

#include "device_scene/place_meshes.h"
#include "render/prepare_scene.h"
#include "tests/support/meshes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

std::size_t warnings_for_glass(float ior, float roughness) {
    Scene scene = test::make_furnace_scene(1);
    scene.materials[0].kind = MaterialKind::Dielectric;
    scene.materials[0].ior = ior;
    scene.materials[0].roughness = roughness;
    Messages messages;
    prepare_scene(scene, {}, messages);
    return messages.all().size();
}

/// An object far from the origin, by its vertices or by its transform.
Scene torus_at(Vec3 at, bool by_vertices = true) {
    const test::TriangleMesh torus = test::make_torus(128, 80); // 3 m wide, enough triangles for the cache
    Scene scene;
    scene.meshes.push_back({});
    scene.meshes[0].positions = torus.positions;
    scene.meshes[0].indices = torus.indices;
    if (by_vertices) {
        for (Vec3& p : scene.meshes[0].positions) p = p + at;
    }
    scene.materials.push_back({});
    scene.instances.push_back({"torus", 0, 0, make_translation(by_vertices ? Vec3{} : at)});
    return scene;
}

} // namespace

TEST_CASE("rough glass whose index is out of range causes a warning") {
    CHECK(warnings_for_glass(1.05f, 0.3f) == 1);
    CHECK(warnings_for_glass(4, 0.3f) == 1);
    CHECK(warnings_for_glass(1.5f, 0.3f) == 0);
    CHECK(warnings_for_glass(1, 0.3f) == 0);
    CHECK(warnings_for_glass(1.05f, 0) == 0); // smooth glass supports any index
}

TEST_CASE("the world's centre is the middle of the scene on a grid of the scene's size, and 0 for a scene around 0") {
    CHECK(world_centre(Scene{}) == Vec3{0, 0, 0});
    for (const bool by_vertices : {true, false}) { // 3 m wide: a grid of 4 m
        CHECK(world_centre(torus_at({0, 0, 0}, by_vertices)) == Vec3{0, 0, 0});
        CHECK(world_centre(torus_at({1.9f, -1.9f, 0}, by_vertices)) == Vec3{0, 0, 0});
        CHECK(world_centre(torus_at({2.1f, -2.1f, 101}, by_vertices)) == Vec3{4, -4, 100});
    }
    Scene two = torus_at({1000, 0, 0}); // adds a second object 1.5 km away, because the box of all objects counts
    two.meshes.push_back(torus_at({-500, 0, 0}).meshes[0]);
    two.instances.push_back({"second", 1, 0, {}});
    CHECK(world_centre(two) == Vec3{0, 0, 0});
    for (Instance& instance : two.instances) instance.world_from_local = make_translation({2900, 0, 0});
    CHECK(world_centre(two) == Vec3{4096, 0, 0}); // the centre is at 3150 m, and the grid is 2048 m
}

TEST_CASE("trees and lights are in the translated world, or in the file's if rays use its coordinates") {
    Scene scene = torus_at({1000, 0, 0});
    scene.lights.push_back({.name = "lamp", .position = {1001, 2, 3}});
    scene.materials[0].emission = {1, 1, 1};
    Messages messages;
    const PreparedScene moved = prepare_scene(scene, {}, messages);
    CHECK(moved.centre == Vec3{1000, 0, 0});
    CHECK(moved.trees.baked().bounds.max_abs() < 2);
    CHECK(moved.lights.punctual[0].position == Vec3{1, 2, 3});
    CHECK(max_component(abs(moved.lights.triangles[0].a)) < 2);
    const PreparedScene kept = prepare_scene(scene, {.bvh = {}, .bvh_cache = {}, .keep_coordinates = true}, messages);
    CHECK(kept.centre == Vec3{0, 0, 0});
    CHECK(kept.trees.baked().bounds.lo.x > 998);
    CHECK(kept.lights.punctual[0].position == Vec3{1001, 2, 3});
}

TEST_CASE("the cache distinguishes the tree of a translated world from that of the file's") {
    const Scene scene = torus_at({1000, 0, 0});
    PrepareOptions options;
    options.bvh_cache = test::scratch_folder();
    Messages messages;
    for (int run = 0; run < 2; ++run) { // built, then read
        options.keep_coordinates = true;
        CHECK(prepare_scene(scene, options, messages).trees.baked().bounds.lo.x > 998);
        options.keep_coordinates = false;
        CHECK(prepare_scene(scene, options, messages).trees.baked().bounds.max_abs() < 2);
    }
    CHECK(messages.all().empty());
    std::size_t trees = 0;
    for (const auto& file : std::filesystem::directory_iterator(*options.bvh_cache)) {
        trees += file.path().extension() == ".bvh" ? 1 : 0;
    }
    CHECK(trees == 2);
}
