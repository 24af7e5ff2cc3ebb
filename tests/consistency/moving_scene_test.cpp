// The hash of a moving scene's picture at a time does not depend on earlier times, on any device. The scene has hidden
// and mirrored instances, skewed ones beyond the limit of baking, and lights.

#include "session/moving_scene.h"

#include <doctest/doctest.h>

#include "base/error.h"
#include "formats/gltf/read_gltf.h"
#include "scene/validate/validate.h"
#include "session/opening/choose_camera.h"
#include "session/session.h"
#include "session/survey/default_light.h"
#include "tests/support/meshes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

AnimationChannel channel(uint32_t target, AnimatedPart part, Interpolation interpolation, std::vector<float> times,
                         std::vector<float> values) {
    return {target, part, interpolation, std::move(times), std::move(values)};
}

/// The mixed scene with everything that can move: two instances of a shared mesh, one of which is flattened for a
/// while; a single one that a scale of 0 hides; a skinned and a morphed one; the point light; the camera.
Scene make_moving_scene() {
    Scene scene = test::make_mixed_scene();
    Messages messages;
    validate(scene, "mixed", messages);
    scene.nodes.resize(6);
    const auto attach = [&](uint32_t instance, uint32_t node) {
        scene.instances[instance].node = node;
        scene.instances[instance].node_from_local = scene.instances[instance].world_from_local;
    };
    attach(0, 0), attach(1, 1), attach(4, 2);
    scene.animations.emplace_back();
    std::vector<AnimationChannel>& channels = scene.animations[0].channels;
    const auto add = [&](uint32_t target, AnimatedPart part, Interpolation interpolation, std::vector<float> times,
                         std::vector<float> values) {
        channels.push_back(channel(target, part, interpolation, std::move(times), std::move(values)));
    };
    add(0, AnimatedPart::Translation, Interpolation::Linear, {0, 4}, {0, 0, 0, 0.5f, 0.25f, 0});
    add(0, AnimatedPart::Rotation, Interpolation::Linear, {0, 4}, {0, 0, 0, 1, 0, 1, 0, 0});
    add(1, AnimatedPart::Scale, Interpolation::Step, {0, 2, 3}, {1, 1, 1, 1, 1e-5f, 1, -1, 1, 1});
    add(2, AnimatedPart::Scale, Interpolation::Linear, {0, 1, 2}, {1, 1, 1, 0, 0, 0, 1.5f, 1, 1});

    // Copies of the last meshes, one with a skin of two joints, one with a morph target.
    const auto add_shape = [&](uint32_t of, uint32_t node) -> MeshShape& {
        const Mesh mesh = scene.meshes[of];
        scene.meshes.push_back(mesh);
        scene.instances.push_back({.name = "shaped",
                                   .mesh = static_cast<uint32_t>(scene.meshes.size() - 1),
                                   .material = scene.instances[0].material,
                                   .node = node});
        return scene.shapes.emplace_back(MeshShape{.mesh = static_cast<uint32_t>(scene.meshes.size() - 1),
                                                   .node = node,
                                                   .positions = mesh.positions,
                                                   .normals = mesh.normals,
                                                   .tangents = mesh.tangents});
    };
    scene.skins.push_back({.joints = {4, 5}, .joint_from_mesh = {}});
    scene.nodes[3].skin = 0;
    MeshShape& skinned = add_shape(0, 3);
    skinned.skin = 0;
    skinned.joints_per_vertex = 2;
    for (std::size_t i = 0; i < skinned.positions.size(); ++i) {
        skinned.joints.insert(skinned.joints.end(), {0, 1});
        const float share = i % 4 == 0 ? 0.0f : 0.25f;
        skinned.weights.insert(skinned.weights.end(), {1 - share, share});
    }
    add(4, AnimatedPart::Translation, Interpolation::CubicSpline, {0, 4},
        {0, 0, 0, 0, 0, 0, 0.5f, 0, 0, /**/ 0, 0, 0, 0.5f, 1, 0, 0, 0, 0});
    add(5, AnimatedPart::Rotation, Interpolation::Linear, {0, 4}, {0, 0, 0, 1, 1, 0, 0, 1});
    scene.nodes[2].morph_weights = {0};
    MeshShape& morphed = add_shape(0, 2);
    morphed.targets.emplace_back();
    for (const Vec3 p : morphed.positions) morphed.targets[0].positions.push_back({0.5f * p.y, 0, 0.3f});
    add(2, AnimatedPart::Weights, Interpolation::Linear, {0, 4}, {0, 1});

    for (uint32_t i = 0; i < scene.lights.size(); ++i) {
        if (scene.lights[i].kind != LightKind::Point) continue;
        scene.lights[i].node = 0;
        add(i, AnimatedPart::LightIntensity, Interpolation::Linear, {0, 4}, {1, 1, 1, 6, 3, 1});
    }
    validate(scene, "moving", messages);
    return scene;
}

Hash128 hash_at(const Scene& rest, double time_s, const Camera& camera, const RenderSettings& settings) {
    Messages messages;
    Queue cpu = Queue::make_cpu();
    MovingScene moving(rest, time_s, {}, messages);
    Session session(cpu, moving.prepared(), camera, settings);
    session.render(settings.samples);
    return test::render_hash(session.result());
}

/// Steps through `times` and compares each picture with one of a new session.
void check_steps(const Scene& rest, const std::vector<double>& times, const Camera& camera,
                 const RenderSettings& settings) {
    Messages messages;
    Queue queue = test::requested_queue();
    PrepareOptions options;
    options.tracers = default_tracers(queue.is_cuda());
    MovingScene moving(rest, std::nullopt, options, messages);
    Session session(queue, moving.prepared(), camera, settings);
    std::optional<Hash128> before;
    for (const double time_s : times) {
        CAPTURE(time_s);
        if (const uint32_t parts = moving.set_time(time_s, messages)) session.update_scene(moving.prepared(), parts);
        session.render(settings.samples - session.history().samples);
        const Hash128 hash = test::render_hash(session.result());
        CHECK(hash == hash_at(rest, time_s, camera, settings));
        CHECK(hash != before);
        before = hash;
    }
}

} // namespace

TEST_CASE("a step to a time renders like a scene freshly prepared at that time") {
    // From 1 s an instance is hidden. From 2 to 3 s an instance of a shared mesh is so flat that it is baked, which
    // changes the baked tree.
    check_steps(make_moving_scene(), {0, 0.5, 1, 1.5, 2, 2.5, 3.25, 1, 100, 0}, test::mixed_scene_camera(),
                test::layered_settings());
}

TEST_CASE("an instance flattened past the limit is baked only at that time") {
    Messages messages;
    MovingScene moving(make_moving_scene(), 0, {}, messages);
    const auto none_moving_is_baked = [&] { return !moving.prepared().is_baked[1]; };
    CHECK(none_moving_is_baked());
    moving.set_time(2.5, messages);
    CHECK(moving.prepared().is_baked[1]);
    moving.set_time(3.5, messages);
    CHECK(none_moving_is_baked());
}

TEST_CASE("an instance with a scale of 0 is invisible, casts no shadow and emits no light") {
    Messages messages;
    Scene without = test::make_mixed_scene();
    validate(without, "mixed", messages);
    Scene with = without; // has an emitter as the last instance, within the box of the others
    const Transform place = make_translation({0.5f, 2, 0.5f});
    with.nodes.resize(1);
    with.instances.push_back({.name = "lamp",
                              .mesh = 0,
                              .material = with.instances[5].material,
                              .world_from_local = compose(place, make_scale({0.2f, 0.2f, 0.2f})),
                              .node = 0,
                              .node_from_local = compose(place, make_scale({0.2f, 0.2f, 0.2f}))});
    with.animations.emplace_back();
    with.animations[0].channels.push_back(
        channel(0, AnimatedPart::Scale, Interpolation::Step, {0, 1}, {1, 1, 1, 0, 0, 0}));
    REQUIRE(with.materials[with.instances[5].material].is_emissive());
    const Camera camera = test::mixed_scene_camera();
    CHECK(hash_at(with, 1, camera, test::layered_settings()) == hash_at(without, 1, camera, test::layered_settings()));
    CHECK(hash_at(with, 0, camera, test::layered_settings()) != hash_at(without, 0, camera, test::layered_settings()));
}

TEST_CASE("a step without changes updates nothing") {
    Messages messages;
    MovingScene moving(make_moving_scene(), 200, {}, messages);
    CHECK(moving.set_time(100, messages) == 0);
    CHECK(moving.set_time(3, messages) != 0);
    CHECK(*moving.time_s() == 3);
}

TEST_CASE("an edited scene renders like a fresh one with these numbers, at its time and at later ones") {
    const auto edit = [](Scene& scene) -> SceneUpdate {
        for (Material& material : scene.materials) {
            material.base_color = {0.25f, 0.5f, 0.125f};
            material.emission = 0.5f * material.emission;
        }
        for (Light& light : scene.lights) light.position.x += 0.25f; // an animation changes only its intensity
        for (Camera& camera : scene.cameras) camera.fov_y *= 0.5f;
        return {.moved_instances = {},
                .deformed_meshes = {},
                .replaced_meshes = {},
                .lights_changed = true,
                .materials_changed = true};
    };
    const Camera camera = test::mixed_scene_camera();
    const RenderSettings settings = test::layered_settings();
    const Scene rest = make_moving_scene();
    Scene changed = rest;
    edit(changed);
    Messages messages;
    Queue queue = test::requested_queue();
    MovingScene moving(rest, 1.5, {}, messages);
    Session session(queue, moving.prepared(), camera, settings);
    const auto hash = [&](uint32_t parts) {
        session.update_scene(moving.prepared(), parts);
        session.render(settings.samples);
        return test::render_hash(session.result());
    };
    CHECK(hash(moving.edit(edit, messages)) == hash_at(changed, 1.5, camera, settings));
    CHECK(moving.time_s() == 1.5);
    CHECK(hash(moving.set_time(3.25, messages)) == hash_at(changed, 3.25, camera, settings));
}

TEST_CASE("the world's centre follows an instance that is moved") {
    Scene rest = test::make_mixed_scene();
    Messages messages;
    validate(rest, "mixed", messages);
    const auto edit = [](Scene& scene) -> SceneUpdate {
        for (Instance& instance : scene.instances) instance.world_from_local.translation.x += 100;
        SceneUpdate update;
        for (uint32_t i = 0; i < scene.instances.size(); ++i) update.moved_instances.push_back(i);
        return update;
    };
    MovingScene moving(rest, std::nullopt, {}, messages);
    const Vec3 before = moving.prepared().centre;
    moving.edit(edit, messages);
    edit(rest);
    CHECK(moving.prepared().centre == MovingScene(rest, std::nullopt, {}, messages).prepared().centre);
    CHECK(!(moving.prepared().centre == before));
}

TEST_CASE("the third move of an instance in a large tree causes one warning") {
    Scene scene;
    const auto sphere = [](int subdivisions) {
        Mesh mesh;
        const test::TriangleMesh triangles = test::make_sphere(subdivisions, {0, 0, 0}, 1);
        mesh.positions = triangles.positions, mesh.indices = triangles.indices;
        return mesh;
    };
    scene.meshes = {sphere(5), sphere(1)};
    scene.materials.emplace_back();
    scene.instances = {{"large", 0, 0, {}}, {"small", 1, 0, {}}};
    const auto move = [](Scene& edited) -> SceneUpdate {
        edited.instances[1].world_from_local.translation.x += 0.1f;
        SceneUpdate update;
        update.moved_instances = {1};
        return update;
    };
    const auto warnings_in = [&](int moves, PrepareOptions options) {
        Messages messages;
        MovingScene moving(scene, std::nullopt, std::move(options), messages);
        for (int i = 0; i < moves; ++i) moving.edit(move, messages);
        return messages.all().size();
    };
    CHECK(warnings_in(2, {}) == 0);
    CHECK(warnings_in(5, {}) == 1);
    PrepareOptions apart;
    apart.apart = {false, true};
    CHECK(warnings_in(5, apart) == 0);
    scene.meshes[0] = sphere(3);
    CHECK(warnings_in(5, {}) == 0);
}

TEST_CASE("a step after a failed one is complete") {
    Scene rest = make_moving_scene();
    rest.animations[0].channels[0].times = {0, 4, 5};
    rest.animations[0].channels[0].values.insert(rest.animations[0].channels[0].values.end(), {1e13f, 0, 0});
    Messages messages;
    Queue cpu = Queue::make_cpu();
    const Camera camera = test::mixed_scene_camera();
    const RenderSettings settings = test::layered_settings();
    MovingScene moving(rest, 0, {}, messages);
    Session session(cpu, moving.prepared(), camera, settings);
    CHECK_THROWS_AS(moving.set_time(5, messages), Error);
    session.update_scene(moving.prepared(), moving.set_time(1.5, messages));
    session.render(settings.samples);
    CHECK(test::render_hash(session.result()) == hash_at(rest, 1.5, camera, settings));
}

TEST_CASE("Khronos' animated models render the same after steps as when freshly prepared") {
    for (const char* name : {"SimpleSkin/SimpleSkin.gltf", "InterpolationTest/InterpolationTest.glb",
                             "MorphPrimitivesTest/MorphPrimitivesTest.glb"}) {
        CAPTURE(name);
        const auto path = test::test_scene(std::filesystem::path("gltf") / name);
        if (!path) return;
        Messages messages;
        const ReadOptions all = {.animation = std::string_view(name).starts_with("Interpolation") ? "all" : ""};
        Scene rest = read_gltf(*path, FileAccess(*path, {}), all, messages);
        validate(rest, name, messages);
        add_default_light(rest, SceneUse::Picture, messages);
        const Camera camera = choose_camera({}, rest, 1.5f, messages);
        std::vector<double> times = {0.4, 1, 0.9};
        if (rest.animations.empty()) times.resize(1);
        check_steps(rest, times, camera, test::layered_settings());
    }
}
