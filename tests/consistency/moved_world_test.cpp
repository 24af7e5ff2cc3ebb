// A scene that is translated in its file has the same picture, because the world is moved before anything is
// rounded.

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>

#include "device_scene/place_meshes.h"
#include "tests/support/render_scenes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

/// Rounds a point to a grid so coarse that coordinates 8 km away are exact.
Vec3 snapped(Vec3 p) {
    const auto snap = [](float x) { return std::round(x * 64) / 64; };
    return {snap(p.x), snap(p.y), snap(p.z)};
}

struct Staged {
    Scene scene = make_mixed_scene();
    Camera camera = mixed_scene_camera();

    /// Translates everything that has a position by `by` metres.
    explicit Staged(Vec3 by) {
        const auto move = [by](Vec3& p) { p = snapped(p) + by; };
        for (Instance& instance : scene.instances) move(instance.world_from_local.translation);
        for (Light& light : scene.lights) move(light.position);
        move(camera.world_from_camera.translation);
    }

    RenderResult render() const {
        RenderSettings settings;
        settings.width = 96, settings.height = 64;
        settings.samples = 4;
        settings.aovs = kAovAlbedo | kAovNormal | kAovDepth | kAovPosition | kAovIds;
        Queue queue = requested_queue();
        return test::render(queue, scene, camera, settings);
    }
};

bool same_bits(const Image& a, const Image& b) {
    return a.pixels.size() == b.pixels.size() &&
           std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(float)) == 0;
}

} // namespace

TEST_CASE("a scene moved within its file has the same picture and layers to the bit, but other positions") {
    const Vec3 by = {8192, -4096, 2048};
    const Staged near({0, 0, 0}), far(by);
    REQUIRE(world_centre(near.scene) == Vec3{0, 0, 0});
    REQUIRE(world_centre(far.scene) == by);
    const RenderResult a = near.render(), b = far.render();
    CHECK(same_bits(a.picture, b.picture));
    REQUIRE(a.layers.size() == 4);
    for (std::size_t i = 0; i < a.layers.size(); ++i) {
        CAPTURE(a.layers[i].name);
        const Image &here = a.layers[i].image, &there = b.layers[i].image;
        if (a.layers[i].name != "position") {
            CHECK(same_bits(here, there));
            continue;
        }
        float farthest = 0;
        std::size_t hits = 0;
        for (std::size_t k = 0; k < here.pixels.size(); ++k) {
            const uint64_t pixel = k / 3;
            const bool is_hit = a.layers[2].image.pixels[pixel] != 0; // depth
            const float wanted = is_hit ? here.pixels[k] + component(by, static_cast<int>(k % 3)) : 0.0f;
            farthest = max(farthest, std::abs(there.pixels[k] - wanted));
            hits += is_hit ? 1 : 0;
        }
        CHECK(hits > here.pixels.size() / 2);
        CHECK(farthest <= 0x1p-11f); // half a unit at 8 km
    }
}
