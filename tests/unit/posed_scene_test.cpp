// A scene at a time: nodes, skins, morph targets, cameras, lights; and the reported changes.

#include "scene/pose/posed_scene.h"

#include <cmath>
#include <limits>

#include <doctest/doctest.h>

#include "base/error.h"
#include "device_scene/place_meshes.h"
#include "formats/gltf/read_gltf.h"
#include "scene/shape_mesh.h"
#include "scene/validate/validate.h"
#include "session/opening/choose_camera.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/options.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

Mesh triangle() {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
    mesh.indices = {0, 1, 2};
    return mesh;
}

/// Gives the first mesh a skin whose only joint is node 0.
void hang_on_first_node(Scene& scene) {
    const Mesh& mesh = scene.meshes[0];
    scene.skins.push_back({.joints = {0}, .joint_from_mesh = {}});
    scene.nodes[1].skin = 0;
    scene.shapes.push_back({.mesh = 0,
                            .node = 1,
                            .skin = 0,
                            .positions = mesh.positions,
                            .normals = mesh.normals,
                            .tangents = mesh.tangents,
                            .joints_per_vertex = 1,
                            .joints = {0, 0, 0},
                            .weights = {1, 1, 1}});
}

AnimationChannel channel(uint32_t target, AnimatedPart part, std::vector<float> times, std::vector<float> values) {
    AnimationChannel channel;
    channel.target = target;
    channel.part = part;
    channel.times = std::move(times);
    channel.values = std::move(values);
    return channel;
}

/// Node 1, a child of node 0, has an instance. A second instance is still. Node 0 moves along x at 1 m/s for 4 s.
Scene scene_to_pose() {
    Scene scene;
    scene.materials.resize(1);
    scene.meshes = {triangle(), triangle()};
    scene.nodes.resize(2);
    scene.nodes[1].parent = 0;
    scene.instances.push_back({.name = "still", .mesh = 1, .material = 0});
    scene.instances.push_back({.name = "moves", .mesh = 0, .material = 0, .node = 1});
    scene.animations.push_back(
        {.name = "", .origin = "", .channels = {channel(0, AnimatedPart::Translation, {0, 4}, {0, 0, 0, 4, 0, 0})}});
    return scene;
}

PosedScene pose(Scene scene) {
    Messages messages;
    validate(scene, "test", messages);
    return PosedScene(std::move(scene));
}

bool close(Vec3 a, Vec3 b) { return length(a - b) < 1e-5f; }

using Numbers = std::vector<uint32_t>;

} // namespace

TEST_CASE("the contents of a node move with it, and only they are reported as moved") {
    PosedScene posed = pose(scene_to_pose());
    const SceneUpdate update = posed.set_time(1.5);
    CHECK(posed.scene().instances[1].world_from_local.translation == Vec3{1.5f, 0, 0});
    CHECK(posed.scene().instances[0].world_from_local == Transform());
    CHECK(update.moved_instances == Numbers{1});
    CHECK(update.deformed_meshes.empty());
    CHECK(posed.set_time(1.5).is_empty());
    CHECK(posed.set_time(4).moved_instances == Numbers{1});
    CHECK(posed.set_time(1e6).is_empty()); // the last value is kept
    posed.set_time(-3);
    CHECK(posed.scene().instances[1].world_from_local.translation == Vec3{0, 0, 0});
}

TEST_CASE("a time that is not finite is refused") {
    PosedScene posed = pose(scene_to_pose());
    for (const double time : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        const auto error = test::thrown_error([&] { posed.set_time(time); });
        CHECK(test::is_about(error, ErrorCode::BadInput, "time"));
    }
}

TEST_CASE("a position within a node is kept as the node moves") {
    Scene scene = scene_to_pose();
    scene.instances[1].node_from_local = make_translation({0, 5, 0});
    scene.instances[1].world_from_local = make_translation({0, 5, 0});
    PosedScene posed = pose(std::move(scene));
    posed.set_time(2);
    CHECK(posed.scene().instances[1].world_from_local.translation == Vec3{2, 5, 0});
}

TEST_CASE("the later of two animations of the same property applies") {
    Scene scene = scene_to_pose();
    scene.animations.push_back(
        {.name = "", .origin = "", .channels = {channel(0, AnimatedPart::Translation, {0, 2}, {0, 0, 0, 0, 0, 6})}});
    PosedScene posed = pose(std::move(scene));
    posed.set_time(1);
    CHECK(posed.scene().instances[1].world_from_local.translation == Vec3{0, 0, 3});
}

TEST_CASE("a scale of 0 hides an instance at that time, and nothing becomes NaN") {
    Scene scene = scene_to_pose();
    scene.animations[0].channels = {channel(0, AnimatedPart::Scale, {0, 1, 2}, {1, 1, 1, 0, 0, 0, 1, -1, 1})};
    PosedScene posed = pose(std::move(scene));
    CHECK(posed.set_time(1).moved_instances == Numbers{1});
    CHECK(posed.scene().instances[1].is_hidden);
    CHECK(is_finite(posed.scene().instances[1].world_from_local));
    CHECK(posed.set_time(2).moved_instances == Numbers{1});
    CHECK(!posed.scene().instances[1].is_hidden);
    CHECK(posed.scene().instances[1].world_from_local.row1 == Vec3{0, -1, 0});
    CHECK(bounds_of(posed.scene()).lo.y == -1);
    posed.set_time(1);
    CHECK(bounds_of(posed.scene()).lo.y == 0); // hidden objects have no bounds
}

TEST_CASE("an instance hidden by a scale of 0 at rest is kept only if it moves") {
    Scene scene = scene_to_pose();
    std::get<NodePose>(scene.nodes[1].pose).scale = {0, 0, 0};
    scene.instances[1].world_from_local = make_scale({0, 0, 0});
    scene.animations[0].channels = {channel(1, AnimatedPart::Scale, {1, 2}, {0, 0, 0, 2, 2, 2})};
    SUBCASE("moving") {
        PosedScene posed = pose(scene);
        REQUIRE(posed.scene().instances.size() == 2);
        CHECK(posed.scene().instances[1].is_hidden);
        posed.set_time(2);
        CHECK(!posed.scene().instances[1].is_hidden);
        CHECK(posed.scene().instances[1].world_from_local == make_scale({2, 2, 2}));
    }
    SUBCASE("still") {
        scene.animations.clear();
        CHECK(pose(scene).scene().instances.size() == 1);
    }
}

TEST_CASE("a scene in which all instances are hidden at rest can be rendered") {
    Scene scene = scene_to_pose();
    scene.instances.erase(scene.instances.begin());
    scene.instances[0].world_from_local = make_scale({0, 0, 0});
    std::get<NodePose>(scene.nodes[1].pose).scale = {0, 0, 0};
    scene.animations[0].channels = {channel(1, AnimatedPart::Scale, {1, 2}, {0, 0, 0, 2, 2, 2})};
    PosedScene posed = pose(std::move(scene));
    Messages messages;
    const Camera camera = choose_camera({}, posed.scene(), 1, messages);
    CHECK(!is_singular(camera.world_from_camera));
    CHECK(is_finite(world_centre(posed.scene())));
    CameraChoice choice;
    choice.eye = DoubleVec3{1, 2, 3};
    choice.aperture = 0.1f;
    CHECK(!is_singular(choose_camera(choice, posed.scene(), 1, messages).world_from_camera));
}

TEST_CASE("positions beyond the limit are refused, at rest and at later times") {
    Scene scene = scene_to_pose();
    scene.animations[0].channels[0].values[3] = 1e13f;
    PosedScene posed = pose(std::move(scene));
    const auto error = test::thrown_error([&] { posed.set_time(4); });
    CHECK(test::is_about(error, ErrorCode::OverLimit, "time", "4"));
    CHECK(posed.set_time(0).moved_instances == Numbers{1});
}

TEST_CASE("cameras and lights move with their nodes; a singular camera keeps its rest pose, a singular light is dark") {
    Scene scene = scene_to_pose();
    scene.animations[0].channels.push_back(channel(0, AnimatedPart::Scale, {0, 8, 9}, {1, 1, 1, 1, 1, 1, 0, 0, 0}));
    scene.cameras.push_back({.name = "eye", .node = 1});
    scene.lights.push_back({.name = "lamp", .kind = LightKind::Spot, .direction = {0, 0, -1}, .node = 1});
    scene.animations[0].channels.push_back(channel(0, AnimatedPart::CameraFov, {0, 4}, {0.5f, 1.5f}));
    scene.animations[0].channels.push_back(
        channel(0, AnimatedPart::LightIntensity, {0, 4}, {1, 1, 1, /*later it is negative*/ 5, 3, -7}));
    PosedScene posed = pose(std::move(scene));
    CHECK(posed.set_time(2).lights_changed);
    CHECK(posed.scene().cameras[0].world_from_camera == make_translation({2, 0, 0}));
    CHECK(posed.scene().cameras[0].fov_y == 1);
    CHECK(posed.scene().lights[0].position == Vec3{2, 0, 0});
    CHECK(posed.scene().lights[0].intensity == Rgb{3, 2, 0});
    posed.set_time(9);
    CHECK(posed.scene().cameras[0].world_from_camera == Transform());
    CHECK(posed.scene().lights[0].intensity == Rgb{0, 0, 0});
    CHECK(is_finite(posed.scene().lights[0].direction));
}

TEST_CASE("a light's range and cone and an orthographic view change over time within their limits") {
    Scene scene = scene_to_pose();
    scene.cameras.push_back({.name = "plan", .projection = Projection::Orthographic});
    scene.lights.push_back({.name = "lamp", .kind = LightKind::Spot, .direction = {0, 0, -1}});
    std::vector<AnimationChannel>& channels = scene.animations[0].channels;
    channels.push_back(channel(0, AnimatedPart::CameraHeight, {0, 4}, {2, 6}));
    channels.push_back(channel(0, AnimatedPart::LightRange, {0, 4}, {8, -8}));
    channels.push_back(channel(0, AnimatedPart::LightInnerCone, {0, 4}, {0, 1.5f}));
    channels.push_back(channel(0, AnimatedPart::LightOuterCone, {0, 4}, {1, 1}));
    PosedScene posed = pose(std::move(scene));
    CHECK(posed.set_time(1).lights_changed);
    const Light& light = posed.scene().lights[0];
    CHECK(posed.scene().cameras[0].ortho_height == 3);
    CHECK(light.range == 4);
    CHECK(light.cos_inner == doctest::Approx(std::cos(0.375)));
    CHECK(light.cos_outer == doctest::Approx(std::cos(1.0)));
    posed.set_time(4);
    CHECK(light.range > 0);
    CHECK(light.cos_outer < light.cos_inner); // although the angles are in the other order
    Messages messages;
    Scene now = posed.scene();
    CHECK_NOTHROW(validate(now, "posed", messages));
}

TEST_CASE("a skin's vertices follow its joints, with normals and tangents") {
    Scene scene = scene_to_pose();
    Mesh& mesh = scene.meshes[0];
    mesh.tangents = {{1, 0, 0, -1}, {1, 0, 0, -1}, {1, 0, 0, -1}};
    hang_on_first_node(scene);
    scene.skins[0].joint_from_mesh = {make_translation({-1, 0, 0})};
    MeshShape& shape = scene.shapes[0];
    shape.weights = {1, 0.5f, 0}; // the weights have an arbitrary sum; the third vertex is still
    const float root = 0.70710678f;
    scene.animations[0].channels = {channel(0, AnimatedPart::Rotation, {0, 1}, {0, 0, 0, 1, 0, root, 0, root})};
    shape_mesh(shape, {},
               joint_transforms(scene.skins[0],
                                world_from_nodes(transforms_of(scene.nodes, parents_first(scene.nodes)), {0, 0, 0})),
               mesh);
    CHECK(close(mesh.positions[0], {-1, 0, 0}));
    PosedScene posed = pose(std::move(scene));
    CHECK(posed.set_time(1).deformed_meshes == Numbers{0});
    const Mesh& turned = posed.scene().meshes[0]; // a quarter about y: x becomes -z, z becomes x
    CHECK(close(turned.positions[0], {0, 0, 1}));
    CHECK(close(turned.positions[1], {0, 0, 0}));
    CHECK(close(turned.positions[2], {0, 1, 0}));
    CHECK(close(turned.normals[0], {1, 0, 0}));
    CHECK(close({turned.tangents[0].x, turned.tangents[0].y, turned.tangents[0].z}, {0, 0, -1}));
    CHECK(turned.tangents[0].w == -1);
    CHECK(posed.scene().instances[1].world_from_local == Transform());
    // Time 0 gives the same bits as the scene at rest.
    posed.set_time(0);
    CHECK(turned.positions[0] == Vec3{-1, 0, 0});
}

TEST_CASE("where a joint squeezes or mirrors, normals stay perpendicular and tangents parallel to the surface") {
    Scene scene = scene_to_pose();
    Mesh& mesh = scene.meshes[0];
    mesh.normals.assign(3, normalize(Vec3{1, 1, 0}));
    mesh.tangents.assign(3, {0.70710678f, -0.70710678f, 0, 1});
    hang_on_first_node(scene);
    scene.animations[0].channels = {channel(0, AnimatedPart::Scale, {0, 1, 2}, {1, 1, 1, 2, 1, 1, -2, 1, 1})};
    PosedScene posed = pose(std::move(scene));
    const Mesh& now = posed.scene().meshes[0];
    posed.set_time(1);
    CHECK(close(now.normals[0], normalize(Vec3{1, 2, 0})));
    CHECK(close({now.tangents[0].x, now.tangents[0].y, 0}, normalize(Vec3{2, -1, 0})));
    CHECK(now.tangents[0].w == 1);
    posed.set_time(2);
    CHECK(close(now.normals[0], normalize(Vec3{-1, 2, 0})));
    CHECK(close({now.tangents[0].x, now.tangents[0].y, 0}, normalize(Vec3{-2, -1, 0})));
    // The bitangent stays along -z, but cross(normal, tangent) now points the other way.
    CHECK(now.tangents[0].w == -1);
    posed.set_time(0);
    CHECK(now.tangents[0].w == 1);
}

TEST_CASE("joints that mirror reverse the winding, so that front faces stay front faces") {
    Scene scene = scene_to_pose();
    hang_on_first_node(scene);
    scene.animations[0].channels = {channel(0, AnimatedPart::Scale, {0, 1, 2}, {1, 1, 1, 0, 0, 0, -1, 1, 1})};
    PosedScene posed = pose(std::move(scene));
    const SceneUpdate update = posed.set_time(2);
    CHECK(update.replaced_meshes == Numbers{0});
    CHECK(update.deformed_meshes.empty());
    CHECK(posed.scene().meshes[0].indices == Numbers{0, 2, 1});
    CHECK(posed.scene().meshes[0].positions[1] == Vec3{-1, 0, 0});
    CHECK(posed.set_time(1).replaced_meshes == Numbers{0}); // all joints have the scale 0, so no triangle has an area
    for (const Vec3 normal : posed.scene().meshes[0].normals) CHECK(is_finite(normal));
    posed.set_time(0);
    CHECK(posed.scene().meshes[0].indices == Numbers{0, 1, 2});
}

TEST_CASE("morph targets are added by their weights at a time, and normals stay unit") {
    Scene scene = scene_to_pose();
    const Mesh& mesh = scene.meshes[0];
    scene.nodes[1].morph_weights = {0, 0};
    scene.shapes.push_back({.mesh = 0, .node = 1, .positions = mesh.positions, .normals = mesh.normals});
    scene.shapes[0].targets = {
        {.positions = {{0, 0, 8}, {0, 0, 0}, {0, 0, 0}}, .normals = {{3, 0, 3}, {0, 0, -1}, {0, 0, 0}}},
        {.positions = {{0, 0, 0}, {0, 16, 0}, {0, 0, 0}}}};
    scene.animations[0].channels = {channel(1, AnimatedPart::Weights, {0, 1}, {0, 0, 1, 0.5f})};
    PosedScene posed = pose(std::move(scene));
    CHECK(posed.set_time(1).deformed_meshes == Numbers{0});
    const Mesh& now = posed.scene().meshes[0];
    CHECK(now.positions == std::vector<Vec3>{{0, 0, 8}, {1, 8, 0}, {0, 1, 0}});
    CHECK(close(now.normals[0], {0.6f, 0, 0.8f}));
    CHECK(now.normals[1] == Vec3{0, 0, 1}); // (0, 0, 0) is ignored
    CHECK(now.normals[2] == Vec3{0, 0, 1});
    CHECK(posed.set_time(0.5).deformed_meshes == Numbers{0});
    CHECK(now.positions[1] == Vec3{1, 4, 0});
}

TEST_CASE("Khronos: the skin of SimpleSkin bends its upper half to both sides") {
    const auto path = test::test_scene("gltf/SimpleSkin/SimpleSkin.gltf");
    if (!path) return;
    Messages messages;
    Scene rest = read_gltf(*path, FileAccess(*path, {}), {}, messages);
    validate(rest, "SimpleSkin", messages);
    const std::vector<Vec3> at_rest = rest.meshes.at(0).positions;
    PosedScene posed(std::move(rest));
    CHECK(posed.scene().animations.at(0).end_s() == 5.5);
    const Mesh& mesh = posed.scene().meshes[0];
    posed.set_time(0);
    for (std::size_t i = 0; i < at_rest.size(); ++i) CHECK(close(mesh.positions[i], at_rest[i]));
    // At 1 s joint 1, whose node is at height 1, has turned by a quarter about z. Vertices 8 and 9 at height 2 follow
    // it: (-0.5, 2) moves to (-1, 0.5), and (0.5, 2) to (-1, 1.5).
    CHECK(posed.set_time(1).deformed_meshes == Numbers{0});
    CHECK(close(mesh.positions[0], at_rest[0]));
    CHECK(close(mesh.positions[8], {-1, 0.5f, 0}));
    CHECK(close(mesh.positions[9], {-1, 1.5f, 0}));
    posed.set_time(4); // it has turned the other way
    CHECK(mesh.positions[8].x > 0.9f);
}

TEST_CASE("Khronos: the cubes of InterpolationTest follow their interpolations") {
    const auto path = test::test_scene("gltf/InterpolationTest/InterpolationTest.glb");
    if (!path) return;
    Messages messages;
    Scene rest = read_gltf(*path, FileAccess(*path, {}), {.animation = "all"}, messages);
    validate(rest, "InterpolationTest", messages);
    PosedScene posed(std::move(rest));
    const Scene& scene = posed.scene();
    // At each key's time every channel has the key's value, whatever its interpolation. Steps keep it.
    int keys = 0;
    for (const Animation& animation : scene.animations) {
        for (const AnimationChannel& c : animation.channels) {
            if (c.part != AnimatedPart::Translation) continue;
            const std::size_t stride = c.interpolation == Interpolation::CubicSpline ? 9 : 3;
            const std::size_t offset = stride == 9 ? 3 : 0;
            for (std::size_t k = 0; k < c.times.size(); ++k) {
                posed.set_time(static_cast<double>(c.times[k]));
                const float* v = c.values.data() + k * stride + offset;
                for (const Instance& instance : scene.instances) {
                    if (instance.node != c.target) continue;
                    CHECK(close(instance.world_from_local.translation, {v[0], v[1], v[2]}));
                    ++keys;
                }
            }
        }
    }
    CHECK(keys > 9);
}
