// Detection of emitters that are too weak to light the scene, and the default light for such scenes.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "formats/read_scene.h"
#include "session/opening/open_scene.h"
#include "session/survey/default_light.h"
#include "session/survey/weak_light.h"
#include "tests/support/options.h"

using namespace pertev;

namespace weak_light_test { // test files are compiled together

/// A quad with half the side `half` about `middle`. Its front has the unit normal `front`.
void add_quad(Scene& scene, Vec3 middle, Vec3 front, float half, uint32_t material) {
    const Vec3 u = half * Vec3{front.y, front.z, front.x}, v = cross(front, u);
    Mesh mesh;
    mesh.positions = {middle - u - v, middle + u - v, middle + u + v, middle - u + v};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    scene.meshes.push_back(std::move(mesh));
    scene.instances.push_back({.name = "quad",
                               .mesh = static_cast<uint32_t>(scene.meshes.size() - 1),
                               .material = material,
                               .world_from_local = {}});
}

/// A cube of 1 m with an emitter of 2 cm on its top that faces up.
Scene make_body_with_emitter() {
    Scene scene;
    scene.materials.push_back({{}, "body"});
    scene.materials.push_back({{.emission = grey(50)}, "lamp"});
    for (const Vec3 front :
         {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 1}, Vec3{0, 0, -1}}) {
        add_quad(scene, 0.5f * front, front, 0.5f, 0);
    }
    add_quad(scene, {0, 0.501f, 0}, {0, 1, 0}, 0.01f, 1);
    return scene;
}

/// A floor below an emitter of 1 m.
Scene make_lit_floor() {
    Scene scene;
    scene.materials.push_back({{}, "floor"});
    scene.materials.push_back({{.emission = grey(5)}, "lamp"});
    add_quad(scene, {}, {0, 1, 0}, 2, 0);
    add_quad(scene, {0, 2, 0}, {0, -1, 0}, 0.5f, 1);
    return scene;
}

DefaultLight light_added(Scene scene, SceneUse use) {
    Messages messages;
    const DefaultLight added = add_default_light(scene, use, messages);
    CHECK(messages.all().size() == (added == DefaultLight::None ? 0 : 1)); // the notice comes from the caller
    CHECK(scene.environment.has_value() == (added == DefaultLight::Sky));
    return added;
}

void add_emission_texture(Scene& scene, uint8_t value) {
    TextureImage image;
    image.rgba8.width = image.rgba8.height = 1;
    image.rgba8.pixels = {value, value, value, 255};
    scene.images.push_back(std::move(image));
    scene.materials[1].emission_texture.image = 0;
}

TEST_CASE("a scene with a weak emitter gets a sky in renders, but not in other verbs") {
    const Scene scene = make_body_with_emitter();
    CHECK(shares_seen(scene).lit < 0.01);
    CHECK(light_added(scene, SceneUse::Picture) == DefaultLight::Sky);
    CHECK(light_added(scene, SceneUse::Measurement) == DefaultLight::None);
    CHECK(light_added(scene, SceneUse::Benchmark) == DefaultLight::None);
}

TEST_CASE("a scene whose emitter lights what is visible gets no sky, with or without an emission texture") {
    Scene scene = make_lit_floor();
    CHECK(shares_seen(scene).lit > 0.9);
    CHECK(light_added(scene, SceneUse::Picture) == DefaultLight::None);
    add_emission_texture(scene, 200);
    CHECK(light_added(scene, SceneUse::Picture) == DefaultLight::None);
    CHECK(light_added(scene, SceneUse::Measurement) == DefaultLight::None);
}

TEST_CASE("a light that an animation brightens counts as a light of the file") {
    Scene scene;
    scene.materials.push_back({{}, "floor"});
    add_quad(scene, {}, {0, 1, 0}, 2, 0);
    scene.lights.push_back({.name = "lamp", .position = {0, 2, 0}, .intensity = {}});
    CHECK(lacks_light(scene));
    AnimationChannel channel{.part = AnimatedPart::LightIntensity, .times = {0, 1}, .values = {0, 0, 0, 0, 0, 0}};
    scene.animations.push_back({.channels = {channel}});
    CHECK(light_added(scene, SceneUse::Measurement) == DefaultLight::Sky);
    scene.animations[0].channels[0].values[4] = 1;
    CHECK(light_added(scene, SceneUse::Measurement) == DefaultLight::None);
    CHECK(light_added(scene, SceneUse::Benchmark) == DefaultLight::None);
    CHECK(light_added(scene, SceneUse::Picture) == DefaultLight::Sky); // at time 0 it emits nothing
}

TEST_CASE("an emitter with a black texture emits nothing, so the scene gets a sky") {
    Scene scene = make_lit_floor();
    add_emission_texture(scene, 0);
    CHECK(light_added(scene, SceneUse::Picture) == DefaultLight::Sky);
    CHECK(light_added(scene, SceneUse::Measurement) == DefaultLight::Sky);
}

TEST_CASE("point lights get an additional sky only if they reach nothing visible") {
    Scene scene;
    scene.materials.push_back({{}, "floor"});
    add_quad(scene, {}, {0, 1, 0}, 2, 0);
    scene.lights.push_back({.name = "lamp", .position = {0, 2, 0}, .intensity = grey(100)});
    Light& light = scene.lights.front();
    CHECK(light_added(scene, SceneUse::Picture) == DefaultLight::None);
    light.range = 1.5f; // its range ends above the floor
    CHECK(light_added(scene, SceneUse::Picture) == DefaultLight::Sky);
    CHECK(light_added(scene, SceneUse::Measurement) == DefaultLight::None);
    CHECK(light_added(scene, SceneUse::Benchmark) == DefaultLight::None);
    light = {.name = "lamp", .kind = LightKind::Spot, .position = {0, 2, 0}, .direction = {0, -1, 0}};
    CHECK(light_added(scene, SceneUse::Picture) == DefaultLight::None);
    light.direction = {0, 1, 0};
    CHECK(light_added(scene, SceneUse::Picture) == DefaultLight::Sky);
    light = {.name = "sun", .kind = LightKind::Directional, .direction = {0, -1, 0}};
    CHECK(light_added(scene, SceneUse::Picture) == DefaultLight::None);
    add_quad(scene, {0, 3, 0}, {0, 1, 0}, 20, 0); // a roof
    Camera from_beside;
    from_beside.world_from_camera = look_at({0, 2, 4}, {}, {0, 1, 0});
    scene.cameras.push_back(from_beside);
    CHECK(light_added(scene, SceneUse::Picture) == DefaultLight::Sky);
}

TEST_CASE("the first camera of the file decides, and the emitter's brightness does not") {
    Scene scene = make_lit_floor();
    for (const float scale : {1e-6f, 1e6f}) {
        scene.materials[1].emission = grey(scale);
        CHECK(light_added(scene, SceneUse::Picture) == DefaultLight::None);
    }
    Camera from_below;
    from_below.world_from_camera = look_at({0, -3, 1}, {}, {0, 1, 0}); // sees the dark side of the floor
    scene.cameras.push_back(from_below);
    CHECK(light_added(scene, SceneUse::Picture) == DefaultLight::Sky);
}

TEST_CASE("an animation counts by its state at time 0") {
    Scene scene = make_lit_floor();
    scene.nodes.resize(1);
    scene.instances[1].node = 0; // the emitter
    AnimationChannel grows = {.target = 0, .part = AnimatedPart::Scale, .times = {0, 1}, .values = {1, 1, 1, 0, 0, 0}};
    scene.animations.push_back({.name = "", .origin = "", .channels = {grows}});
    CHECK(light_added(scene, SceneUse::Picture) == DefaultLight::None);
    scene.animations[0].channels[0].values = {0, 0, 0, 1, 1, 1}; // it is hidden at first
    CHECK(light_added(scene, SceneUse::Picture) == DefaultLight::Sky);
}

TEST_CASE("glowing labels that face away do not count as light for an object, and emitters within boxes do") {
    struct Expected {
        const char* path;
        DefaultLight added;
    };
    for (const Expected& expected : {Expected{"gltf/TransmissionTest/TransmissionTest.glb", DefaultLight::Sky},
                                     Expected{"gltf/DamagedHelmet/DamagedHelmet.glb", DefaultLight::Sky},
                                     Expected{"gltf/ClearCoatTest/ClearCoatTest.glb", DefaultLight::Sky},
                                     Expected{"cornell-box-mcguire/CornellBox-Sphere.obj", DefaultLight::None},
                                     Expected{"cornell-box-mcguire/CornellBox-Water.obj", DefaultLight::None}}) {
        const auto path = test::test_scene(expected.path);
        if (!path) continue;
        CAPTURE(expected.path);
        Messages messages;
        CHECK(light_added(read_scene(*path, {}, messages), SceneUse::Picture) == expected.added);
    }
}

TEST_CASE("benchmarks keep the sky of their stored figures") {
    Scene studio, clear;
    for (Scene* scene : {&studio, &clear}) {
        scene->materials.emplace_back();
        add_quad(*scene, {}, {0, 1, 0}, 1, 0);
    }
    Messages messages;
    add_default_light(studio, SceneUse::Picture, messages);
    add_default_light(clear, SceneUse::Benchmark, messages);
    // White surfaces that face up reflect about the same light under either.
    for (const Scene* scene : {&studio, &clear}) {
        const Image& sky = scene->environment->image;
        double irradiance = 0;
        for (uint32_t y = 0; y < sky.height / 2; ++y) {
            const double theta = 3.14159265358979 * (y + 0.5) / sky.height;
            const double weight = std::sin(theta) * std::cos(theta) * 2 * 3.14159265358979 * 3.14159265358979 /
                                  (double(sky.width) * sky.height);
            for (uint32_t x = 0; x < sky.width; ++x) {
                const float* pixel = sky.at(x, y);
                irradiance += weight * double(luminance(Rgb{pixel[0], pixel[1], pixel[2]}));
            }
        }
        CHECK(irradiance / 3.14159265358979 == doctest::Approx(1.23).epsilon(0.06));
    }
    const auto largest = [](const Scene& scene) { return *std::ranges::max_element(scene.environment->image.pixels); };
    CHECK(largest(clear) > 30);
    CHECK(largest(studio) < 9); // so it has less noise
}

} // namespace weak_light_test
