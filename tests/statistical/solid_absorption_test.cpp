// Solids that absorb by distance (device_scene/solid_absorption.h): closed forms in every integrator that follows
// glass, and a comparison of integrators that go both ways.

#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "tests/support/compare_pictures.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

constexpr Rgb kColor = {0.2f, 0.5f, 0.9f};
constexpr float kDepth = 0.8f; // metres

/// A block that does not refract and absorbs.
Material absorbing(float ior = 1) {
    Material material = {{.kind = MaterialKind::Dielectric, .base_color = {1, 1, 1}, .roughness = 0, .ior = ior},
                         "block"};
    material.transmission_color = kColor;
    material.transmission_depth = kDepth;
    return material;
}

/// The six sheets of a block with their fronts outwards.
void add_block(Scene& scene, Vec3 centre, Vec3 half, const Material& material) {
    const Vec3 x = {half.x, 0, 0}, y = {0, half.y, 0}, z = {0, 0, half.z};
    for (const float side : {1.0f, -1.0f}) {
        test::add(scene, test::sheet(centre + side * x, side * y, z), material);
        test::add(scene, test::sheet(centre + side * y, side * z, x), material);
        test::add(scene, test::sheet(centre + side * z, side * x, y), material);
    }
}

Scene under_white_sky() {
    Scene scene = test::make_furnace_scene(0);
    scene.meshes.clear();
    scene.instances.clear();
    scene.materials.clear();
    return scene;
}

RenderSettings settings_of(IntegratorKind integrator) {
    RenderSettings settings;
    settings.width = settings.height = 4;
    settings.samples = 4;
    settings.integrator = integrator;
    settings.path.max_depth = 8;
    settings.path.roulette_depth = 100;
    return settings;
}

void check_all_pixels(const Scene& scene, const Camera& camera, float distance, double factor = 1) {
    Queue queue = test::requested_queue();
    for (const IntegratorKind integrator :
         {IntegratorKind::Path, IntegratorKind::Bidirectional, IntegratorKind::PhotonMap,
          IntegratorKind::IrradianceCache, IntegratorKind::Whitted, IntegratorKind::Distributed}) {
        CAPTURE(describe(integrator).name);
        const double depths = static_cast<double>(distance / kDepth);
        for (const PathBody body : {PathBody::Loop, PathBody::Wavefront}) {
            RenderSettings settings = settings_of(integrator);
            settings.body = body;
            const RenderResult result = test::render(queue, scene, camera, settings);
            for (std::size_t i = 0; i < result.picture.pixels.size(); i += 3) {
                CHECK(result.picture.pixels[i] == doctest::Approx(factor * std::pow(0.2, depths)).epsilon(2e-3));
                CHECK(result.picture.pixels[i + 1] == doctest::Approx(factor * std::pow(0.5, depths)).epsilon(2e-3));
                CHECK(result.picture.pixels[i + 2] == doctest::Approx(factor * std::pow(0.9, depths)).epsilon(2e-3));
            }
        }
    }
}

} // namespace

TEST_CASE("light through a block is absorbed by its thickness, whichever integrator follows it") {
    Scene scene = under_white_sky();
    add_block(scene, {0, 0, 0}, {1, 0.6f, 1}, absorbing());
    check_all_pixels(scene, test::camera_down({0, 3, 0}, 0.5f), 1.2f);
    // A second one behind it: the air between absorbs nothing.
    add_block(scene, {0, -2, 0}, {1, 0.2f, 1}, absorbing());
    check_all_pixels(scene, test::camera_down({0, 3, 0}, 0.5f), 1.6f);
}

TEST_CASE("a camera within a block sees light absorbed from there on") {
    Scene scene = under_white_sky();
    add_block(scene, {0, 0, 0}, {1, 0.6f, 1}, absorbing());
    check_all_pixels(scene, test::camera_down({0, 0.1f, 0}, 0.5f), 0.7f);
}

TEST_CASE("a block absorbs the light of an object within it from there on, although the object is no solid") {
    Scene scene = under_white_sky();
    add_block(scene, {0, 0, 0}, {1, 0.6f, 1}, absorbing());
    Material unlit = test::white();
    unlit.kind = MaterialKind::Unlit;
    unlit.base_color = {1, 1, 1};
    test::add(scene, test::floor_at(0.3f, 0.5f), unlit);
    check_all_pixels(scene, test::camera_down({0, 3, 0}, 0.5f), 0.3f);
}

TEST_CASE("of two blocks that overlap, the first one absorbs") {
    Scene scene = under_white_sky();
    Material other = absorbing();
    other.transmission_color = {1, 1, 1};
    add_block(scene, {0, 0.3f, 0}, {1, 0.3f, 1}, absorbing()); // from 0 to 0.6
    add_block(scene, {0, 0, 0}, {2, 0.3f, 2}, other);          // from -0.3 to 0.3
    // 0.3 alone, then 0.3 from the second's top to the first's bottom; then the second alone, which is clear.
    check_all_pixels(scene, test::camera_down({0, 3, 0}, 0.5f), 0.6f);
}

TEST_CASE("paths, particles and connections agree about a diffuse object and an emitter within rough absorbing glass") {
    Scene scene;
    test::add(scene, test::floor_at(-0.8f, 2), test::white(0.6f));
    Material glass = absorbing(1.3f);
    glass.roughness = 0.7f;
    add_block(scene, {0, 0, 0}, {0.7f, 0.6f, 0.7f}, glass);
    test::add(scene, test::sheet({0, -0.3f, 0}, {0, 0, 0.4f}, {0.4f, 0, 0}),
              {{.base_color = {0.8f, 0.8f, 0.8f}}, "thing"});
    test::add(scene, test::sheet({0, 0.25f, 0}, {0.3f, 0, 0}, {0, 0, 0.3f}),
              {{.base_color = {0.2f, 0.2f, 0.2f}, .emission = {4, 4, 4}}, "lamp"});
    test::add(scene, test::sheet({0.3f, 1.5f, 0}, {0.6f, 0, 0}, {0, 0, 0.6f}),
              {{.base_color = {0.2f, 0.2f, 0.2f}, .emission = {3, 3, 3}}, "lamp"});
    Camera camera;
    camera.world_from_camera = look_at({1.5f, 1, 3.2f}, {0, -0.1f, 0}, {0, 1, 0});
    camera.fov_y = 0.6f;
    Queue queue = test::requested_queue();
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    const auto estimate = [&](IntegratorKind integrator, uint32_t samples, uint32_t first_seed) {
        RenderSettings settings;
        settings.width = settings.height = 6;
        settings.filter = PixelFilter::Box;
        settings.path.max_depth = 6;
        settings.integrator = integrator;
        settings.samples = samples;
        return test::estimate_picture(queue, prepared, camera, settings, 24, first_seed);
    };
    const test::PictureEstimate path = estimate(IntegratorKind::Path, 256, 1000);
    const test::PictureEstimate both = estimate(IntegratorKind::Bidirectional, 64, 1);
    CHECK(test::p_value(both, path) > 0.001);
    CHECK(test::p_value(test::brightened(both, 1.07, 5e-3), path) < 1e-4);
}
