// What is said beforehand of the memory that a scene takes on the device.

#include <doctest/doctest.h>

#include "render/scene_on_device.h"

using namespace pertev;

namespace {

Mesh make_triangle() {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.indices = {0, 1, 2};
    return mesh;
}

std::size_t bytes_of(const Scene& scene) {
    Messages messages;
    return predicted_bytes(prepare_scene(scene, {}, messages));
}

} // namespace

TEST_CASE("each light of a scene counts in the bytes that it will take") {
    constexpr std::size_t kCount = 64;
    Scene scene;
    scene.meshes.push_back(make_triangle());
    scene.materials.resize(2);
    scene.materials[1].emission = {1, 1, 1};
    for (std::size_t i = 0; i < kCount; ++i) scene.instances.push_back({"", 0, 0, {}});
    const std::size_t dark = bytes_of(scene);

    Scene with_lamps = scene;
    with_lamps.lights.resize(kCount);
    // At least: the table that draws the lights grows too, by a start and a slot (4 bytes each) for each.
    CHECK(bytes_of(with_lamps) >= dark + kCount * (sizeof(PunctualLight) + 8));

    Scene glowing = scene;
    for (Instance& instance : glowing.instances) instance.material = 1;
    CHECK(bytes_of(glowing) >= dark + kCount * (sizeof(Emitter) + sizeof(EmissiveTriangle) + 16));
}
