// Compares light tracing and bidirectional path tracing with path tracing where both find the same light, and checks
// light that only one of them finds.

#include <doctest/doctest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "render/light_paths/light_path_layers.h"
#include "tests/support/compare_pictures.h"
#include "tests/support/flat_emitters.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

/// The six sheets of a box, facing outwards. The box is rotated by an eighth of a turn about y.
void add_box(Scene& scene, Vec3 centre, Vec3 half, const Material& material) {
    const Vec3 x = {0.8f * half.x, 0, 0.6f * half.x}, y = {0, half.y, 0}, z = {-0.6f * half.z, 0, 0.8f * half.z};
    for (const float side : {1.0f, -1.0f}) {
        test::add(scene, test::sheet(centre + side * x, side * y, z), material);
        test::add(scene, test::sheet(centre + side * y, side * z, x), material);
        test::add(scene, test::sheet(centre + side * z, side * x, y), material);
    }
}

/// A room that is open to the camera, with an emitter under its ceiling and a box.
Scene allocate(const Material& box, const Material& floor = test::white(0.6f), bool has_emitter = true) {
    Scene scene;
    const Material red = {{.base_color = {0.7f, 0.2f, 0.2f}}, "red"};
    test::add(scene, test::sheet({0, 0, 0}, {0, 0, 1}, {1, 0, 0}), floor);
    test::add(scene, test::sheet({0, 1, -1}, {1, 0, 0}, {0, 1, 0}), test::white(0.6f));
    test::add(scene, test::sheet({-1, 1, 0}, {0, 1, 0}, {0, 0, 1}), red);
    add_box(scene, {0.2f, 0.4f, 0.1f}, {0.35f, 0.35f, 0.35f}, box);
    if (!has_emitter) return scene;
    test::add(scene, test::sheet({0, 2, 0}, {1, 0, 0}, {0, 0, 1}), test::white(0.6f));
    test::add(scene, test::sheet({-0.2f, 1.9f, 0}, {0.6f, 0, 0}, {0, 0, 0.6f}),
              {{.base_color = {0.2f, 0.2f, 0.2f}, .emission = {4, 3.5f, 3}}, "lamp"});
    return scene;
}

Camera room_camera() {
    Camera camera;
    camera.world_from_camera = look_at({0.4f, 1.1f, 3.6f}, {0, 0.9f, 0}, {0, 1, 0});
    camera.fov_y = 0.6f;
    return camera;
}

Material plastic(float roughness) {
    return {{.kind = MaterialKind::MetallicRoughness, .base_color = {0.3f, 0.5f, 0.7f}, .roughness = roughness},
            "plastic"};
}
Material glass(float roughness = 0) {
    return {{.kind = MaterialKind::Dielectric, .base_color = {1, 1, 1}, .roughness = roughness}, "glass"};
}

struct Case {
    std::string name;
    Scene scene;
    Camera camera = room_camera();
    bool light_finds_all = true;
    bool light_is_even = true; // otherwise few particles contribute most of the light, and Student's t does not apply
    PixelFilter filter = PixelFilter::BlackmanHarris;
    float filter_radius = 0; // the filter's default
    uint32_t pixels = 12;    // across

    /// Takes `samples` samples per pixel of 12x12 pixels, and proportionally more for fewer pixels.
    uint32_t samples_for(uint32_t samples) const { return samples * (144 / (pixels * pixels)); }
};

std::vector<Case> cases() {
    std::vector<Case> all;
    all.push_back({.name = "diffuse", .scene = allocate(test::white(0.8f))});

    Material metal = {
        {.kind = MaterialKind::MetallicRoughness, .base_color = {0.9f, 0.8f, 0.6f}, .metallic = 1, .roughness = 0.45f},
        "metal"};
    all.push_back({.name = "glossy", .scene = allocate(metal, plastic(0.5f)), .filter = PixelFilter::Gaussian});

    // Uses a box filter. In the tail of another filter particles of pixels beside the glass count, and paths are very
    // rare.
    all.push_back({.name = "glass", .scene = allocate(glass()), .light_finds_all = false, .filter = PixelFilter::Box});

    all.push_back(
        {.name = "frosted glass", .scene = allocate(glass(0.4f)), .light_is_even = false, .filter = PixelFilter::Box});

    // Room and camera are inside glass, and the light comes from outside: radiance is scaled by the square of the
    // index.
    Case within = {.name = "within glass", .scene = allocate(plastic(0.6f), test::white(0.6f), false)};
    within.scene.environment = test::make_mixed_scene().environment;
    add_box(within.scene, {0, 1, 0.5f}, {2, 2, 2}, glass());
    within.camera.world_from_camera = look_at({0.4f, 1.1f, 2}, {0, 0.7f, 0}, {0, 1, 0});
    within.light_finds_all = false;
    within.filter = PixelFilter::Box;
    within.light_is_even = false;
    within.pixels = 6;
    all.push_back(within);

    Case delta = {.name = "delta lights", .scene = allocate(plastic(0.6f), test::white(0.6f), false)};
    delta.filter = PixelFilter::Tent;
    delta.scene.lights = test::make_mixed_scene().lights;
    delta.scene.lights[0].position = {0.6f, 1.5f, 0.8f};
    delta.scene.lights[0].range = 3;
    delta.scene.lights[1].position = {1, 2.5f, 1};
    delta.scene.lights[1].direction = normalize(Vec3{-1, -2, -1});
    all.push_back(delta);

    Case environment = {.name = "environment", .scene = allocate(metal, test::white(0.6f), false)};
    environment.scene.environment = test::make_mixed_scene().environment;
    environment.scene.materials[1].alpha = 0.5f; // the wall behind is visible in half of the samples
    environment.scene.materials[1].alpha_mode = AlphaMode::Blend;
    environment.camera.projection = Projection::Orthographic;
    environment.camera.ortho_height = 2.4f;
    environment.filter = PixelFilter::Box;
    environment.filter_radius = 0.8f;
    all.push_back(environment);

    Case lens = {.name = "depth of field", .scene = allocate(test::white(0.8f))};
    // The camera sees through its back, which blocks light.
    test::add(lens.scene, test::sheet({-0.3f, 0.5f, 0.8f}, {-0.3f, 0, 0}, {0, 0.3f, 0}), test::white(0.7f));
    lens.scene.materials.back().double_sided = false;
    lens.camera.aperture_radius = 0.2f;
    lens.camera.focus_distance = 3.4f;
    all.push_back(lens);
    return all;
}

RenderSettings settings_of(const Case& c) {
    RenderSettings settings;
    settings.width = settings.height = c.pixels;
    settings.filter = c.filter;
    settings.filter_radius = c.filter_radius;
    settings.path.max_depth = 5;
    return settings;
}

} // namespace

TEST_CASE(
    "bidirectional path tracing and light tracing give the path tracer's picture where they find the same light") {
    Queue queue = test::requested_queue();
    for (const Case& c : cases()) {
        CAPTURE(c.name);
        Messages messages;
        const PreparedScene prepared = prepare_scene(c.scene, {}, messages);
        const auto estimate = [&](IntegratorKind integrator, uint32_t samples, uint32_t first_seed) {
            RenderSettings settings = settings_of(c);
            settings.integrator = integrator;
            settings.samples = c.samples_for(samples);
            return test::estimate_picture(queue, prepared, c.camera, settings, 24, first_seed);
        };
        const test::PictureEstimate path = estimate(IntegratorKind::Path, 32, 1000);
        const test::PictureEstimate both = estimate(IntegratorKind::Bidirectional, 8, 1);
        CHECK(test::p_value(both, path) > 0.001);
        CHECK(test::p_value(test::brightened(both, 1.07, 5e-3), path) < 1e-4); // the test detects a difference
        if (!c.light_is_even) continue;
        const test::PictureEstimate light = estimate(IntegratorKind::Light, 16, 5000);
        const double same = test::p_value(light, path);
        if (c.light_finds_all) {
            CHECK(same > 0.001);
            CHECK(test::p_value(test::brightened(light, 1.1, 5e-3), path) < 1e-3);
        } else { // light that connects to the camera, scattered by a surface or emitted
            CHECK(same < 1e-6);
            RenderSettings settings = settings_of(c);
            settings.samples = c.samples_for(32);
            settings.light_paths = std::make_shared<const LightPathLayers>(
                bind_to_scene({parse_light_path("connected=LE|L.*[DG]E")}, c.scene));
            const test::PictureEstimate connected =
                test::estimate_picture(queue, prepared, c.camera, settings, 24, 2000);
            CHECK(test::p_value(light, connected) > 0.001);
            CHECK(test::p_value(test::brightened(light, 1.1, 5e-3), connected) < 1e-3);
        }
    }
}

TEST_CASE("distributed ray tracing gives its light paths the brightness that path tracing gives them") {
    Queue queue = test::requested_queue();
    for (const Case& c : cases()) {
        if (c.name == "within glass") continue; // only light from the sky is traced
        CAPTURE(c.name);
        Messages messages;
        const PreparedScene prepared = prepare_scene(c.scene, {}, messages);
        RenderSettings settings = settings_of(c);
        settings.samples = 16;
        settings.light_paths = std::make_shared<const LightPathLayers>(
            bind_to_scene({parse_light_path("followed=L.?[GS]*E")}, c.scene)); // integrators/distributed/distributed.h
        const test::PictureEstimate path = test::estimate_picture(queue, prepared, c.camera, settings, 24, 1000);
        settings.light_paths = nullptr;
        const test::PictureEstimate all = test::estimate_picture(queue, prepared, c.camera, settings, 24, 500);
        settings.integrator = IntegratorKind::Distributed;
        const test::PictureEstimate distributed = test::estimate_picture(queue, prepared, c.camera, settings, 24, 1);
        CHECK(test::p_value(distributed, path) > 0.001);
        CHECK(test::p_value(test::brightened(distributed, 1.05, 5e-3), path) < 1e-4); // the test detects a difference
        CHECK(test::p_value(distributed, all) < 1e-4); // the path tracer finds more light
    }
}

TEST_CASE("light tracing and bidirectional path tracing match the closed form of a floor under an area light to 1 %") {
    constexpr double kHalf = 1; // half the side of the visible part of the floor, metres
    Queue queue = test::requested_queue();
    const auto mean_of = [&](const Mesh& emitter, IntegratorKind integrator, uint32_t samples) {
        Scene scene;
        test::add(scene, test::floor_at(0, 50), test::white(1));
        test::add(scene, emitter, {{.base_color = {0, 0, 0}, .emission = {4, 4, 4}}, "lamp"});
        RenderSettings settings;
        settings.width = settings.height = 32;
        settings.samples = samples;
        settings.filter = PixelFilter::Box;
        settings.integrator = integrator;
        const Camera camera = test::camera_down({0.4f, 0.1f, 0.2f}, 2 * float(kHalf));
        return test::mean_of(test::render(queue, scene, camera, settings).picture);
    };
    const auto over_patch = [&](const auto& factor) { // uses Simpson's rule in both directions
        double sum = 0;
        constexpr int kWeights[] = {1, 4, 2, 4, 2, 4, 2, 4, 1};
        for (int i = 0; i < 9; ++i) {
            for (int j = 0; j < 9; ++j) {
                sum += kWeights[i] * kWeights[j] * factor(0.4 + kHalf * (i - 4) / 4, 0.2 + kHalf * (j - 4) / 4);
            }
        }
        return sum / (24 * 24);
    };
    const Mesh rectangle = test::sheet({0, 2, 0}, {1.5f, 0, 0}, {0, 0, 1}), disc = test::disc(1.5f, 1);
    const double under_rectangle =
        4 * over_patch([](double x, double z) { return test::rectangle_factor(1.5, 1, 2, x, z); });
    const double under_disc =
        4 * over_patch([](double x, double z) { return test::disc_factor(1, 1.5, std::sqrt(x * x + z * z)); });
    for (const auto& [integrator, samples] :
         {std::pair(IntegratorKind::Light, 256u), std::pair(IntegratorKind::Bidirectional, 64u)}) {
        CHECK(mean_of(rectangle, integrator, samples) == doctest::Approx(under_rectangle).epsilon(0.01));
        CHECK(mean_of(disc, integrator, samples) == doctest::Approx(under_disc).epsilon(0.01));
    }
}
