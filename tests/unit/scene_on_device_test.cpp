// A scene's parts in a device's memory, each updated separately. With --device cuda it runs on the GPU.

#include <cstdint>

#include <doctest/doctest.h>

#include "device_scene/part_arrays.h"
#include "device_scene/scene_on_device.h"
#include "image/picture_hash.h"
#include "integrators/kinds/make_integrator.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/solid_scenes.h"

using namespace pertev;

namespace {

struct Inner {
    const float* values;
};

/// Returns the hash of a picture that is traced in the trees of `prepared`.
Hash128 hash_of(Queue& queue, const SceneOnDevice& scene, const PreparedScene& prepared) {
    Film film(queue, 40, 30, kAovAlbedo | kAovPosition);
    SceneTracer tracer(queue, *prepared.structures, default_tracers(queue.is_cuda()));
    tracer.set_surfaces(scene.view());
    const PixelFilterView box = {PixelFilter::Box, 0.5f, nullptr};
    const auto renderer = make_integrator(queue, {.path = {}, .body = PathBody::Wavefront, .batch = 2000});
    renderer->begin({scene.view(), make_camera_rays(test::mixed_scene_camera(), box, 40, 30, scene.view().centre)},
                    tracer, 2);
    renderer->render(0, 2, film.view());
    film.set_samples({0, 2});
    Hasher hasher;
    hasher.add_values(std::span<const float>(film.picture(true).pixels));
    for (const FilmLayer& layer : film.layers()) hasher.add_values(std::span<const float>(layer.image.pixels));
    return hasher.result();
}

Hash128 hash_afresh(const PreparedScene& prepared) {
    Queue queue = Queue::make_cpu();
    return hash_of(queue, SceneOnDevice(queue, prepared), prepared);
}

PreparedScene prepare(const Scene& scene) {
    Messages messages;
    return prepare_scene(scene, {}, messages);
}

} // namespace

TEST_CASE("arrays of a scene part lie in one buffer at multiples of 256 bytes and may hold pointers to others") {
    Queue queue = Queue::make_cpu();
    Buffer<std::byte> buffer;
    const std::vector<float> numbers = {1, 2, 3}, none;
    const std::vector<uint8_t> many(300, 7);
    std::vector<Inner> inner(2);
    const float* empty = numbers.data();
    const uint8_t* bytes = nullptr;
    const Inner* views = nullptr;
    PartArrays arrays;
    arrays.add(many, bytes);
    arrays.add(none, empty);
    arrays.add(numbers, inner[0].values);
    arrays.add(none, inner[1].values);
    arrays.add(inner, views);
    CHECK(arrays.bytes() == 512 + 256 + 256);
    arrays.upload(queue, buffer, "part");
    CHECK(queue.allocated_bytes() == arrays.bytes());
    CHECK(empty == nullptr);
    REQUIRE(bytes != nullptr);
    CHECK(bytes != many.data());
    CHECK(bytes[299] == 7);
    REQUIRE(views != nullptr);
    CHECK(views[0].values[2] == 3);
    CHECK(views[1].values == nullptr);
    for (const void* pointer : {static_cast<const void*>(bytes), static_cast<const void*>(views),
                                static_cast<const void*>(views[0].values)}) {
        CHECK(reinterpret_cast<uintptr_t>(pointer) % 256 == 0);
    }
}

TEST_CASE("a scene part's buffer is kept while it is large enough, and otherwise replaced, not doubled") {
    Queue queue = Queue::make_cpu();
    Buffer<std::byte> buffer;
    const auto upload = [&](std::size_t count) {
        const std::vector<uint8_t> values(count, 1);
        const uint8_t* target = nullptr;
        PartArrays arrays;
        arrays.add(values, target);
        arrays.upload(queue, buffer, "part");
        return target;
    };
    const uint8_t* const first = upload(5000);
    CHECK(upload(5000) == first);
    CHECK(upload(3) == first);
    CHECK(upload(0) == nullptr);
    CHECK(queue.allocated_bytes() == 5120);
    CHECK(queue.peak_bytes() == 5120);
    CHECK(upload(5121) != nullptr);
    CHECK(queue.allocated_bytes() == 5376);
    CHECK(queue.peak_bytes() == 5376);
}

TEST_CASE("a scene updated in parts gives the picture of a fresh upload and allocates no memory") {
    const Scene before = test::make_mixed_scene();
    Scene after = before;
    for (Material& material : after.materials) material.base_color = 0.5f * material.base_color;
    for (Light& light : after.lights) light.intensity = 2.0f * light.intensity;
    after.environment->scale = 2.0f * after.environment->scale;
    for (Instance& instance : after.instances) instance.world_from_local.translation.x += 0.125f;
    for (Mesh& mesh : after.meshes) {
        for (Vec2& uv : mesh.uv[0]) uv = 2.0f * uv;
    }
    for (TextureImage& image : after.images) {
        for (uint8_t& value : image.rgba8.pixels) value = static_cast<uint8_t>(value / 2);
        for (float& value : image.rgba_float.pixels) value *= 0.5f;
    }
    const PreparedScene old_scene = prepare(before), new_scene = prepare(after);

    Queue queue = test::requested_queue();
    SceneOnDevice scene(queue, old_scene);
    Hash128 last = hash_of(queue, scene, old_scene);
    CHECK(last == hash_afresh(old_scene));
    const std::size_t bytes = queue.allocated_bytes();
    const auto changes = [&](const char* part, const PreparedScene* trees = nullptr) {
        CAPTURE(part);
        const Hash128 now = hash_of(queue, scene, trees == nullptr ? old_scene : *trees);
        CHECK(now != last); // each update makes another change
        last = now;
    };
    scene.update(queue, new_scene, kPartTextures);
    changes("textures");
    scene.update(queue, new_scene, kPartMaterials);
    changes("materials");
    scene.update(queue, new_scene, kPartGeometry);
    changes("geometry");
    scene.update(queue, new_scene, kPartLights);
    changes("lights");
    scene.update(queue, new_scene, kPartEnvironment);
    changes("environment");
    scene.update(queue, new_scene, kPartInstances);
    changes("instances", &new_scene);
    CHECK(last == hash_afresh(new_scene));
    const auto micromaps = [&](const PlacedScene& of) {
        return queue.is_cuda() ? predicted_bytes(of, true) - predicted_bytes(of, false) : 0;
    };
    CHECK(queue.allocated_bytes() ==
          bytes + micromaps(new_scene) - micromaps(old_scene)); // finer where textures repeat
}

TEST_CASE("closed meshes are found once for moving solids, and again after the geometry has changed") {
    Scene scene;
    test::add(scene, test::box({0, 0, 0}, {1, 1, 1}), test::glass(1.5f));
    test::add(scene, test::box({0, 0, 0}, {0.5f, 0.5f, 0.5f}), test::glass(1.2f));
    Queue queue = Queue::make_cpu();
    SceneOnDevice on_device(queue, prepare(scene));
    CHECK(on_device.nested_solids().ranks() == std::vector<uint16_t>{1, 2});
    scene.instances[1].world_from_local = make_translation({5, 0, 0});
    on_device.update(queue, prepare(scene), kPartInstances);
    CHECK(on_device.nested_solids().is_empty());
    scene.instances[1].world_from_local = {};
    on_device.update(queue, prepare(scene), kPartInstances);
    CHECK(on_device.nested_solids().ranks() == std::vector<uint16_t>{1, 2});
    scene.meshes[1].indices.resize(scene.meshes[1].indices.size() - 3); // It is open now.
    on_device.update(queue, prepare(scene), kPartGeometry | kPartInstances);
    CHECK(on_device.nested_solids().is_empty());

    ClosedMeshes closed;
    scene.meshes[1] = test::box({0, 0, 0}, {0.5f, 0.5f, 0.5f});
    const auto shape = closed.shape_of(scene, 1);
    REQUIRE(shape != nullptr);
    CHECK(NestedSolids(scene, {}, closed).ranks() == std::vector<uint16_t>{1, 2});
    CHECK(closed.shape_of(scene, 1) == shape);
    closed.clear();
    CHECK(closed.shape_of(scene, 1) != shape);
}
