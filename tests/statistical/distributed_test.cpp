// Distributed ray tracing against closed forms, and against path tracing where both find the same light.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "tests/support/compare_pictures.h"
#include "tests/support/flat_emitters.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/meshes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

RenderSettings distributed_settings(uint32_t side, uint32_t samples) {
    RenderSettings settings;
    settings.width = settings.height = side;
    settings.samples = samples;
    settings.filter = PixelFilter::Box;
    settings.integrator = IntegratorKind::Distributed;
    return settings;
}

/// A flat emitter that faces down over a white floor, and the floor's radiosity seen from just above.
double floor_radiance(const Mesh& emitter, Vec3 at) {
    Scene scene;
    test::add(scene, test::floor_at(0, 50), test::white(1));
    test::add(scene, emitter, {{.base_color = {0, 0, 0}, .emission = {4, 4, 4}}, "lamp"});
    Queue queue = test::requested_queue();
    const RenderResult result =
        test::render(queue, scene, test::camera_down(at + Vec3{0, 0.1f, 0}, 1e-3f), distributed_settings(1, 1024));
    CHECK(result.rays.bounce == 0);
    return static_cast<double>(result.picture.at(0, 0)[0]);
}

} // namespace

TEST_CASE("irradiance under a rectangular light matches the closed form") {
    const Mesh emitter = test::sheet({0, 2, 0}, {1.5f, 0, 0}, {0, 0, 1});
    CHECK(floor_radiance(emitter, {0, 0, 0}) == doctest::Approx(4 * 4 * test::corner_factor(0.75, 0.5)).epsilon(2e-3));
    CHECK(floor_radiance(emitter, {1.5f, 0, 1}) == doctest::Approx(4 * test::corner_factor(1.5, 1)).epsilon(2e-3));
}

TEST_CASE("irradiance under a disc light matches the closed form") {
    CHECK(floor_radiance(test::disc(2, 1), {0, 0, 0}) == doctest::Approx(4.0 / (1 + 4)).epsilon(2e-3));
    CHECK(floor_radiance(test::disc(0.5f, 1), {0, 0, 0}) == doctest::Approx(4.0 / (1 + 0.25)).epsilon(2e-3));
}

namespace {

/// The mixed scene, in which each diffuse surface becomes a metal.
Scene make_metal_scene() {
    Scene scene = test::make_mixed_scene();
    for (Material& material : scene.materials) {
        const bool stays = material.kind == MaterialKind::Dielectric || material.kind == MaterialKind::Conductor ||
                           material.is_emissive();
        if (stays) continue;
        material.metallic = 1;
        material.roughness = material.kind == MaterialKind::MetallicRoughness ? 0.6f : 0.0f;
        material.kind = MaterialKind::MetallicRoughness;
    }
    scene.materials[0].roughness = 0.7f; // the floor
    return scene;
}

/// A single diffuse or plastic sphere, to which no scattered light returns, under a point light, a spot, a sun and a
/// sky.
Scene make_convex_scene(bool is_glossy) {
    Scene scene = test::make_furnace_scene(0.7f);
    const Scene mixed = test::make_mixed_scene();
    scene.environment = mixed.environment;
    scene.lights = mixed.lights;
    if (!is_glossy) return scene;
    scene.materials[0].kind = MaterialKind::MetallicRoughness;
    scene.materials[0].roughness = 0.3f;
    return scene;
}

/// The p-values of distributed against path, and of distributed made 5 % brighter.
std::pair<double, double> compare_with_path(const Scene& scene, float aperture, uint32_t samples) {
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = test::requested_queue();
    Camera camera = test::mixed_scene_camera();
    camera.aperture_radius = aperture;
    camera.focus_distance = 5;
    RenderSettings settings = distributed_settings(14, samples);
    settings.path.max_depth = 5;
    const auto estimate = [&](IntegratorKind integrator, uint32_t first_seed) {
        settings.integrator = integrator;
        return test::estimate_picture(queue, prepared, camera, settings, 32, first_seed);
    };
    const test::PictureEstimate distributed = estimate(IntegratorKind::Distributed, 1);
    const test::PictureEstimate path = estimate(IntegratorKind::Path, 1000);
    return {test::p_value(distributed, path), test::p_value(test::brightened(distributed, 1.05, 5e-3), path)};
}

} // namespace

TEST_CASE("distributed ray tracing equals path tracing where no diffuse surface lights another") {
    for (const auto& [scene, aperture, samples] :
         {std::tuple(make_metal_scene(), 0.0f, 32u), std::tuple(make_convex_scene(false), 0.3f, 8u),
          std::tuple(make_convex_scene(true), 0.0f, 16u)}) {
        const auto [same, brighter] = compare_with_path(scene, aperture, samples);
        CHECK(same > 0.001);
        CHECK(brighter < 1e-4); // the test can see
    }
}

TEST_CASE("distributed ray tracing misses only interreflection between diffuse surfaces") {
    const Scene scene = test::make_mixed_scene();
    Queue queue = test::requested_queue();
    RenderSettings settings = distributed_settings(24, 32);
    const auto mean_of = [&](const Scene& lit, IntegratorKind integrator) {
        settings.integrator = integrator;
        const RenderResult result = test::render(queue, lit, test::mixed_scene_camera(), settings);
        double sum = 0;
        for (const float value : result.picture.pixels) sum += static_cast<double>(value);
        return sum / static_cast<double>(result.picture.pixels.size());
    };
    const double path = mean_of(scene, IntegratorKind::Path), less = mean_of(scene, IntegratorKind::Distributed);
    CHECK(less < 0.99 * path);
    CHECK(less > 0.7 * path);
}

// The thin lens equation is 1 / f = 1 / o + 1 / i for an object at distance o and its image at i behind the lens.
TEST_CASE("a lens is sharp at its focus distance and blurs other points over their circle of confusion") {
    constexpr uint32_t kSide = 33; // the emitter is at the centre of a pixel
    constexpr float kFocus = 4, kAperture = 0.6f;
    Camera camera;
    camera.fov_y = 2 * 0.24497866f; // the height of the view is half of its distance
    camera.aperture_radius = kAperture;
    camera.focus_distance = kFocus;
    // The lens has this focal length, and the film is at the image of the plane in focus.
    constexpr double kFocalLength = 0.5;
    const auto image_of = [](double object) { return 1 / (1 / kFocalLength - 1 / object); };
    const double film = image_of(static_cast<double>(kFocus));
    const double pixels_a_metre = kSide / (0.5 * film); // on the film
    for (const auto& [integrator, distance] : {std::pair(IntegratorKind::Distributed, 4.0f),
                                               {IntegratorKind::Distributed, 3.0f},
                                               {IntegratorKind::Distributed, 8.0f},
                                               {IntegratorKind::Path, 4.0f},
                                               {IntegratorKind::Path, 3.0f},
                                               {IntegratorKind::Path, 8.0f}}) {
        CAPTURE(static_cast<int>(integrator));
        CAPTURE(distance);
        Scene scene;
        const float half = 0.007f * distance; // almost a pixel wide
        test::add(scene, test::sheet({0, 0, -distance}, {half, 0, 0}, {0, half, 0}),
                  {{.base_color = {0, 0, 0}, .emission = {1000, 1000, 1000}}, "lamp"});
        Queue queue = test::requested_queue();
        RenderSettings settings = distributed_settings(kSide, 256);
        settings.integrator = integrator;
        const RenderResult result = test::render(queue, scene, camera, settings);
        // The emitter's light passes through the whole lens to its image before or behind the film. A width of A at
        // the lens is A |film - image| / image on the film.
        const double image = image_of(static_cast<double>(distance));
        const double radius = static_cast<double>(kAperture) * std::abs(film - image) / image * pixels_a_metre;
        double sum = 0, squares = 0, farthest = 0;
        for (uint32_t y = 0; y < kSide; ++y) {
            for (uint32_t x = 0; x < kSide; ++x) {
                const double value = static_cast<double>(result.picture.at(x, y)[0]);
                const double r = std::hypot(x - 16.0, y - 16.0);
                sum += value;
                squares += value * r * r;
                if (value > 0) farthest = std::max(farthest, r);
            }
        }
        CHECK(sum > 0);
        CHECK(farthest < radius + 1.5); // half of the pixel's diagonal, and of the emitter's
        CHECK(farthest > radius - 1.5);
        if (distance == kFocus) {
            CHECK(farthest == 0);
        } else { // the mean square of a uniform disc is r^2 / 2, of pixel and emitter about 1/6 each
            CHECK(squares / sum == doctest::Approx(radius * radius / 2 + 1.0 / 3).epsilon(0.15));
        }
    }
}
