// Every integrator that selects lights by a tree gives the same bytes by both schedules and on both devices, and the
// mean of its pictures by power with less noise.

#include <doctest/doctest.h>

#include <cmath>
#include <numeric>

#include "image/picture_hash.h"
#include "integrators/irradiance_cache/irradiance_cache_settings.h"
#include "integrators/photon_map/photon_map_settings.h"
#include "tests/support/compare_pictures.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/meshes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

/// A corridor of 24 m with a small emitter under its ceiling for each metre, and lights at its wall.
Scene make_corridor() {
    Scene scene;
    const Material plastic = {
        {.kind = MaterialKind::MetallicRoughness, .base_color = {0.6f, 0.5f, 0.4f}, .roughness = 0.4f}, "plastic"};
    test::add(scene, test::sheet({0, 0, 12}, {0, 0, 12}, {1, 0, 0}), plastic);
    test::add(scene, test::sheet({-1, 1, 12}, {0, 1, 0}, {0, 0, 12}), test::white(0.6f));
    test::add(scene, test::sheet({1, 1, 12}, {0, 0, 12}, {0, 1, 0}), test::white(0.6f));
    for (int i = 0; i < 24; ++i) {
        const float z = 0.5f + static_cast<float>(i), side = i % 2 == 0 ? 0.5f : -0.5f;
        test::add(scene, test::sheet({side, 1.9f, z}, {0.1f, 0, 0}, {0, 0, 0.1f}),
                  {{.base_color = {0.2f, 0.2f, 0.2f}, .emission = {9, 8, 7}}, "lamp"});
        if (i % 4 == 0) scene.lights.push_back(test::point_light({-side, 1.2f, z}, {0.1f, 0.15f, 0.2f}));
    }
    return scene;
}

Camera corridor_camera() {
    Camera camera;
    camera.world_from_camera = look_at({0, 1.4f, -0.2f}, {0, 0, 1.9f}, {0, 1, 0});
    camera.fov_y = 0.6f;
    return camera;
}

RenderSettings settings_for(IntegratorKind integrator, LightSelection choice) {
    RenderSettings settings;
    settings.width = 4, settings.height = 3; // many samples of few pixels, because those by power are uneven
    settings.samples = 40;
    settings.integrator = integrator;
    settings.path.max_depth = 3;
    settings.path.light_choice = choice;
    settings.photon_map.edit().photons = 500;
    settings.irradiance_cache.edit().hemisphere_rays = 64;
    return settings;
}

double sum_of(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

} // namespace

TEST_CASE("all integrators that select lights by a tree have the mean of those by power, with less noise") {
    Queue queue = test::requested_queue();
    Messages messages;
    const Scene scene = make_corridor();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    for (const IntegratorDescriptor& kind : integrators()) {
        const IntegratorKind integrator = kind.value;
        if (!kind.selects_lights || kind.makes_frames) continue; // path tracing: consistency/light_tree_test.cpp
        CAPTURE(kind.name);
        const auto estimate = [&](LightSelection choice, uint32_t first_seed) {
            RenderSettings settings = settings_for(integrator, choice);
            settings.path.sampler = SamplerKind::Independent;
            return test::estimate_picture(queue, prepared, corridor_camera(), settings, 24, first_seed);
        };
        const auto tree = estimate(LightSelection::Tree, 1), power = estimate(LightSelection::Power, 101);
        CHECK(test::p_value(tree, power) > 0.001);
        CHECK(test::p_value(test::brightened(tree, 1.15, 0), power) < 1e-3); // the test detects a difference
        CHECK(sum_of(power.variance_of_mean) > 1.7 * sum_of(tree.variance_of_mean));
    }
}

TEST_CASE("within a glowing sphere, light by a tree is that by power, however rays find it") {
    // Shadow rays and rays by the BSDF find each emitter. The receiver's normal decides how often the tree selects one:
    // weights that another density made would not add up to 1.
    Queue queue = test::requested_queue();
    Scene scene;
    const test::TriangleMesh sphere = test::make_sphere(2, {0, 0, 0}, 2);
    Mesh around;
    around.positions = sphere.positions, around.indices = sphere.indices;
    Material glow = {{.base_color = {0, 0, 0}, .emission = {1, 1, 1}}, "glow"};
    glow.two_sided_emission = true;
    test::add(scene, around, glow);
    test::add(scene, test::floor_at(0, 0.7f),
              {{.kind = MaterialKind::MetallicRoughness,
                .base_color = {0.6f, 0.5f, 0.4f},
                .metallic = 0.5f,
                .roughness = 1.0f},
               "floor"});
    Camera camera;
    camera.world_from_camera = look_at({0, 0.5f, 1}, {0, 0, 0}, {0, 1, 0});
    camera.fov_y = 0.3f;
    const auto settings_of = [](IntegratorKind kind, LightSelection choice) {
        RenderSettings settings = settings_for(kind, choice);
        settings.width = settings.height = 8;
        settings.samples = 128;
        settings.path.max_depth = 2;
        return settings;
    };
    for (const IntegratorDescriptor& kind : integrators()) {
        if (!kind.selects_lights || kind.makes_frames) continue;
        CAPTURE(kind.name);
        const auto mean_by = [&](LightSelection choice) {
            return test::mean_of(test::render(queue, scene, camera, settings_of(kind.value, choice)).picture);
        };
        CHECK(std::abs(mean_by(LightSelection::Tree) / mean_by(LightSelection::Power) - 1) < 0.005);
    }

    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    const RenderSettings by_tree = settings_of(IntegratorKind::Path, LightSelection::Tree);
    Session session(queue, prepared, camera, by_tree);
    session.render(by_tree.samples);
    const double expected = test::mean_of(session.picture());
    double frames = 0;
    for (uint32_t k = 0; k < 64; ++k) {
        session.render_frame(
            k, {.history = 1, .passes = 0, .clamp_fireflies = false, .clamp_history = false, .anti_alias = false},
            {.light = RestirLight::Direct, .history = 0});
        frames += test::mean_of(session.frame().picture()) / 64;
    }
    CHECK(std::abs(frames / expected - 1) < 0.005);

    // After a scattering in fog the tree knows no normal, though the path has left the floor before.
    scene.medium.sigma_s = grey(0.6f);
    const auto mean_in_fog = [&](LightSelection choice) {
        RenderSettings settings = settings_of(IntegratorKind::Path, choice);
        settings.samples = 1024;
        settings.path.max_depth = 2;
        return test::mean_of(test::render(queue, scene, camera, settings).picture);
    };
    CHECK(std::abs(mean_in_fog(LightSelection::Tree) / mean_in_fog(LightSelection::Power) - 1) < 0.003);
}

TEST_CASE("all integrators that select lights by a tree give the same bytes by both schedules and on both devices") {
    Queue cpu = Queue::make_cpu(), requested = test::requested_queue();
    const auto hash_of = [&](Queue& queue, const Scene& scene, const RenderSettings& settings) {
        const RenderResult result = test::render(queue, scene, test::mixed_scene_camera(), settings);
        CHECK(result.invalid_samples == 0);
        return picture_hash(result.picture);
    };
    for (const IntegratorDescriptor& kind : integrators()) {
        if (!kind.selects_lights || kind.makes_frames) continue;
        CAPTURE(kind.name);
        for (const bool is_stacked : {false, true}) {
            Scene scene = test::make_mixed_scene();
            for (Material& material : scene.materials) material.coat_weight = is_stacked ? 0.5f : 0.0f;
            RenderSettings settings = settings_for(kind.value, LightSelection::Power);
            settings.width = 12, settings.height = 9, settings.samples = 1;
            const Hash128 by_power = hash_of(cpu, scene, settings);
            settings.path.light_choice = LightSelection::Auto; // this scene has few lights
            CHECK(hash_of(cpu, scene, settings) == by_power);
            settings.path.light_choice = LightSelection::Tree;
            const Hash128 by_tree = hash_of(cpu, scene, settings);
            CHECK(by_tree != by_power);
            CHECK(hash_of(requested, scene, settings) == by_tree);
            settings.body = PathBody::Wavefront;
            settings.batch = 100;
            CHECK(hash_of(cpu, scene, settings) == by_tree);
        }
    }
}
