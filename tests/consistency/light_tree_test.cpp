// Pictures whose lights are selected by a tree: the same bytes by both schedules and on both devices, with and without
// layers, in batches and frames, and the mean of pictures by power. The tree is built only where it is used.

#include <doctest/doctest.h>

#include <span>

#include "image/picture_hash.h"
#include "render/light_paths/light_path_layers.h"
#include "render/update_scene.h"
#include "session/batch_render.h"
#include "tests/support/compare_pictures.h"
#include "tests/support/lit_scenes.h"
#include "tests/support/many_lights.h"
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
    if (surfaces == Surfaces::Stacked) return scene;
    // Two instances of an emitter share a subtree; one is mirrored.
    const Transform large = test::make_similarity({0, 0.6f, 0.8f}, 2.6f, 0.4f, {0.4f, 2, 0});
    test::add_emitter(scene, test::make_square(6), {2, 3, 4}, large);
    scene.instances.push_back(scene.instances.back());
    scene.instances.back().world_from_local = test::make_similarity({0.6f, 0, 0.8f}, 2.9f, -0.2f, {-0.7f, 1.5f, 0.3f});
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

TEST_CASE("layers of light paths by a light tree keep the picture and add up to it") {
    const Scene scene = mixed_scene(Surfaces::Mixed);
    Queue queue = test::requested_queue(), cpu = Queue::make_cpu();
    RenderSettings settings = tree_settings(3);
    const Hash128 picture = hash_of(cpu, scene, settings);
    std::vector<LightPathExpression> expressions;
    for (const char* text : {"seen=LE", "direct=L.E", "rest=L..+E"}) expressions.push_back(parse_light_path(text));
    settings.light_paths = std::make_shared<const LightPathLayers>(bind_to_scene(std::move(expressions), scene));
    const RenderResult result = test::render(cpu, scene, test::mixed_scene_camera(), settings);
    CHECK(picture_hash(result.picture) == picture);
    REQUIRE(result.layers.size() == 3);
    double most = 0;
    for (std::size_t i = 0; i < result.picture.pixels.size(); ++i) {
        double sum = 0;
        for (const auto& layer : result.layers) sum += static_cast<double>(layer.image.pixels[i]);
        const double whole = static_cast<double>(result.picture.pixels[i]);
        most = std::max(most, std::abs(sum - whole) / (1 + whole));
    }
    CHECK(most < 1e-6);
    settings.body = PathBody::Wavefront;
    settings.batch = 200;
    const RenderResult other = test::render(queue, scene, test::mixed_scene_camera(), settings);
    CHECK(test::render_hash(other) == test::render_hash(result));
}

TEST_CASE("each picture of a batch by a light tree has the hash of a single render") {
    Messages messages;
    const Scene scene = mixed_scene(Surfaces::Mixed);
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Camera parallel = test::mixed_scene_camera();
    parallel.projection = Projection::Orthographic;
    parallel.ortho_height = 4;
    const CameraBatch batch = {{parallel, test::mixed_scene_camera()}, {7, 0}};
    RenderSettings settings = tree_settings(2);
    Queue queue = test::requested_queue(), cpu = Queue::make_cpu();
    DeviceScene on_device(queue);
    PictureRenderer pictures(on_device);
    on_device.set(prepared, settings);
    BatchRender render(pictures, batch, settings, 2);
    BatchArrays arrays;
    REQUIRE(render.next(arrays));
    const std::vector<float> colors = arrays.color.download();
    const std::size_t size = colors.size() / 2;
    for (uint32_t k = 0; k < 2; ++k) {
        settings.path.seed = batch.seed_of(k, settings);
        const RenderResult alone = render_picture(cpu, prepared, batch.cameras[k], settings);
        const auto first = colors.begin() + static_cast<std::ptrdiff_t>(k * size);
        CHECK(std::vector<float>(first, first + static_cast<std::ptrdiff_t>(size)) == alone.picture.pixels);
    }
}

TEST_CASE("frames by a light tree have the same bytes on both devices, with ReSTIR too, and follow lights that move") {
    Messages messages;
    Scene scene = mixed_scene(Surfaces::Mixed);
    const PreparedScene before = prepare_scene(scene, {}, messages);
    for (Light& light : scene.lights) light.position += Vec3{0.5f, 0, 0};
    SceneUpdate update;
    update.lights_changed = true;
    const PreparedScene after = update_scene(before, scene, update, messages);
    const PreparedScene fresh = prepare_scene(scene, {.centre = before.centre}, messages);
    Queue queue = test::requested_queue(), cpu = Queue::make_cpu();
    RestirSettings restir;
    const auto frame_of = [&](Queue& on, const PreparedScene& first, LightSelection choice, PathBody body) {
        RenderSettings settings = tree_settings(1);
        settings.path.light_choice = choice;
        settings.body = body;
        Session session(on, first, test::mixed_scene_camera(), settings);
        session.render_frame(0, {}, restir);
        session.update_scene(after, parts_of(update));
        session.cut();
        session.render_frame(0, {}, restir);
        return picture_hash(session.frame().picture());
    };
    for (const RestirLight light : {RestirLight::Off, RestirLight::Direct, RestirLight::Indirect}) {
        CAPTURE(static_cast<int>(light));
        restir.light = light;
        const Hash128 frame = frame_of(cpu, before, LightSelection::Tree, PathBody::Loop);
        CHECK(frame_of(cpu, fresh, LightSelection::Tree, PathBody::Wavefront) == frame);
        CHECK(frame_of(queue, before, LightSelection::Tree, PathBody::Wavefront) == frame);
        CHECK(frame_of(cpu, before, LightSelection::Power, PathBody::Loop) != frame);
    }
}

TEST_CASE("a light tree is built where it is used, also for a session that began without") {
    Messages messages;
    const Scene scene = mixed_scene(Surfaces::Mixed);
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = test::requested_queue();
    RenderSettings settings = tree_settings(2);
    for (const LightSelection without : {LightSelection::Power, LightSelection::Auto}) {
        settings.path.light_choice = without;
        Session session(queue, prepared, test::mixed_scene_camera(), settings);
        session.render(2);
        CHECK_FALSE(prepared.lights.tree->is_built());
    }
    Session session(queue, prepared, test::mixed_scene_camera(), settings);
    settings.path.light_choice = LightSelection::Tree;
    session.set_settings(settings);
    session.render(2);
    CHECK(prepared.lights.tree->is_built());
    CHECK(picture_hash(session.result().picture) == hash_of(queue, scene, settings));
}

TEST_CASE("the tree is taken by itself above 256 lights, and one light makes a tree of one leaf") {
    Queue queue = test::requested_queue(), cpu = Queue::make_cpu();
    const auto hash_by = [&](Queue& on, const Scene& scene, LightSelection choice) {
        RenderSettings settings = tree_settings(2);
        settings.path.light_choice = choice;
        return hash_of(on, scene, settings);
    };
    for (const uint32_t side : {11u, 12u}) { // 242 and 288 triangles
        Scene scene = mixed_scene(Surfaces::Plain);
        for (Material& material : scene.materials) material.emission = {};
        scene.lights.clear();
        Transform above;
        above.translation = {0, 3, 0};
        test::add_emitter(scene, test::make_square(side), {2, 2, 2}, above);
        const Hash128 by_tree = hash_by(cpu, scene, LightSelection::Tree);
        const Hash128 by_power = hash_by(cpu, scene, LightSelection::Power);
        CHECK(by_tree != by_power);
        CHECK(hash_by(queue, scene, LightSelection::Auto) == (side == 11 ? by_power : by_tree));
    }
    Scene one = mixed_scene(Surfaces::Plain);
    for (Material& material : one.materials) material.emission = {};
    one.environment.reset();
    one.lights.resize(1);
    one.lights[0].kind = LightKind::Point;
    const Hash128 by_power = hash_by(cpu, one, LightSelection::Power);
    CHECK(hash_by(cpu, one, LightSelection::Tree) == by_power); // there is nothing to choose
    CHECK(hash_by(queue, one, LightSelection::Tree) == by_power);
}
