// Effects of glTF nodes: transforms, instancing, cameras, lights, skins, morph targets, scenes, external assets.

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>

#include "formats/gltf/read_gltf.h"
#include "scene/pose/posed_scene.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/options.h"
#include "tests/support/write_text.h"

using namespace pertev;
using test::GltfBuilder;

namespace {

/// A document with a triangle as mesh 0 and these additional members.
std::string with_triangle(const std::string& members) {
    GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    return builder.json(R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)" + members);
}

std::string only_nodes(const std::string& members) { return R"({"asset":{"version":"2.0"},)" + members + "}"; }

bool same_place(Vec3 a, Vec3 b) { return length(a - b) < 1e-6f; }

const std::string kQuarterTurnAboutZ = R"("rotation":[0,0,0.70710678,0.70710678])";

const std::string kRedPixel =
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGP4z8AAAAMBAQDJ/pLvAAAAAElFTkSuQmCC";

std::filesystem::path asset_folder() {
    const std::filesystem::path made = test::scratch_folder();
    std::filesystem::create_directories(made / "parts");
    return made;
}

/// A chair: node 0 moves node 1, which shows a triangle; a light and a camera lie at node 0.
std::string chair_asset() {
    GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    builder.add("SCALAR", std::vector<float>{0, 1});
    builder.add("VEC3", std::vector<float>{0, 0, 0, 0, 0, 5});
    builder.add("VEC2", std::vector<float>{0, 0, 1, 0, 0, 1});
    std::string text = builder.json(
        R"("images":[{"uri":"data:image/png;base64,)" + kRedPixel +
        R"("}],"textures":[{"source":0}],"materials":[{},{"name":"seat",)"
        R"("pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],"cameras":[{"type":"perspective","perspective":{"yfov":1}}],)"
        R"("extensions":{"KHR_lights_punctual":{"lights":[{"type":"point"}]}},)"
        R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":3},"material":1}]}],)"
        R"("nodes":[{"name":"legs","children":[1],"translation":[1,0,0],"camera":0,"extensions":{"KHR_lights_punctual":{"light":0}}},)"
        R"({"name":"seat","mesh":0}],"scenes":[{"nodes":[0]}],"animations":[{"name":"swing","samplers":[{"input":1,"output":2}],)"
        R"("channels":[{"sampler":0,"target":{"node":1,"path":"translation"}}]}])");
    const std::string version = R"("2.0")";
    return text.replace(text.find(version), version.size(), version + R"(,"extras":{"author":"Ada"})");
}

std::string room_with_assets(const std::string& files, const std::string& nodes) {
    GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 9, 0, 0, 0, 9, 0});
    return builder.json(R"("files":[)" + files +
                        R"(],"externalAssets":[{"file":0},{"file":1}],)"
                        R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0},)" +
                        nodes + "]");
}

Scene read_assets(const std::filesystem::path& path, Messages& messages) {
    return read_gltf(path, FileAccess(path, {}), {}, messages);
}

} // namespace

TEST_CASE("a node's transform is its parents' transforms times translation, rotation and scale, in this order") {
    const Scene scene = test::read_gltf_text(with_triangle(
        R"("nodes":[{"name":"parent","translation":[10,0,0],)" + kQuarterTurnAboutZ + R"(,"children":[1]},)" +
        R"({"name":"child","mesh":0,"translation":[0,5,0],)" + kQuarterTurnAboutZ + R"(,"scale":[2,3,4]}])"));
    REQUIRE(scene.instances.size() == 1);
    CHECK(scene.instances[0].name == "child");
    const Transform& m = scene.instances[0].world_from_local;
    // Child: scaled, turned by 90 degrees, moved up by 5. Parent: turned again, moved right by 10.
    CHECK(same_place(transform_point(m, {0, 0, 0}), {5, 0, 0}));
    CHECK(same_place(transform_point(m, {1, 0, 0}), {3, 0, 0}));
    CHECK(same_place(transform_point(m, {0, 1, 0}), {5, -3, 0}));
    CHECK(same_place(transform_point(m, {0, 0, 1}), {5, 0, 4}));
}

TEST_CASE("a node's matrix is read column by column") {
    const Scene scene = test::read_gltf_text(
        with_triangle(R"("nodes":[{"mesh":0,"matrix":[1,2,3,0, 4,5,6,0, 7,8,10,0, 11,12,13,1]}])"));
    CHECK(scene.instances.at(0).world_from_local == Transform{{1, 4, 7}, {2, 5, 8}, {3, 6, 10}, {11, 12, 13}});
}

TEST_CASE("several nodes with one mesh share it") {
    const Scene scene = test::read_gltf_text(
        with_triangle(R"("nodes":[{"mesh":0},{"mesh":0,"translation":[1,0,0]},{"mesh":0,"translation":[2,0,0]}])"));
    CHECK(scene.meshes.size() == 1);
    REQUIRE(scene.instances.size() == 3);
    CHECK(scene.instances[2].world_from_local.translation == Vec3{2, 0, 0});
}

TEST_CASE("EXT_mesh_gpu_instancing places one instance for each element, within the node") {
    GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    builder.add("VEC3", std::vector<float>{1, 0, 0, 2, 0, 0});
    builder.add("VEC4", std::vector<int16_t>{0, 0, 0, 32767, 0, 0, 32767, 0}, ",\"normalized\":true");
    builder.add("VEC3", std::vector<float>{1, 1, 1, 5, 6, 7});
    const Scene scene = test::read_gltf_text(builder.json(
        R"("extensionsRequired":["EXT_mesh_gpu_instancing"],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
        R"("nodes":[{"mesh":0,"translation":[0,10,0],"extensions":{"EXT_mesh_gpu_instancing":{"attributes":)"
        R"({"TRANSLATION":1,"ROTATION":2,"SCALE":3}}}}])"));
    CHECK(scene.meshes.size() == 1);
    REQUIRE(scene.instances.size() == 2);
    CHECK(scene.instances[0].world_from_local == Transform{.translation = {1, 10, 0}});
    CHECK(same_place(transform_point(scene.instances[1].world_from_local, {1, 1, 1}), {2 - 5, 10 - 6, 7}));
}

TEST_CASE("the scene property chooses the nodes, and without scenes all are used") {
    const std::string nodes = R"("nodes":[{"mesh":0,"name":"a"},{"mesh":0,"name":"b"},{"mesh":0,"name":"c"}])";
    const std::string scenes = R"("scenes":[{"nodes":[0]},{"nodes":[2,1]}],)";
    CHECK(test::read_gltf_text(with_triangle(nodes)).instances.size() == 3);
    CHECK(test::read_gltf_text(with_triangle(scenes + nodes)).instances.size() == 1);
    Messages messages;
    const Scene second = test::read_gltf_text(with_triangle("\"scene\":1," + scenes + nodes), messages);
    REQUIRE(second.instances.size() == 2);
    CHECK(second.instances[0].name == "c");
    CHECK(second.file_scene == 1);
    CHECK(messages.all().empty()); // open_scene reports which scene it is
}

TEST_CASE("children that make a cycle or have a second parent are left out with a warning that names the node") {
    CHECK(test::gltf_fault(only_nodes(R"("nodes":[{"children":[1]},{"children":[0]}])"))
              .starts_with("model.gltf: /nodes/0: "));
    CHECK(test::gltf_fault(only_nodes(R"("nodes":[{"children":[0]}])")).starts_with("model.gltf: /nodes/0: "));
    CHECK(test::gltf_fault(only_nodes(R"("nodes":[{"children":[2]},{"children":[2]},{}])"))
              .starts_with("model.gltf: /nodes/1/children/0: "));
}

TEST_CASE("a child that the scene lists occurs once, with its parent's transform") {
    const std::string nodes = R"("nodes":[{"children":[1],"translation":[1,0,0]},{"mesh":0,"translation":[0,2,0]}])";
    for (const std::string listed : {"[1]", "[0,1]", "[1,0]", "[1,1]"}) {
        CAPTURE(listed);
        Messages messages;
        const Scene scene =
            test::read_gltf_text(with_triangle(R"("scenes":[{"nodes":)" + listed + "}]," + nodes), messages);
        REQUIRE(scene.instances.size() == 1);
        CHECK(scene.instances[0].world_from_local.translation == to_float(DoubleVec3{1, 2, 0} - scene.origin_in_file));
        CHECK(messages.left_out().empty());
    }
}

TEST_CASE("a node with an unreadable transform has its parent's transform") {
    Messages messages;
    const Scene scene = test::read_gltf_text(
        with_triangle(
            R"("nodes":[{"mesh":0,"rotation":[0,0,0,0]},{"mesh":0,"matrix":[1]},{"mesh":9},{"mesh":0,"camera":5}])"),
        messages);
    REQUIRE(scene.instances.size() == 3);
    CHECK(scene.instances[0].world_from_local.translation == scene.instances[2].world_from_local.translation);
    CHECK(messages.left_out().size() == 4);
    CHECK(
        test::has_warning(messages, {"/nodes/0/rotation: expected a unit quaternion; /nodes/0/rotation is left out"}));
    CHECK(test::has_warning(messages, {"/nodes/2/mesh: 9", "the mesh of /nodes/2 is left out"}));
    CHECK(test::has_warning(messages, {"/nodes/3/camera: 5", "the camera of /nodes/3 is left out"}));
}

TEST_CASE("a chain of two hundred thousand nodes is read without recursion") {
    constexpr int length = 200'000;
    std::string nodes = R"("nodes":[{"mesh":0})";
    for (int i = 1; i < length; ++i) nodes += R"(,{"children":[)" + std::to_string(i - 1) + "]}";
    CHECK(test::read_gltf_text(with_triangle(nodes + "]")).instances.size() == 1);
}

TEST_CASE("cameras keep their angle, height and aspect, and lose their node's scale") {
    const Scene scene = test::read_gltf_text(only_nodes(
        R"("cameras":[{"name":"p","type":"perspective","perspective":{"yfov":0.75,"aspectRatio":1.5,"znear":0.1}},)"
        R"({"type":"orthographic","orthographic":{"xmag":3,"ymag":2,"znear":0,"zfar":9}}],)"
        R"("nodes":[{"camera":0,"translation":[1,2,3],"scale":[2,-3,4],)" +
        kQuarterTurnAboutZ + R"(},{"camera":1,"name":"o"}])"));
    REQUIRE(scene.cameras.size() == 2);
    const Camera &perspective = scene.cameras[0], &orthographic = scene.cameras[1];
    CHECK(perspective.name == "p");
    CHECK(perspective.projection == Projection::Perspective);
    CHECK(perspective.fov_y == 0.75f);
    CHECK(perspective.aspect == 1.5f);
    CHECK(perspective.world_from_camera.translation == Vec3{1, 2, 3});
    CHECK(same_place(column(perspective.world_from_camera, 1),
                     {1, 0, 0})); // the rotation takes +y to -x, and the scale mirrors
    CHECK(same_place(column(perspective.world_from_camera, 2), {0, 0, 1}));
    CHECK(determinant(perspective.world_from_camera) == doctest::Approx(1));
    CHECK(orthographic.name == "o");
    CHECK(orthographic.projection == Projection::Orthographic);
    CHECK(orthographic.ortho_height == 4.0f);
    CHECK(orthographic.aspect == 1.5f);
    CHECK(orthographic.world_from_camera == Transform());
}

TEST_CASE("punctual lights shine along their node's -z, and candela and lux are used without a factor") {
    Messages messages;
    const Scene scene = test::read_gltf_text(
        only_nodes(
            R"("extensionsUsed":["KHR_lights_punctual"],"extensions":{"KHR_lights_punctual":{"lights":[)"
            R"({"type":"point","color":[1,0.5,0.25],"intensity":8,"range":7},)"
            R"({"name":"s","type":"spot","spot":{"innerConeAngle":0.5,"outerConeAngle":1}},)"
            R"({"type":"directional","intensity":3},{"type":"spot"}]}},"nodes":[)"
            R"({"name":"p","translation":[1,2,3],"extensions":{"KHR_lights_punctual":{"light":0}}},)"
            R"({"rotation":[0.70710678,0,0,0.70710678],"scale":[5,5,5],"extensions":{"KHR_lights_punctual":{"light":1}}},)"
            R"({"extensions":{"KHR_lights_punctual":{"light":2}}},{"extensions":{"KHR_lights_punctual":{"light":3}}}])"),
        messages);
    CHECK(messages.all().empty());
    REQUIRE(scene.lights.size() == 4);
    CHECK(scene.lights[0].name == "p");
    CHECK(scene.lights[0].kind == LightKind::Point);
    CHECK(scene.lights[0].position == Vec3{1, 2, 3});
    CHECK(scene.lights[0].intensity == Rgb{8, 4, 2});
    CHECK(scene.lights[0].range == 7.0f);
    CHECK(scene.lights[1].name == "s");
    CHECK(scene.lights[1].kind == LightKind::Spot);
    CHECK(same_place(scene.lights[1].direction, {0, 1, 0})); // -z turned by +90 degrees about x
    CHECK(scene.lights[1].intensity == Rgb{1, 1, 1});
    CHECK(scene.lights[1].cos_inner == doctest::Approx(std::cos(0.5)).epsilon(1e-6));
    CHECK(scene.lights[1].cos_outer == doctest::Approx(std::cos(1.0)).epsilon(1e-6));
    CHECK(scene.lights[2].kind == LightKind::Directional);
    CHECK(scene.lights[2].direction == Vec3{0, 0, -1});
    CHECK(scene.lights[2].intensity == Rgb{3, 3, 3});
    CHECK(scene.lights[3].cos_inner == 1.0f);
    CHECK(scene.lights[3].cos_outer == doctest::Approx(std::sqrt(0.5)).epsilon(1e-6));
}

TEST_CASE("a spot with equal cone angles has a sharp edge and a warning; invalid cones are clamped with a warning") {
    const auto spot = [](const std::string& cone) {
        return only_nodes(R"("extensions":{"KHR_lights_punctual":{"lights":[{"type":"spot","spot":{)" + cone +
                          R"(}}]}},"nodes":[{"extensions":{"KHR_lights_punctual":{"light":0}}}])");
    };
    for (const std::string angle : {"0.785398163", "1.5707964", "1e-5", "1e-30"}) {
        CAPTURE(angle);
        Messages messages;
        const Scene scene =
            test::read_gltf_text(spot("\"innerConeAngle\":" + angle + ",\"outerConeAngle\":" + angle), messages);
        const Light& light = scene.lights.at(0);
        CHECK(test::has_warning(messages, {"model.gltf: /extensions/KHR_lights_punctual/lights/0/spot: "}));
        CHECK(light.cos_inner == doctest::Approx(std::cos(std::stod(angle))).epsilon(1e-6));
        CHECK(light.cos_outer < light.cos_inner); // required by validate()
        CHECK(light.cos_outer >= light.cos_inner - 2e-7f);
    }
    // The cone is so narrow that both cosines are 1.
    const Light narrow = test::read_gltf_text(spot(R"("outerConeAngle":1e-5)")).lights.at(0);
    CHECK(narrow.cos_outer < narrow.cos_inner);

    const std::string place = "model.gltf: /extensions/KHR_lights_punctual/lights/0/spot: cone angles ";
    struct Case {
        const char* cone;
        double inner, outer;
    };
    for (const auto& [cone, inner, outer] :
         {Case{R"("innerConeAngle":1)", M_PI / 4, M_PI / 4}, Case{R"("innerConeAngle":-1)", 0, M_PI / 4},
          Case{R"("outerConeAngle":0)", 0, 0x1p-10},
          Case{R"("innerConeAngle":0.5,"outerConeAngle":1.6)", 0.5, M_PI / 2},
          Case{R"("innerConeAngle":0.5,"outerConeAngle":3.5e38)", 0.5, M_PI / 2}}) {
        CAPTURE(cone);
        Messages messages;
        const Light light = test::read_gltf_text(spot(cone), messages).lights.at(0);
        CHECK(test::has_warning(messages, {place}));
        CHECK(messages.left_out().empty()); // the light is in the scene
        CHECK(light.cos_inner == doctest::Approx(std::cos(inner)).epsilon(1e-6));
        CHECK(std::abs(static_cast<double>(light.cos_outer) - std::cos(outer)) < 1e-6);
        CHECK(light.cos_outer < light.cos_inner);
    }
}

TEST_CASE("a light with negative intensity gives no light, with a warning that has the number's pointer") {
    const auto read = [](const std::string& members, const std::string& place) {
        Messages messages;
        const Scene scene = test::read_gltf_text(
            only_nodes(R"("extensions":{"KHR_lights_punctual":{"lights":[{"type":"point",)" + members +
                       R"(}]}},"nodes":[{"extensions":{"KHR_lights_punctual":{"light":0}}}])"),
            messages);
        CHECK(test::has_warning(messages, {"model.gltf: /extensions/KHR_lights_punctual/lights/0/" + place}));
        return scene.lights.at(0).intensity;
    };
    CHECK(read(R"("intensity":-1)", "intensity: -1") == grey(0));
    CHECK(read(R"("color":[1,-0.5,0])", "color/1: -0.5") == Rgb{1, 0, 0});
}

TEST_CASE("instances, cameras and lights record their location in the file") {
    const Scene scene = test::read_gltf_text(
        with_triangle(R"("materials":[{},{}],"cameras":[{"type":"perspective","perspective":{"yfov":1}}],)"
                      R"("extensions":{"KHR_lights_punctual":{"lights":[{"type":"point"}]}},"nodes":[{},{"mesh":0},)"
                      R"({"camera":0},{"extensions":{"KHR_lights_punctual":{"light":0}}}])"));
    CHECK(scene.instances.at(0).node == 1);
    CHECK(scene.meshes.at(0).origin == "/meshes/0/primitives/0");
    CHECK(scene.cameras.at(0).origin == "/nodes/2");
    CHECK(scene.lights.at(0).origin == "/nodes/3");
}

TEST_CASE("an error for a file without meshes lists its content") {
    const auto reason_of = [](const std::string& text) { return test::read_gltf_text(text).no_instances; };
    CHECK(reason_of(with_triangle(R"("nodes":[{"mesh":0}])")).empty());
    CHECK(reason_of(with_triangle(R"("nodes":[{},{}])")) ==
          "/nodes: the scene has 2 nodes, and none of them uses a mesh (the file has 1); expected a \"mesh\" in one of "
          "them");
    CHECK(reason_of(with_triangle(R"("scenes":[{"nodes":[1]}],"nodes":[{"mesh":0},{}])"))
              .starts_with("/nodes: the scene has 1 node,"));
    CHECK(reason_of(only_nodes(R"("nodes":[{}])")).starts_with("/meshes: the file has no meshes"));
    CHECK(reason_of(only_nodes(R"("meshes":[{"primitives":[{"attributes":{}}]}],"nodes":[{"mesh":0}])"))
              .starts_with("/meshes: no mesh that a node of the scene uses has a triangle"));
}

TEST_CASE("a skinned mesh follows its joints and not its own node") {
    GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    builder.add("VEC3", std::vector<float>{0, 0, 1, 1, 0, 0, 0, 0, 1});
    builder.add("VEC4", std::vector<uint8_t>{0, 1, 0, 0, 1, 0, 0, 9, 1, 0, 0, 0}); // the 9 has no weight
    builder.add("VEC4", std::vector<float>{0.5f, 0.5f, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
    builder.add("MAT4", std::vector<float>{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -7, 0, 0, 1, //
                                           1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0,  0, 0, 1});
    Messages messages;
    const Scene scene = test::read_gltf_text(
        builder.json(
            R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":1,"JOINTS_0":2,"WEIGHTS_0":3}}]}],)"
            R"("skins":[{"joints":[1,2],"inverseBindMatrices":4}],"animations":[],"nodes":[)"
            R"({"mesh":0,"skin":0,"translation":[1000,0,0]},{"translation":[7,2,0]},{"translation":[0,0,4],)" +
            kQuarterTurnAboutZ + "}]"),
        messages);
    const Mesh& mesh = scene.meshes.at(0);
    CHECK(scene.instances.at(0).world_from_local == Transform());
    // Joint 0 with its inverse bind matrix lifts by 2 in y; joint 1 turns about z and lifts by 4 in z.
    CHECK(same_place(mesh.positions[0], {0, 1, 2}));
    CHECK(same_place(mesh.positions[1], {0, 1, 4}));
    CHECK(same_place(mesh.positions[2], {-1, 0, 4}));
    CHECK(same_place(mesh.normals[1], {0, 1, 0}));
    CHECK(mesh.indices == std::vector<uint32_t>{0, 1, 2});
}

TEST_CASE("a joint index beyond the skin is an error with the attribute's pointer") {
    GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    builder.add("VEC4", std::vector<uint16_t>{0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0});
    builder.add("VEC4", std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
    CHECK(test::gltf_fault(
              builder.json(R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"JOINTS_0":1,"WEIGHTS_0":2}}]}],)"
                           R"("skins":[{"joints":[1]}],"nodes":[{"mesh":0,"skin":0},{}])"))
              .starts_with("model.gltf: /meshes/0/primitives/0/attributes/JOINTS_0: "));
}

TEST_CASE("morph targets are added with the node's weights, or the mesh's if it has none") {
    GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    builder.add("VEC3", std::vector<float>{0, 0, 8, 0, 0, 0, 0, 0, 0});
    builder.add("VEC3", std::vector<float>{0, 0, 0, 0, 0, 16, 0, 0, 0});
    builder.add("VEC3", std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1});
    builder.add("VEC3", std::vector<float>{4, 0, -4, 0, 0, 0, 0, 0, 0});
    Messages messages;
    const Scene scene = test::read_gltf_text(
        builder.json(R"("meshes":[{"weights":[0.25,0],"primitives":[{"attributes":{"POSITION":0,"NORMAL":3},)"
                     R"("targets":[{"POSITION":1,"NORMAL":4},{"POSITION":2}]}]}],)"
                     R"("nodes":[{"mesh":0},{"mesh":0,"weights":[0,0.5]},{"mesh":0}])"),
        messages);
    REQUIRE(scene.meshes.size() == 2);
    CHECK(scene.meshes[0].positions == std::vector<Vec3>{{0, 0, 2}, {1, 0, 0}, {0, 1, 0}});
    CHECK(scene.meshes[0].normals == std::vector<Vec3>{{1, 0, 0}, {0, 0, 1}, {0, 0, 1}});
    CHECK(scene.meshes[1].positions == std::vector<Vec3>{{0, 0, 0}, {1, 0, 8}, {0, 1, 0}});
    CHECK(scene.instances[0].mesh == scene.instances[2].mesh);
}

TEST_CASE("each author of files that others show is named once, and their aliases are left out once") {
    const std::filesystem::path at = asset_folder();
    const auto by = [](const char* author, std::string text) {
        const std::string version = R"("2.0")";
        return text.replace(text.find(version), version.size(),
                            version + R"(,"extras":{"author":")" + author + R"("})");
    };
    const auto file = [](const char* name) {
        return fmt::format(R"({{"uri":"{}","mimeType":"model/gltf+json","aliases":[]}})", name);
    };
    const std::string shown = R"({"externalAsset":0},{"externalAsset":1},{"externalAsset":1})";
    for (const auto& [name, author] : {std::pair{"a.gltf", "Anna"}, {"b.gltf", "Ann"}, {"c.gltf", "Bob"}})
        test::write_text(at / name, by(author, room_with_assets("", "{}")));
    test::write_text(at / "inner.gltf", by("Bo", room_with_assets(file("a.gltf") + "," + file("b.gltf"), shown)));
    test::write_text(at / "outer.gltf", by("Anna", room_with_assets(file("c.gltf") + "," + file("inner.gltf"), shown)));
    Messages messages;
    const Scene scene = read_assets(at / "outer.gltf", messages);
    REQUIRE(scene.suggested.size() == 1);
    CHECK(scene.suggested[0].text == "Anna; Bob; Bo; Ann");
    CHECK(messages.left_out().size() == 4);
    for (const Message& message : messages.all()) CHECK(message.times == 1);
}

TEST_CASE("an external asset is shown by nodes, with its own materials, textures, lights, cameras and animations") {
    const std::filesystem::path at = asset_folder();
    test::write_text(at / "parts/chair.gltf", chair_asset());
    const std::string uri = R"({"uri":"parts/chair.gltf","mimeType":"model/gltf+json"})";
    const std::filesystem::path outer = test::write_text(
        at / "room.gltf",
        room_with_assets(uri, R"({"externalAsset":0,"translation":[0,2,0],"scale":[2,2,2]},{"externalAsset":0},)"
                              R"({"externalAsset":0,"extensions":{"KHR_node_visibility":{"visible":false}}})"));
    Messages messages;
    Scene scene = read_assets(outer, messages);
    CHECK(messages.left_out().empty());
    CHECK(scene.meshes.size() == 2); // both copies have one
    CHECK(scene.images.size() == 1);
    REQUIRE(scene.suggested.size() == 1);
    CHECK(scene.suggested[0].text == "Ada");
    CHECK(scene.nodes.size() == 4 + 2 * 3);
    REQUIRE(scene.instances.size() == 3);
    CHECK(scene.instances[0].name.empty());
    for (const std::size_t i : {1, 2}) {
        const Instance& seat = scene.instances[i];
        CHECK(seat.mesh == 1);
        CHECK(scene.nodes.at(seat.node).name == "seat");
        const Material& material = scene.materials.at(seat.material);
        CHECK(material.name == "seat");
        CHECK(material.base_color_texture.image == 0);
        CHECK(scene.cameras.at(i - 1).world_from_camera.translation.x == (i == 1 ? 2 : 1));
    }
    CHECK(transform_point(scene.instances[1].world_from_local, {1, 0, 0}) == Vec3{4, 2, 0});
    CHECK(transform_point(scene.instances[2].world_from_local, {1, 0, 0}) == Vec3{2, 0, 0});
    REQUIRE(scene.lights.size() == 2);
    CHECK(scene.lights[0].position == Vec3{2, 2, 0});
    CHECK(scene.lights[1].position == Vec3{1, 0, 0});
    CHECK(scene.animations.size() == 2);
    CHECK(column(scene.cameras[0].world_from_camera, 2) == Vec3{0, 0, 1});
    PosedScene posed(std::move(scene));
    posed.set_time(1);
    CHECK(transform_point(posed.scene().instances[1].world_from_local, {1, 0, 0}) == Vec3{4, 2, 10});
    CHECK(transform_point(posed.scene().instances[2].world_from_local, {1, 0, 0}) == Vec3{2, 0, 5});

    // A room that shows the first one, and a chair that is inside it.
    const std::string text = chair_asset();
    const std::string inside = R"({"mimeType":"model/gltf+json","uri":"data:model/gltf+json;base64,)" +
                               test::base64(std::as_bytes(std::span(text))) + R"("})";
    const std::filesystem::path house = test::write_text(
        at / "house.gltf",
        room_with_assets(R"({"uri":"room.gltf","mimeType":"model/gltf+json"},)" + inside,
                         R"({"externalAsset":0,"rotation":[0,1,0,0]},{"externalAsset":1,"translation":[0,0,7]})"));
    const Scene nested = read_assets(house, messages);
    CHECK(messages.left_out().empty());
    REQUIRE(nested.instances.size() == 5);
    CHECK(length(transform_point(nested.instances[2].world_from_local, {1, 0, 0}) - Vec3{-4, 2, 0}) < 1e-6f);
    CHECK(transform_point(nested.instances[4].world_from_local, {1, 0, 0}) == Vec3{2, 0, 7});
    for (const std::size_t i : {2, 3, 4})
        CHECK(nested.materials.at(nested.instances[i].material).base_color_texture.image == (i < 4 ? 0 : 1));
    for (const Node& node : nested.nodes) CHECK((node.parent == kNoNode || node.parent < nested.nodes.size()));
}

TEST_CASE("a node that an animation may show hides an external asset at rest") {
    const std::filesystem::path at = asset_folder();
    test::write_text(at / "chair.gltf", chair_asset());
    Messages messages;
    const Scene scene = read_assets(
        test::write_text(
            at / "room.gltf",
            room_with_assets(
                R"({"uri":"chair.gltf","mimeType":"model/gltf+json"})",
                R"({"externalAsset":0,"extensions":{"KHR_node_visibility":{"visible":false}}}],)"
                R"("animations":[{"channels":[{"sampler":0,"target":{"path":"pointer","extensions":)"
                R"({"KHR_animation_pointer":{"pointer":"/nodes/1/extensions/KHR_node_visibility/visible"}}}}]})")),
        messages);
    CHECK_FALSE(scene.instances.at(0).is_hidden);
    CHECK((scene.instances.at(1).is_hidden && scene.lights.at(0).is_hidden));
}

TEST_CASE("external assets that show themselves, are damaged, missing or in other folders are left out") {
    const std::filesystem::path at = asset_folder();
    const auto shows = [&](const std::string& name, const std::string& other) {
        return test::write_text(
            at / name,
            room_with_assets(R"({"uri":")" + other + R"(","mimeType":"model/gltf+json"})", R"({"externalAsset":0})"));
    };
    test::write_text(at / "parts/bad.gltf", "no JSON");
    test::write_text(at / "chair.gltf", chair_asset());
    const auto left_out = [&](const std::filesystem::path& path) {
        Messages messages;
        CHECK(read_assets(path, messages).instances.size() == (path.stem() == "a" ? 2 : 1));
        const std::vector<std::string> texts = messages.left_out();
        REQUIRE(texts.size() == 1);
        return texts[0];
    };
    shows("b.gltf", "a.gltf");
    CHECK(left_out(shows("a.gltf", "b.gltf")).find("shows itself") != std::string::npos);
    CHECK(left_out(shows("itself.gltf", "./itself.gltf")).find("shows itself") != std::string::npos);
    left_out(shows("c.gltf", "parts/bad.gltf"));
    left_out(shows("d.gltf", "parts/none.gltf"));
    left_out(shows("parts/outside.gltf", "../chair.gltf"));
    left_out(test::write_text(at / "e.gltf", room_with_assets("", R"({"externalAsset":0})")));
    left_out(test::write_text(at / "f.gltf", room_with_assets("", R"({"externalAsset":5})")));

    // A file that is missing is looked for once, and does not count for those that are there.
    test::write_text(at / "parts/chair.gltf", chair_asset());
    std::string nodes;
    for (int i = 0; i < 5000; ++i) nodes += R"({"externalAsset":0},)";
    const std::filesystem::path many =
        test::write_text(at / "many.gltf", room_with_assets(R"({"uri":"none.gltf"},{"uri":"parts/chair.gltf"})",
                                                            nodes + R"({"externalAsset":1})"));
    Messages messages;
    CHECK(read_assets(many, messages).instances.size() == 2);
    CHECK(messages.left_out().size() == 1);
}
