// Pictures whose lights are selected by a tree: the same bytes by both schedules and on both devices, with and without
// layers, and the mean of pictures by power.

#include <doctest/doctest.h>

#include "image/picture_hash.h"
#include "tests/support/compare_pictures.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

RenderSettings tree_settings(uint32_t samples) {
    RenderSettings settings;
    settings.width = 21;
    settings.height = 15;
    settings.samples = samples;
    settings.path.light_choice = LightSelection::Tree;
    return settings;
}

/// The scene of all kinds of surfaces and lights with coats, or as it is, or with plain diffuse surfaces alone.
enum class Surfaces { Stacked, Mixed, Plain };
Scene mixed_scene(Surfaces surfaces) {
    Scene scene = test::make_mixed_scene();
    for (Material& material : scene.materials) {
        if (surfaces == Surfaces::Stacked) material.coat_weight = 0.5f;
        if (surfaces != Surfaces::Plain) continue;
        material.kind = MaterialKind::Diffuse;
        material.alpha_mode = AlphaMode::Opaque;
        material.base_color_texture = material.normal_texture = material.emission_texture = {};
    }
    return scene;
}

Hash128 hash_of(Queue& queue, const Scene& scene, const RenderSettings& settings) {
    const RenderResult result = test::render(queue, scene, test::mixed_scene_camera(), settings);
    CHECK(result.invalid_samples == 0);
    return picture_hash(result.picture);
}

} // namespace

TEST_CASE("a light tree gives the same bytes by both schedules and on both devices, other than those by power") {
    Queue cpu = Queue::make_cpu(), requested = test::requested_queue();
    for (const Surfaces surfaces : {Surfaces::Stacked, Surfaces::Mixed, Surfaces::Plain}) {
        CAPTURE(static_cast<int>(surfaces));
        const Scene scene = mixed_scene(surfaces);
        RenderSettings settings = tree_settings(5);
        const Hash128 hash = hash_of(cpu, scene, settings);
        CHECK(hash_of(requested, scene, settings) == hash);
        settings.body = PathBody::Wavefront;
        for (const uint32_t batch : {100u, 1u << 20}) {
            settings.batch = batch;
            CHECK(hash_of(cpu, scene, settings) == hash);
            CHECK(hash_of(requested, scene, settings) == hash);
        }
        settings.aovs = kAovAlbedo | kAovNormal;
        CHECK(hash_of(requested, scene, settings) == hash);
        settings.path.light_choice = LightSelection::Auto; // this scene has few lights
        const Hash128 few = hash_of(cpu, scene, settings);
        CHECK(few != hash);
        settings.path.light_choice = LightSelection::Power;
        CHECK(hash_of(cpu, scene, settings) == few);
    }
}

TEST_CASE("pictures by a light tree have the mean of those by power, under every strategy that samples lights") {
    Queue queue = test::requested_queue();
    Messages messages;
    const Scene scene = mixed_scene(Surfaces::Mixed);
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings = tree_settings(32);
    settings.path.sampler = SamplerKind::Independent;
    for (const LightStrategy strategy : {LightStrategy::Mis, LightStrategy::NeeOnly}) {
        CAPTURE(static_cast<int>(strategy));
        settings.path.strategy = strategy;
        settings.path.light_choice = LightSelection::Tree;
        const auto tree = test::estimate_picture(queue, prepared, test::mixed_scene_camera(), settings, 12, 1);
        settings.path.light_choice = LightSelection::Power;
        const auto power = test::estimate_picture(queue, prepared, test::mixed_scene_camera(), settings, 12, 101);
        CHECK(test::p_value(tree, power) > 0.01);
        CHECK(test::p_value(test::brightened(tree, 1.1, 0), power) < 1e-6);
    }
}
