// Light that goes straight through thin walls of smooth glass to shadow rays (device_scene/thin_walls.h): against
// closed forms, and by the same mean as paths find it that meet the light by themselves.

#include <doctest/doctest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "device_scene/crossed_surfaces.h"
#include "device_scene/scene_on_device.h"
#include "render/light_paths/light_path_layers.h"
#include "session/measure_irradiance.h"
#include "shading/make_reflection.h"
#include "tests/support/compare_pictures.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/solid_scenes.h"

using namespace pertev;

namespace {

constexpr Rgb kTint = {0.9f, 0.6f, 0.3f};

/// Returns the material of a pane that lets light of this colour through.
Material pane(Rgb tint = kTint, float roughness = 0) {
    return {
        {.kind = MaterialKind::MetallicRoughness, .base_color = tint, .roughness = roughness, .transmission_weight = 1},
        "pane"};
}

/// Returns what a pane lets through from `direction`, the cosine of whose angle with its normal is given.
Rgb through_pane(Rgb tint, float cosine) {
    const Bsdf bsdf = make_reflection({.base_color = tint, .roughness = 0, .through = 1});
    return bsdf.specular({std::sqrt(1 - cosine * cosine), 0, cosine}).refraction;
}

/// Returns a white floor at y = 0 under a directional light of irradiance 1, and panes at these heights over its half
/// with negative x.
Scene floor_under_panes(const std::vector<float>& heights, Vec3 direction, const Material& of_panes) {
    Scene scene;
    test::add(scene, test::floor_at(0, 8), test::white());
    for (const float height : heights) test::add(scene, test::sheet({-8, height, 0}, {0, 0, 16}, {8, 0, 0}), of_panes);
    Light sun;
    sun.kind = LightKind::Directional;
    sun.direction = direction;
    scene.lights.push_back(sun);
    return scene;
}

double component_of(Rgb color, std::size_t channel) {
    return static_cast<double>(channel == 0 ? color.r : channel == 1 ? color.g : color.b);
}

/// Returns the picture of a spot of the floor, 1 m wide, about (x, 0, 0) from close above it.
Image picture_of_floor(const Scene& scene, float x, uint32_t max_depth, PathBody body = PathBody::Loop) {
    Queue queue = test::requested_queue();
    RenderSettings settings = test::square_settings(4, 2, max_depth);
    settings.body = body;
    return test::render(queue, scene, test::camera_down({x, 0.5f, 0}, 1), settings).picture;
}

void check_floor(const Image& picture, Rgb expected) {
    for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
        const double value = component_of(expected, i % 3);
        CHECK(static_cast<double>(picture.pixels[i]) == doctest::Approx(value).epsilon(1e-5));
    }
}

/// Returns a floor with a tinted pane between it and an emitter, under a sky; the pane also mirrors light of the floor.
Scene floor_under_lit_pane(float roughness = 0) {
    Scene scene = test::under_sky();
    test::add(scene, test::floor_at(0, 2), test::white(0.7f));
    test::add(scene, test::sheet({-1, 0.8f, 0}, {0, 0.2f, 1}, {1, 0.1f, 0}), pane(kTint, roughness));
    Material glowing;
    glowing.emission = {9, 6, 3};
    glowing.two_sided_emission = true;
    test::add(scene, test::floor_at(1.5f, 0.7f), glowing);
    return scene;
}

test::PictureEstimate estimate(const Scene& scene, LightStrategy strategy, uint32_t max_depth, uint32_t first_seed,
                               LightSelection lights = LightSelection::Power) {
    RenderSettings settings = test::square_settings(6, static_cast<uint32_t>(test::effort(64, 512)), max_depth);
    settings.path.strategy = strategy;
    settings.path.light_choice = lights;
    settings.path.sampler = SamplerKind::Independent;
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = test::requested_queue();
    return test::estimate_picture(queue, prepared, test::camera_down({0, 0.3f, 0}, 3), settings, 48, first_seed);
}

} // namespace

TEST_CASE("a pane dims the light of the sun on a floor by its transmittance") {
    for (const float cosine : {1.0f, 0.5f, 0.1f}) {
        CAPTURE(cosine);
        const Scene scene = floor_under_panes({1}, {0, -cosine, std::sqrt(1 - cosine * cosine)}, pane());
        const float radiance = cosine * kInvPi; // without a pane
        for (const PathBody body : {PathBody::Loop, PathBody::Wavefront}) {
            check_floor(picture_of_floor(scene, 4, 2, body), {radiance, radiance, radiance});
            check_floor(picture_of_floor(scene, -4, 2, body), radiance * through_pane(kTint, cosine));
        }
    }
    const Rgb straight = through_pane(kTint, 1); // Fresnel's equations at normal incidence: 4 % are mirrored
    CHECK(straight.r == doctest::Approx(0.9 * 0.96));
    CHECK(straight.b == doctest::Approx(0.3 * 0.96));
}

TEST_CASE("light passes as many panes as the maximum depth has scatterings") {
    const Scene scene = floor_under_panes({1, 1.5f, 3}, {0, -1, 0}, pane());
    const Rgb one = through_pane(kTint, 1);
    check_floor(picture_of_floor(scene, -4, 4), kInvPi * (one * one * one));
    check_floor(picture_of_floor(scene, -4, 3), {0, 0, 0});
    check_floor(picture_of_floor(scene, 4, 1), grey(kInvPi));
}

TEST_CASE("rough panes, panes with alpha and emitters block shadow rays") {
    Material blended = pane(), glowing = pane();
    blended.alpha_mode = AlphaMode::Blend;
    glowing.emission = {1, 1, 1};
    check_floor(picture_of_floor(floor_under_panes({1}, {0, -1, 0}, blended), -4, 2), {0, 0, 0});
    Queue queue = test::requested_queue();
    Messages messages;
    const auto has_walls = [&](const Material& material) {
        const Scene scene = floor_under_panes({1}, {0, -1, 0}, material);
        return SceneOnDevice(queue, prepare_scene(scene, {}, messages)).view().thin_walls.is_there();
    };
    CHECK(has_walls(pane()));
    CHECK(!has_walls(glowing));
    CHECK(!has_walls(blended));
    CHECK(!has_walls(pane(kTint, 0.3f)));
    CHECK(!has_walls(test::white()));
}

TEST_CASE("next-event estimation, BSDF sampling and MIS agree through a pane at every maximum depth") {
    const Scene scene = floor_under_lit_pane();
    for (const uint32_t depth : {1u, 2u, 3u, 6u}) {
        CAPTURE(depth);
        const test::PictureEstimate mis = estimate(scene, LightStrategy::Mis, depth, 1);
        CHECK(p_value(mis, estimate(scene, LightStrategy::NeeOnly, depth, 100'000)) > 0.001);
        CHECK(p_value(mis, estimate(scene, LightStrategy::BsdfOnly, depth, 200'000)) > 0.001);
    }
    const test::PictureEstimate whole = estimate(scene, LightStrategy::Mis, 6, 1);
    CHECK(p_value(brightened(whole, 1.05, 0), estimate(scene, LightStrategy::NeeOnly, 6, 100'000)) < 1e-6);
}

TEST_CASE("MIS agrees with BSDF sampling through a pane in fog and with lights from a tree") {
    Scene scene = floor_under_lit_pane();
    Scene several = scene; // the tree's choice among emitters at several sides depends on the receiver's normal
    for (const Vec3 at : {Vec3{-1.5f, 0.4f, 1}, Vec3{-1, 1.2f, -1}, Vec3{1.5f, 0.2f, 0.5f}}) {
        several.meshes.push_back(test::sheet(at, {0, 0.2f, 0}, {0.1f, 0, 0.2f}));
        several.instances.push_back(several.instances.back());
        several.instances.back().mesh = static_cast<uint32_t>(several.meshes.size() - 1);
    }
    const test::PictureEstimate in_vacuum = estimate(several, LightStrategy::BsdfOnly, 4, 200'000);
    CHECK(p_value(estimate(several, LightStrategy::Mis, 4, 1, LightSelection::Tree), in_vacuum) > 0.001);
    Queue queue = Queue::make_cpu();
    for (const LightSelection lights : {LightSelection::Power, LightSelection::Tree}) {
        RenderSettings settings = test::square_settings(16, 4, 5);
        settings.path.light_choice = lights;
        const auto hash = [&](PathBody body) {
            settings.body = body;
            return test::render_hash(test::render(queue, several, test::camera_down({0, 0.3f, 0}, 3), settings));
        };
        CHECK(hash(PathBody::Loop) == hash(PathBody::Wavefront));
    }
    scene.medium = {.sigma_a = {0.1f, 0.1f, 0.2f}, .sigma_s = {0.4f, 0.3f, 0.2f}, .g = 0.3f};
    const test::PictureEstimate in_fog = estimate(scene, LightStrategy::BsdfOnly, 4, 200'000);
    CHECK(p_value(estimate(scene, LightStrategy::Mis, 4, 1), in_fog) > 0.001);
}

TEST_CASE("layers of light paths count a pane as a specular transmission") {
    Scene scene = floor_under_panes({1}, {0, -1, 0}, pane());
    scene.instances.back().name = "pane";
    std::vector<LightPathExpression> expressions;
    for (const char* text : {"through=LS<T>DE", "beside=LDE", "by_name=LS<T'pane'>DE", "others=L[^D]+DE"}) {
        expressions.push_back(parse_light_path(text));
    }
    RenderSettings settings = test::square_settings(8, 2, 2);
    settings.light_paths = std::make_shared<const LightPathLayers>(bind_to_scene(std::move(expressions), scene));
    Queue cpu = Queue::make_cpu(), queue = test::requested_queue();
    const Camera camera = test::camera_down({0, 0.5f, 0}, 2); // half of the picture is under the pane
    const RenderResult result = test::render(cpu, scene, camera, settings);
    settings.body = PathBody::Wavefront;
    CHECK(test::render_hash(test::render(queue, scene, camera, settings)) == test::render_hash(result));
    double through = 0, beside = 0;
    for (std::size_t i = 0; i < result.picture.pixels.size(); ++i) {
        const auto of = [&](const char* name) { return static_cast<double>(layer_named(result, name).pixels[i]); };
        CHECK(of("through") + of("beside") ==
              doctest::Approx(static_cast<double>(result.picture.pixels[i])).epsilon(1e-5));
        CHECK(of("through") == of("by_name"));
        CHECK(of("through") == of("others"));
        through += of("through"), beside += of("beside");
    }
    CHECK(through > 0.2 * beside);
    CHECK(beside > through);
}

TEST_CASE("a light meter under a pane measures the light that comes through") {
    const Scene scene = floor_under_panes({1}, {0, -0.6f, 0.8f}, pane());
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = test::requested_queue();
    RenderSettings settings;
    settings.samples = 1;
    settings.path.max_depth = 1;
    const Irradiance measured = measure_irradiance(queue, prepared, {{-4, 0.5f, 0}, {0, 1, 0}}, settings);
    for (std::size_t channel = 0; channel < 3; ++channel) {
        const double expected = 0.6 * component_of(through_pane(kTint, 0.6f), channel);
        CHECK(measured.rgb[channel].value == doctest::Approx(expected).epsilon(1e-4));
    }
}

TEST_CASE("a pane that is made opaque in place blocks the light, and lets it through again") {
    Scene scene = floor_under_panes({1}, {0, -1, 0}, pane());
    Messages messages;
    Queue queue = test::requested_queue();
    PreparedScene prepared = prepare_scene(scene, {}, messages);
    SceneOnDevice on_device(queue, prepared);
    CHECK(on_device.view().thin_walls.is_there());
    scene.materials.back().transmission_weight = 0;
    on_device.update(queue, prepared, kPartMaterials);
    CHECK(!on_device.view().thin_walls.is_there());
    scene.materials.back().transmission_weight = 1;
    on_device.update(queue, prepared, kPartMaterials);
    CHECK(on_device.view().thin_walls.is_there());
    for (bool Instance::*const is : {&Instance::is_hidden, &Instance::is_background}) {
        scene.instances.back().*is = true;
        CHECK(find_thin_walls(prepared).empty());
        scene.instances.back().*is = false;
    }
    CHECK(find_thin_walls(prepared) == std::vector<bool>{false, true});
    scene.materials.front().medium.sigma_a = {1, 1, 1};
    scene.materials.front().is_clear_boundary = true;
    on_device.update(queue, prepared, kPartMaterials);
    CHECK(on_device.view().has_media == 1);
    scene.materials.front().is_clear_boundary = false;
    on_device.update(queue, prepared, kPartMaterials);
    CHECK(on_device.view().has_media == 0);
}
