// Solids in each other (device_scene/nested_solids.h): what vanishes, what a bubble looks like, what absorbs, where
// the camera is inside, and that each schedule renders the same bytes.

#include <doctest/doctest.h>

#include <cmath>

#include "device_scene/close_gaps.h"
#include "tests/support/compare_pictures.h"
#include "tests/support/options.h"
#include "tests/support/solid_scenes.h"

using namespace pertev;

namespace {

constexpr Rgb kWaterColor = {0.2f, 0.5f, 0.9f};
constexpr float kWaterDepth = 0.8f; // metres

/// A solid that absorbs and does not refract in a vacuum.
Material dimming_solid(float ior = 1) {
    Material material = test::glass(ior);
    material.transmission_color = kWaterColor;
    material.transmission_depth = kWaterDepth;
    return material;
}

RenderSettings settings_among_solids(IntegratorKind integrator, uint32_t size = 4) {
    RenderSettings settings;
    settings.width = settings.height = size;
    settings.samples = 4;
    settings.integrator = integrator;
    settings.path.max_depth = 12;
    settings.path.roulette_depth = 100;
    return settings;
}

/// Checks that the light of a white sky is absorbed over `distance` metres, by integrators that follow glass.
void check_absorbed(const Scene& scene, const Camera& camera, float distance) {
    Queue queue = test::requested_queue();
    for (const IntegratorKind integrator :
         {IntegratorKind::Path, IntegratorKind::Whitted, IntegratorKind::Distributed}) {
        CAPTURE(describe(integrator).name);
        const RenderResult result = test::render(queue, scene, camera, settings_among_solids(integrator));
        const double depths = static_cast<double>(distance / kWaterDepth);
        for (std::size_t i = 0; i < result.picture.pixels.size(); i += 3) {
            CHECK(result.picture.pixels[i] == doctest::Approx(std::pow(0.2, depths)).epsilon(2e-3));
            CHECK(result.picture.pixels[i + 1] == doctest::Approx(std::pow(0.5, depths)).epsilon(2e-3));
            CHECK(result.picture.pixels[i + 2] == doctest::Approx(std::pow(0.9, depths)).epsilon(2e-3));
        }
    }
}

/// A sky that differs by direction.
Scene under_panorama() {
    Scene scene;
    scene.environment = test::make_mixed_scene().environment;
    return scene;
}
Camera ball_camera() {
    Camera camera;
    camera.world_from_camera = look_at({0.4f, 1.1f, 3.6f}, {0, 0, 0}, {0, 1, 0});
    camera.fov_y = 0.6f;
    return camera;
}

/// Renders by Whitted's algorithm, which follows both ways at each interface and thus has no noise of its own.
Image whitted_picture(const Scene& scene) {
    Queue queue = test::requested_queue();
    RenderSettings settings = settings_among_solids(IntegratorKind::Whitted, 16);
    settings.path.max_depth = 64; // surfaces that vanish count, too
    return test::render(queue, scene, ball_camera(), settings).picture;
}
double share_of_difference(const Image& a, const Image& b) {
    double sum = 0, all = 0;
    REQUIRE(a.pixels.size() == b.pixels.size());
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        sum += std::abs(static_cast<double>(a.pixels[i]) - static_cast<double>(b.pixels[i]));
        all += static_cast<double>(a.pixels[i]);
    }
    return sum / all;
}

/// Returns the surface with its front inwards.
Mesh turned_inside_out(Mesh mesh) {
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
    return mesh;
}

Scene glass_ball(float ior) {
    Scene scene = under_panorama();
    test::add(scene, test::ball({0, 0, 0}, 1), test::glass(ior));
    return scene;
}

} // namespace

TEST_CASE("glass in glass of one index vanishes") {
    const Image alone = whitted_picture(glass_ball(1.5f));
    Scene scene = glass_ball(1.5f);
    test::add(scene, test::ball({0.1f, 0, 0}, 0.6f), test::glass(1.5f));
    CHECK(share_of_difference(alone, whitted_picture(scene)) < 1e-3);
    scene.materials[1].ior = 1.4f;
    CHECK(share_of_difference(alone, whitted_picture(scene)) > 1e-2);
    scene.materials[0].priority = 1; // the outer one fills the inner one, too
    CHECK(share_of_difference(alone, whitted_picture(scene)) < 1e-3);
}

TEST_CASE("a ball of air in glass is as a bubble whose surface is the glass's own") {
    Scene nested = glass_ball(1.5f), hollow = glass_ball(1.5f);
    test::add(nested, test::ball({0.1f, 0, 0}, 0.6f), test::glass(1));
    Mesh& outer = hollow.meshes[0];
    const Mesh inner = turned_inside_out(test::ball({0.1f, 0, 0}, 0.6f));
    const auto first = static_cast<uint32_t>(outer.positions.size());
    outer.positions.insert(outer.positions.end(), inner.positions.begin(), inner.positions.end());
    for (const uint32_t index : inner.indices) outer.indices.push_back(first + index);
    CHECK(share_of_difference(whitted_picture(hollow), whitted_picture(nested)) < 1e-3);
}

TEST_CASE("an index over that of what surrounds a solid counts as it is, in a vacuum and in glass") {
    // Alone, the bubble is a ball of glass whose front is inwards.
    Scene bubble = glass_ball(1 / 1.5f), turned = glass_ball(1.5f);
    turned.meshes[0] = turned_inside_out(turned.meshes[0]);
    CHECK(share_of_difference(whitted_picture(turned), whitted_picture(bubble)) < 1e-3);
    for (const float ior : {1.0f, 1.8f}) {
        Scene stated = glass_ball(1.5f), relative = glass_ball(1.5f);
        test::add(stated, test::ball({0.1f, 0, 0}, 0.6f), test::glass(ior));
        test::add(relative, test::ball({0.1f, 0, 0}, 0.6f), test::glass(ior / 1.5f));
        CHECK(share_of_difference(whitted_picture(stated), whitted_picture(relative)) > 1e-2);
        relative.materials[1].has_relative_ior = true;
        CHECK(share_of_difference(whitted_picture(stated), whitted_picture(relative)) < 1e-3);
        for (Scene* scene : {&stated, &relative}) test::add(*scene, test::ball({0.15f, 0, 0}, 0.4f), test::glass(1.7f));
        CHECK(share_of_difference(whitted_picture(stated), whitted_picture(relative)) < 1e-3);
    }
}

TEST_CASE("glass in a hollow of glass vanishes, whether it touches or leaves a small gap") {
    Scene block = under_panorama();
    test::add(block, test::box({0, 0, 0}, {1, 1, 1}), test::glass(1.5f));
    const Image alone = whitted_picture(block);
    Mesh& outer = block.meshes[0];
    const Mesh hollow = turned_inside_out(test::box({0.1f, 0.1f, 0}, {0.5f, 0.6f, 0.4f}));
    for (const uint32_t index : hollow.indices) outer.indices.push_back(8 + index);
    outer.positions.insert(outer.positions.end(), hollow.positions.begin(), hollow.positions.end());
    for (const float gap : {0.0f, 5e-5f}) {
        Scene filled = block;
        test::add(filled, test::box({0.1f, 0.1f, 0}, {0.5f - gap, 0.6f - gap, 0.4f - gap}), test::glass(1.5f));
        CHECK(share_of_difference(alone, whitted_picture(filled)) > 1e-2);
        CHECK(close_gaps(filled) == 1);
        CHECK(share_of_difference(alone, whitted_picture(filled)) < 1e-3);
    }
}

TEST_CASE("paths and trees of rays agree about water and air in rough glass") {
    Scene scene = under_panorama();
    Material rough = dimming_solid(1.5f);
    rough.roughness = 0.4f;
    test::add(scene, test::ball({0, 0, 0}, 1), rough);
    test::add(scene, test::ball({0.2f, 0, 0.3f}, 0.5f), test::glass(1.33f));
    test::add(scene, test::ball({0.3f, 0, 0.3f}, 0.2f), test::glass(1));
    Queue queue = test::requested_queue();
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    const auto estimate = [&](IntegratorKind integrator, LightStrategy strategy, uint32_t seed) {
        RenderSettings settings = settings_among_solids(integrator, 6);
        settings.filter = PixelFilter::Box;
        settings.path.strategy = strategy;
        settings.path.max_depth = 8;
        settings.samples = 128;
        return test::estimate_picture(queue, prepared, ball_camera(), settings, 24, seed);
    };
    const test::PictureEstimate path = estimate(IntegratorKind::Path, LightStrategy::Mis, 1000);
    CHECK(test::p_value(estimate(IntegratorKind::Path, LightStrategy::BsdfOnly, 1), path) > 0.001);
    CHECK(test::p_value(estimate(IntegratorKind::Distributed, LightStrategy::Mis, 2000), path) > 0.001);
}

TEST_CASE("the innermost solid absorbs, and the outer one between two inner ones") {
    Scene scene = test::under_sky();
    test::add(scene, test::box({0, 0, 0}, {1, 0.6f, 1}), dimming_solid());
    test::add(scene, test::box({0, 0.3f, 0}, {0.8f, 0.1f, 0.8f}), test::glass(1));
    test::add(scene, test::box({0, -0.3f, 0}, {0.8f, 0.1f, 0.8f}), test::glass(1));
    check_absorbed(scene, test::camera_down({0, 3, 0}, 0.5f), 0.8f);
    scene.materials[1] = dimming_solid();
    check_absorbed(scene, test::camera_down({0, 3, 0}, 0.5f), 1);
}

TEST_CASE("both solids absorb the light of an object in the inner one from there on") {
    Scene scene = test::under_sky();
    test::add(scene, test::box({0, 0, 0}, {1, 0.6f, 1}), dimming_solid());
    test::add(scene, test::box({0, 0, 0}, {0.8f, 0.3f, 0.8f}), test::glass(1));
    Material unlit = test::white();
    unlit.kind = MaterialKind::Unlit;
    test::add(scene, test::floor_at(0.1f, 0.5f), unlit);
    check_absorbed(scene, test::camera_down({0, 3, 0}, 0.5f), 0.3f);
}

TEST_CASE("of two solids that overlap the first one wins, unless the other has priority") {
    Scene scene = test::under_sky();
    Material clear = test::glass(1);
    test::add(scene, test::box({0, 0.3f, 0}, {1, 0.3f, 1}), dimming_solid()); // from 0 to 0.6
    test::add(scene, test::box({0, 0, 0}, {2, 0.3f, 2}), clear);              // from -0.3 to 0.3
    check_absorbed(scene, test::camera_down({0, 3, 0}, 0.5f), 0.6f);
    scene.materials[1].priority = 1;
    check_absorbed(scene, test::camera_down({0, 3, 0}, 0.5f), 0.3f);
}

TEST_CASE("a camera inside a solid, and inside one in another, knows it") {
    Scene scene = test::under_sky();
    test::add(scene, test::box({0, 0, 0}, {1, 0.6f, 1}), dimming_solid());
    test::add(scene, test::box({0, -0.1f, 0}, {0.8f, 0.3f, 0.8f}), test::glass(1)); // from -0.4 to 0.2
    check_absorbed(scene, test::camera_down({0, 0.5f, 0}, 0.5f), 0.5f);
    check_absorbed(scene, test::camera_down({0, 0.1f, 0}, 0.5f), 0.2f);
    // Beneath what wins there is no interface.
    scene.materials[0].priority = 1;
    check_absorbed(scene, test::camera_down({0, 0.5f, 0}, 0.5f), 1.1f);
}

TEST_CASE("the solids between a surface and an emitter point in glass absorb its light") {
    Scene scene;
    test::add(scene, test::box({0, 0, 0}, {1, 0.6f, 1}), dimming_solid());
    test::add(scene, test::box({0, 0, 0}, {0.9f, 0.5f, 0.9f}), dimming_solid());
    scene.materials[1].transmission_depth = 2 * kWaterDepth;
    test::add(scene, test::floor_at(-0.2f, 0.6f), test::white(0.8f));
    test::add(scene, test::sheet({0, 0.3f, 0}, {0.3f, 0, 0}, {0, 0, 0.3f}),
              {{.base_color = {0, 0, 0}, .emission = {4, 4, 4}}, "lamp"});
    Queue queue = test::requested_queue();
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Camera camera;
    camera.world_from_camera = look_at({0, 0.1f, 0.5f}, {0, -0.2f, 0}, {0, 1, 0});
    camera.fov_y = 0.8f;
    const auto estimate = [&](IntegratorKind integrator, LightStrategy strategy, uint32_t seed) {
        RenderSettings settings = settings_among_solids(integrator, 4);
        settings.filter = PixelFilter::Box;
        settings.path.strategy = strategy;
        settings.path.max_depth = 1;
        settings.samples = 256;
        return test::estimate_picture(queue, prepared, camera, settings, 24, seed);
    };
    const test::PictureEstimate path = estimate(IntegratorKind::Path, LightStrategy::NeeOnly, 1000);
    CHECK(test::p_value(estimate(IntegratorKind::Path, LightStrategy::BsdfOnly, 1), path) > 0.001);
    CHECK(test::p_value(estimate(IntegratorKind::Distributed, LightStrategy::Mis, 2000), path) > 0.001);
}

TEST_CASE("nested solids have the same bytes in a loop and in a wavefront") {
    Scene scene = under_panorama();
    Material rough = dimming_solid(1.5f);
    rough.roughness = 0.3f;
    test::add(scene, test::ball({0, 0, 0}, 1), rough);
    test::add(scene, test::ball({0.2f, 0, 0.3f}, 0.5f), test::glass(1.33f));
    test::add(scene, test::ball({0.3f, 0, 0.3f}, 0.2f), test::glass(1));
    Camera within = ball_camera();
    within.world_from_camera.translation = {0.3f, 0, 0.45f}; // in the air
    Queue queue = test::requested_queue();
    for (const IntegratorKind integrator :
         {IntegratorKind::Path, IntegratorKind::Whitted, IntegratorKind::Distributed}) {
        for (const Camera& camera : {ball_camera(), within}) {
            RenderSettings settings = settings_among_solids(integrator, 16);
            settings.body = PathBody::Loop;
            const Hash128 loop = test::render_hash(test::render(queue, scene, camera, settings));
            settings.body = PathBody::Wavefront;
            CHECK(test::render_hash(test::render(queue, scene, camera, settings)) == loop);
        }
    }
}
