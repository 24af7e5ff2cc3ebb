// Scenes with normal maps but no tangents: which meshes get tangents, how vertices are split, and what moves with the
// tangents.

#include "scene/tangents/make_tangents.h"

#include <cmath>
#include <filesystem>
#include <string>

#include <doctest/doctest.h>

#include "formats/read_scene.h"
#include "image/write_png.h"
#include "scene/pose/posed_scene.h"
#include "scene/shape_mesh.h"
#include "scene/tangents/corner_tangents.h"
#include "scene/validate/validate.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/options.h"
#include "tests/support/write_text.h"

using namespace pertev;

namespace make_tangents_test { // test files are compiled together

Vec3 xyz(Vec4 v) { return {v.x, v.y, v.z}; }
bool close(Vec3 a, Vec3 b) { return length(a - b) < 1e-5f; }

/// Two squares side by side in the plane z = 0, whose texture is mirrored at the edge that they share.
Mesh mirrored_squares() {
    Mesh mesh;
    mesh.positions = {{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {-1, 1, 0}, {0, 1, 0}, {1, 1, 0}};
    mesh.normals.assign(6, {0, 0, 1});
    mesh.uv[0] = {{1, 1}, {0, 1}, {1, 1}, {1, 0}, {0, 0}, {1, 0}};
    mesh.uv[1] = {{0, 0}, {0, 1}, {0, 2}, {1, 0}, {1, 1}, {1, 2}}; // runs along y and is not mirrored
    for (int i = 0; i < 6; ++i) mesh.colors.push_back({0.1f * static_cast<float>(i), 0, 0, 1});
    mesh.indices = {0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4};
    return mesh;
}

Material with_normal_map(uint8_t uv_set = 0) {
    Material material;
    material.normal_texture = {.image = 0, .uv_set = uv_set};
    return material;
}

Scene scene_of(Mesh mesh, std::vector<Material> materials) {
    Scene scene;
    scene.images.push_back({.name = "map", .rgba8 = {1, 1, {128, 128, 255, 255}}, .rgba_float = {}});
    scene.meshes.push_back(std::move(mesh));
    scene.nodes.resize(1);
    for (uint32_t i = 0; i < materials.size(); ++i) {
        scene.instances.push_back({.name = "", .mesh = 0, .material = i, .node = 0});
        scene.materials.push_back(std::move(materials[i]));
    }
    return scene;
}

/// Hangs mesh 0 on node 0 by a joint of each weight, and gives it morph targets.
MeshShape& add_shape(Scene& scene, std::vector<MorphTarget> targets, bool has_skin) {
    const Mesh& mesh = scene.meshes[0];
    MeshShape shape = {.mesh = 0, .node = 0, .positions = mesh.positions, .normals = mesh.normals};
    scene.nodes[0].morph_weights.assign(targets.size(), 0.0f);
    shape.targets = std::move(targets);
    if (has_skin) {
        scene.nodes.resize(2); // node 1 is the joint
        scene.skins.push_back({.joints = {1, 1}, .joint_from_mesh = {}});
        scene.nodes[0].skin = shape.skin = 0;
        shape.joints_per_vertex = 2;
        for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
            shape.joints.insert(shape.joints.end(), {0, 1});
            shape.weights.insert(shape.weights.end(), {0.5f, 0.1f * static_cast<float>(i)});
        }
    }
    return scene.shapes.emplace_back(std::move(shape));
}

void validate_quietly(Scene& scene) {
    Messages messages;
    validate(scene, "test", messages);
    for (const Message& message : messages.all()) CHECK_MESSAGE(false, message.text);
}

TEST_CASE("a mesh with a normal map gets tangents, and more vertices where its texture is mirrored") {
    Scene scene = scene_of(mirrored_squares(), {with_normal_map()});
    const Mesh before = scene.meshes[0];
    validate_quietly(scene);
    const Mesh& mesh = scene.meshes[0];
    CHECK(mesh.positions.size() == 8); // the two vertices of the shared edge are duplicated
    CHECK(mesh.indices.size() == before.indices.size());
    for (std::size_t corner = 0; corner < mesh.indices.size(); ++corner) {
        const uint32_t is = mesh.indices[corner], was = before.indices[corner];
        CHECK(mesh.positions[is] == before.positions[was]);
        CHECK(mesh.normals[is] == before.normals[was]);
        CHECK(mesh.uv[0][is] == before.uv[0][was]);
        CHECK(mesh.uv[1][is] == before.uv[1][was]);
        CHECK(mesh.colors[is] == before.colors[was]);
        // On both squares v is along y, and u grows away from the shared edge.
        CHECK(mesh.tangents[is] == (corner < 6 ? Vec4{-1, 0, 0, -1} : Vec4{1, 0, 0, 1}));
    }
}

TEST_CASE("tangents follow the normal map's set of coordinates and are made only where needed") {
    // Materials without a normal map, with one over set 1, over set 0, and over set 1 again.
    Scene scene =
        scene_of(mirrored_squares(), {Material(), with_normal_map(1), with_normal_map(0), with_normal_map(1)});
    validate_quietly(scene);
    REQUIRE(scene.meshes.size() == 2);
    CHECK(scene.instances[0].mesh == 0);
    CHECK(scene.instances[1].mesh == 0);
    CHECK(scene.instances[2].mesh == 1);
    CHECK(scene.instances[3].mesh == 0);
    CHECK(scene.meshes[0].positions.size() == 6);
    for (const Vec4 t : scene.meshes[0].tangents) CHECK(t == Vec4{0, 1, 0, 1}); // u is along y, v along x
    CHECK(scene.meshes[1].positions.size() == 8);

    Scene without = scene_of(mirrored_squares(), {Material()});
    validate_quietly(without);
    CHECK(without.meshes[0].tangents.empty());
    CHECK(without.meshes[0].indices == mirrored_squares().indices);

    Scene given = scene_of(mirrored_squares(), {with_normal_map()});
    given.meshes[0].tangents.assign(6, {0, -1, 0, 1});
    validate_quietly(given);
    CHECK(given.meshes[0].tangents == std::vector<Vec4>(6, Vec4{0, -1, 0, 1}));
    CHECK(given.meshes[0].positions.size() == 6);
}

TEST_CASE("without normals tangents lie in their triangles, which stay flat-shaded") {
    Mesh roof; // the squares share an edge along y
    roof.positions = {{-1, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {0, 1, 1}, {1, 1, 0}};
    roof.uv[0] = {{0, 1}, {1, 1}, {2, 1}, {0, 0}, {1, 0}, {2, 0}};
    roof.indices = {0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4};
    Scene scene = scene_of(roof, {with_normal_map()});
    validate_quietly(scene);
    const Mesh& mesh = scene.meshes[0];
    CHECK(mesh.normals.empty());
    CHECK(mesh.positions.size() == 8);
    for (std::size_t corner = 0; corner < mesh.indices.size(); ++corner) {
        const Vec4 t = mesh.tangents[mesh.indices[corner]];
        CHECK(close(xyz(t), normalize(Vec3{1, 0, corner < 6 ? 1.0f : -1.0f})));
        CHECK(t.w == 1);
    }
}

TEST_CASE("skinned and morphed vertices are split in the same way, and their tangents follow") {
    Scene scene = scene_of(mirrored_squares(), {with_normal_map()});
    // The first target turns the mesh by a quarter about z. The second moves nothing.
    MorphTarget turn;
    for (const Vec3 p : scene.meshes[0].positions) turn.positions.push_back(Vec3{-p.y, p.x, 0} - p);
    MeshShape& shape = add_shape(scene, {turn, {}}, true);
    const MeshShape before = shape;
    shape_at_rest(scene, std::vector<MeshShape*>{&shape});
    validate_quietly(scene);
    REQUIRE(scene.shapes.size() == 1);
    const MeshShape& after = scene.shapes[0];
    const Mesh& mesh = scene.meshes[0];
    REQUIRE(after.positions.size() == 8);
    REQUIRE(after.joints.size() == 16);
    REQUIRE(after.targets[0].positions.size() == 8);
    REQUIRE(after.targets[0].tangents.size() == 8);
    CHECK(after.targets[1].tangents.empty());
    for (std::size_t corner = 0; corner < mesh.indices.size(); ++corner) {
        const uint32_t is = mesh.indices[corner], was = mirrored_squares().indices[corner];
        CHECK(after.positions[is] == before.positions[was]);
        CHECK(after.normals[is] == before.normals[was]);
        CHECK(after.weights[2 * is + 1] == before.weights[2 * was + 1]);
        CHECK(after.joints[2 * is + 1] == 1);
        CHECK(after.targets[0].positions[is] == before.targets[0].positions[was]);
        CHECK(after.tangents[is] == mesh.tangents[is]);
    }
    const auto channel = [](uint32_t node, AnimatedPart part, std::vector<float> values) {
        AnimationChannel of_node;
        of_node.target = node;
        of_node.part = part;
        of_node.times = {0, 1};
        of_node.values = std::move(values);
        return of_node;
    };
    scene.animations.push_back({.name = "", .origin = "", .channels = {}});
    scene.animations[0].channels = {channel(0, AnimatedPart::Weights, {0, 0, 1, 0}),
                                    channel(1, AnimatedPart::Scale, {1, 1, 1, 1, -1, 1})};
    PosedScene posed(std::move(scene));
    posed.set_time(1); // the target turns x to y and y to -x; the joint mirrors y, so x becomes -y
    const Mesh& now = posed.scene().meshes[0];
    for (std::size_t corner = 0; corner < now.indices.size(); ++corner) {
        const Vec4 t = now.tangents[now.indices[corner]];
        CHECK(close(xyz(t), {0, corner < 6 ? 1.0f : -1.0f, 0}));
        CHECK(t.w == (corner < 6 ? 1 : -1)); // the bitangent is along -x, as the texture's top is
        CHECK(close(t.w * cross(now.normals[now.indices[corner]], xyz(t)), {-1, 0, 0}));
    }
}

TEST_CASE("a joint that mirrors at rest does not change the tangents of the file's vertices") {
    Scene scene = scene_of(mirrored_squares(), {with_normal_map()});
    MeshShape& shape = add_shape(scene, {}, true);
    std::get<NodePose>(scene.nodes[1].pose).scale = {-1, 1, 1};
    shape_at_rest(scene, std::vector<MeshShape*>{&shape});
    CHECK(scene.shapes[0].is_turned_over);
    validate_quietly(scene);
    CHECK(scene.shapes[0].is_turned_over);
    const Mesh& mesh = scene.meshes[0];
    const Mesh plain = mirrored_squares();
    for (std::size_t triangle = 0; triangle < 4; ++triangle) {
        for (std::size_t k = 0; k < 3; ++k) {
            const uint32_t is = mesh.indices[3 * triangle + k];
            const uint32_t was = plain.indices[3 * triangle + (3 - k) % 3]; // the winding is reversed
            CHECK(close(mesh.positions[is], {-plain.positions[was].x, plain.positions[was].y, 0}));
            CHECK(scene.shapes[0].tangents[is] == (triangle < 2 ? Vec4{-1, 0, 0, -1} : Vec4{1, 0, 0, 1}));
            CHECK(mesh.tangents[is] == (triangle < 2 ? Vec4{1, 0, 0, 1} : Vec4{-1, 0, 0, -1}));
        }
    }
}

TEST_CASE("a glTF file with a normal map but no tangents gets them, over TEXCOORD_1 if the map uses it") {
    test::GltfBuilder builder;
    const int positions = builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    const int normals = builder.add("VEC3", std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1});
    const int first = builder.add("VEC2", std::vector<float>{0, 1, 1, 1, 0, 0});
    const int second = builder.add("VEC2", std::vector<float>{0, 0, 0, 1, 1, 0});
    const std::string pixel =
        "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGP4z8AAAAMBAQDJ/pLvAAAAAElFTkSuQmCC";
    const auto read = [&](int set) {
        Scene scene = test::read_gltf_text(builder.json(
            R"("scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"images":[{"uri":"data:image/png;base64,)" +
            pixel + R"("}],"textures":[{"source":0}],"materials":[{"normalTexture":{"index":0,"texCoord":)" +
            std::to_string(set) + R"(}}],"meshes":[{"primitives":[{"material":0,"attributes":{"POSITION":)" +
            std::to_string(positions) + R"(,"NORMAL":)" + std::to_string(normals) + R"(,"TEXCOORD_0":)" +
            std::to_string(first) + R"(,"TEXCOORD_1":)" + std::to_string(second) + "}}]}]"));
        Messages messages;
        validate(scene, "model.gltf", messages);
        return scene.meshes.at(0).tangents;
    };
    CHECK(read(0) == std::vector<Vec4>(3, Vec4{1, 0, 0, 1}));
    CHECK(read(1) == std::vector<Vec4>(3, Vec4{0, 1, 0, 1}));
}

TEST_CASE("a normal map of an OBJ file has tangents with x to the right and y up") {
    const std::filesystem::path folder = test::scratch_folder();
    Rgba8Image image = {2, 2, {}};
    for (int i = 0; i < 4; ++i) image.pixels.insert(image.pixels.end(), {128, 128, 255, 255});
    write_png(folder / "normal.png", image, false);
    test::write_text(folder / "a.mtl", "newmtl wall\nKd 1 1 1\nnorm normal.png\n");
    Messages messages;
    const Scene scene = read_scene(test::write_text(folder / "a.obj", "mtllib a.mtl\nusemtl wall\n"
                                                                      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
                                                                      "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
                                                                      "f 1/1 2/2 3/3 4/4\n"),
                                   {}, messages);
    REQUIRE(scene.materials.at(0).normal_texture.has_image());
    CHECK(scene.meshes.at(0).tangents == std::vector<Vec4>(4, Vec4{1, 0, 0, 1}));
}

} // namespace make_tangents_test
