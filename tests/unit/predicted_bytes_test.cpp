// What is said beforehand of the memory that a scene takes on the device.

#include <doctest/doctest.h>

#include "render/scene_on_device.h"
#include "render/trees_on_device.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

Mesh make_triangle() {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.indices = {0, 1, 2};
    return mesh;
}

/// What is said of the scene, which is checked to be what it takes.
std::size_t bytes_of(const Scene& scene) {
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    const std::size_t predicted = predicted_bytes(prepared);
    {
        Queue queue = Queue::make_cpu();
        const SceneOnDevice on_device(queue, prepared);
        Queue tree_queue = Queue::make_cpu();
        Buffer<std::byte> trees; // with wide nodes, which nothing is said of
        upload_trees(tree_queue, prepared, trees);
        CHECK(queue.allocated_bytes() == predicted - predicted_tree_bytes(prepared) + tree_queue.allocated_bytes());
        CHECK(predicted_tree_bytes(prepared) <= tree_queue.allocated_bytes());
    }
    if (test::cuda_requested()) {
        Queue queue = test::make_cuda_queue();
        const SceneOnDevice on_device(queue, prepared);
        CHECK(queue.allocated_bytes() == predicted);
    }
    return predicted;
}

} // namespace

TEST_CASE("a scene takes the bytes that are said beforehand") {
    CHECK(bytes_of(test::make_mixed_scene()) > 100'000);
    CHECK(bytes_of(test::make_furnace_scene(0.5f)) > 10'000);
}

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
