// The choice of instances to bake into world space, and the limit of copies.

#include <doctest/doctest.h>

#include <string>

#include "base/error.h"
#include "base/limits.h"
#include "device_scene/place_meshes.h"
#include "render/prepare_scene.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

/// A mesh of `triangles` equal triangles. One instance has an ordinary transform, and `squeezed` instances have
/// transforms too skewed for a tree.
Scene scene_of(uint32_t triangles, uint32_t squeezed) {
    Scene scene;
    scene.bakes_small_meshes = false;
    Mesh& mesh = scene.meshes.emplace_back();
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    for (uint32_t i = 0; i < 3 * triangles; ++i) mesh.indices.push_back(i % 3);
    scene.materials.emplace_back();
    scene.instances.resize(1 + squeezed);
    for (uint32_t i = 1; i <= squeezed; ++i) {
        scene.instances[i].name = "leaf";
        scene.instances[i].world_from_local = make_scale({1, 1, 1e-4f});
    }
    return scene;
}

} // namespace

TEST_CASE("an instance is baked if it alone uses its mesh or if its space is skewed") {
    CHECK(place_meshes(scene_of(1, 0)).is_baked == std::vector<bool>{true});
    CHECK(place_meshes(scene_of(1, 0)).copies == 0);
    const MeshPlacement placement = place_meshes(scene_of(5, 2));
    CHECK(placement.is_baked == std::vector<bool>{false, true, true});
    CHECK(placement.mesh_tree_count == 1);
    CHECK(placement.copies == 2);
    CHECK(placement.copied_triangles == 10);
}

TEST_CASE("shared meshes are baked as long as the smallest of them have few triangles in all instances") {
    const auto scene_with = [](const std::vector<uint32_t>& triangles, uint32_t uses) {
        Scene scene;
        scene.materials.emplace_back();
        for (uint32_t mesh = 0; mesh < triangles.size(); ++mesh) {
            scene.meshes.push_back(scene_of(triangles[mesh], 0).meshes.front());
            for (uint32_t i = 0; i < uses; ++i) scene.instances.push_back({"", mesh, 0, {}});
        }
        return scene;
    };
    constexpr uint32_t most = kMaxSmallCopies;
    using Baked = std::vector<bool>;
    CHECK(place_meshes(scene_with({most / 2}, 2)).is_baked == Baked{true, true});
    CHECK(place_meshes(scene_with({most / 2}, 2)).copies == 0);
    CHECK(place_meshes(scene_with({most / 2 + 1}, 2)).is_baked == Baked{false, false});
    const Baked second = {false, false, true, true, false, false}; // the third alone would be small, too
    const Scene three = scene_with({most / 2, 2, most / 2 - 1}, 2);
    CHECK(place_meshes(three).is_baked == second);
    CHECK(place_meshes(three).mesh_tree_count == 2);
    CHECK(place_meshes(scene_with({1u << 16}, 1u << 16)).is_baked == Baked(1u << 16, false)); // 2^32 triangles
    Scene two = scene_with({2, 12}, 2);
    CHECK(place_meshes(two, {}, {true, false, false, false}).is_baked == Baked{false, true, true, true});
    two.instances[2].is_hidden = true;
    CHECK(place_meshes(two).is_baked == Baked{true, true, false, true});
    two.bakes_small_meshes = false;
    CHECK(place_meshes(two).is_baked == Baked(4, false));
}

TEST_CASE("baked copies that far exceed the scene's size are refused with the instance's name") {
    constexpr uint32_t triangles = 1u << 18, most = kFreeBakedTriangles / triangles + kMaxBakedExpansion;
    CHECK(place_meshes(scene_of(triangles, most)).copies == most);
    const auto error = test::thrown_error([] { place_meshes(scene_of(triangles, most + 1)); });
    REQUIRE(test::is_about(error, ErrorCode::OverLimit, "scene"));
    CHECK(error->reason().starts_with("instance " + std::to_string(most + 1) + " leaf: "));
}

TEST_CASE("many baked copies cause a warning") {
    Messages few, many;
    const Scene of_few = scene_of(1u << 10, 2);
    prepare_scene(of_few, {}, few);
    CHECK(few.all().empty());
    const Scene of_many = scene_of(1u << 10, 300);
    prepare_scene(of_many, {}, many);
    CHECK(test::has_warning(many, {"300 instances", "307200 more triangles"}));
}
