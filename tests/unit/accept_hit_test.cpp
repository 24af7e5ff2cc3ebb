#include <cmath>

#include <doctest/doctest.h>

#include "render/accept_hit.h"
#include "render/scene_on_device.h"

using namespace pertev;

namespace {

enum InstanceIndex : uint32_t { kSolid, kMasked, kBlended, kTinted, kInstances };

/// Four squares of two triangles: opaque; cut out by a texture, opaque left and clear right; blended at 0.3; blended at
/// 0.8 with vertex colours of alpha 1 on the left and 0 on the right.
struct AlphaScene {
    AlphaScene() : device(queue, prepare()) {}

    PreparedScene prepare() {
        Mesh square;
        square.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
        square.uv[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
        square.indices = {0, 1, 2, 0, 2, 3};
        for (int i = 0; i < 4; ++i) scene.meshes.push_back(square);
        scene.meshes[kTinted].colors = {{1, 1, 1, 1}, {1, 1, 1, 0}, {1, 1, 1, 0}, {1, 1, 1, 1}};
        TextureImage image;
        image.rgba8 = {2, 1, {255, 255, 255, 255, 255, 255, 255, 0}};
        scene.images.push_back(image);
        TextureRef half_clear{.image = 0};
        scene.materials.push_back({.name = "solid", .alpha = 0.1f}); // opaque: alpha is not looked at
        scene.materials.push_back(
            {.name = "masked", .base_color_texture = half_clear, .alpha_mode = AlphaMode::Mask, .alpha_cutoff = 0.5f});
        scene.materials.push_back({.name = "blended", .alpha = 0.3f, .alpha_mode = AlphaMode::Blend});
        scene.materials.push_back({.name = "tinted", .alpha = 0.8f, .alpha_mode = AlphaMode::Blend});
        for (uint32_t i = 0; i < kInstances; ++i) scene.instances.push_back({"", i, i, {}});
        Messages messages;
        return prepare_scene(scene, {}, messages);
    }

    /// Share of `count` paths whose ray is stopped at barycentrics (u, v) of the instance's first triangle.
    double stopped(uint32_t instance, float u, float v, uint32_t count = 20'000) const {
        uint32_t hits = 0;
        for (uint32_t key = 0; key < count; ++key)
            hits += AcceptHit{device.view(), {}, {}, key * 7919}(instance, 0, u, v);
        return static_cast<double>(hits) / count;
    }

    Scene scene;
    Queue queue = Queue::make_cpu();
    SceneOnDevice device;
};

} // namespace

TEST_CASE("a ray meets neither the triangle it leaves nor the one it is aimed at, and every other one") {
    const AlphaScene test;
    const AcceptHit accept{test.device.view(), {kSolid, 1}, {kMasked, 0}, 5};
    CHECK_FALSE(accept(kSolid, 1, 0.2f, 0.2f));
    CHECK(accept(kSolid, 0, 0.2f, 0.2f));
    CHECK_FALSE(accept(kMasked, 0, 0.0f, 0.9f));
    CHECK(accept(kMasked, 1, 0.0f, 0.9f));
    const AcceptHit from_nowhere{test.device.view(), {}, {}, 5};
    CHECK(from_nowhere(kSolid, 1, 0.2f, 0.2f));
}

TEST_CASE("opaque surfaces stop every ray, whatever their alpha") {
    const AlphaScene test;
    CHECK(test.stopped(kSolid, 0.1f, 0.1f) == 1);
}

TEST_CASE("a cut-out stops rays where its texture's alpha reaches the cutoff") {
    const AlphaScene test; // first triangle: u is the weight of (1, 0), v of (1, 1)
    CHECK(test.stopped(kMasked, 0.1f, 0.1f) == 1);
    CHECK(test.stopped(kMasked, 0.5f, 0.3f) == 0);
}

TEST_CASE("a blended surface stops as large a share of the paths as its alpha says, vertex colours included") {
    const AlphaScene test;
    const double deviation = std::sqrt(0.25 / 20'000);
    CHECK(std::abs(test.stopped(kBlended, 0.3f, 0.3f) - 0.3) < 4 * deviation);
    CHECK(std::abs(test.stopped(kTinted, 0.2f, 0.2f) - 0.8 * 0.6) < 4 * deviation);
    CHECK(test.stopped(kTinted, 0.5f, 0.5f) == 0);
}

TEST_CASE("the coin of a blended surface is a function of path, instance and primitive") {
    const AlphaScene test;
    uint32_t other_primitive = 0, other_place = 0;
    for (uint32_t key = 0; key < 1000; ++key) {
        const AcceptHit accept{test.device.view(), {}, {}, key};
        const bool first = accept(kBlended, 0, 0.3f, 0.3f);
        other_primitive += first != accept(kBlended, 1, 0.3f, 0.3f);
        other_place += first != accept(kBlended, 0, 0.1f, 0.6f); // the same alpha there: the same coin
    }
    CHECK(other_primitive > 300);
    CHECK(other_place == 0);
}
