// Nodes, skins and animations that the glTF reader returns, and files with invalid animations.

#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "base/error.h"
#include "scene/pose/posed_scene.h"
#include "scene/validate/validate_parts.h"
#include "tests/support/gltf_builder.h"

using namespace pertev;
using test::GltfBuilder;

namespace {

/// Accessors: 0 positions, 1 times 0 1 2, 2 three VEC3, 3 three VEC4, 4 nine VEC3, 5 six scalars, 6 times that fall,
/// 7 normalized VEC4 of bytes, 8 VEC4 with a 0, 9 two VEC3.
GltfBuilder numbers() {
    GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    builder.add("SCALAR", std::vector<float>{0, 1, 2});
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 2, 3, 4, 5, 6});
    builder.add("VEC4", std::vector<float>{0, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 0});
    builder.add("VEC3", std::vector<float>(27, 1.5f));
    builder.add("SCALAR", std::vector<float>{0, 1, 0.5f, 0.5f, 1, 0});
    builder.add("SCALAR", std::vector<float>{0, 2, 1});
    builder.add("VEC4", std::vector<int8_t>{0, 0, 0, 127, 0, 0, 127, 0, 127, 0, 0, 0}, R"(,"normalized":true)");
    builder.add("VEC4", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0});
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 2, 3});
    return builder;
}

/// Node 0 holds node 2, node 1 has a matrix and the mesh's morph targets, node 2 the mesh with a skin of joint 0.
std::string file(const std::string& samplers, const std::string& channels) {
    return numbers().json(
        R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"targets":[{"POSITION":2},{"POSITION":2}]}],)"
        R"("weights":[0.25]},{"primitives":[{"attributes":{"POSITION":0}}]}],"skins":[{"joints":[0]}],"nodes":[)"
        R"({"name":"root","children":[2],"translation":[1,2,3],"scale":[2,2,2]},)"
        R"({"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,7,8,9,1]},{"mesh":1,"skin":0}],)"
        R"("animations":[{"name":"walk","samplers":[)" +
        samplers + R"(],"channels":[)" + channels + "]}]");
}

std::string sampler(int input, int output, const std::string& more = "") {
    return R"({"input":)" + std::to_string(input) + R"(,"output":)" + std::to_string(output) + more + "}";
}

std::string channel(int node, const std::string& path, int number = 0) {
    return R"({"sampler":)" + std::to_string(number) + R"(,"target":{"node":)" + std::to_string(node) + R"(,"path":")" +
           path + R"("}})";
}

} // namespace

TEST_CASE("a glTF file's nodes keep their indices, parents and poses") {
    Messages messages;
    const Scene scene = test::read_gltf_text(file("", ""), messages);
    REQUIRE(scene.nodes.size() == 3);
    CHECK(scene.nodes[0].name == "root");
    CHECK(scene.nodes[0].parent == kNoNode);
    CHECK(std::get<NodePose>(scene.nodes[0].pose).translation == DoubleVec3{1, 2, 3});
    CHECK(std::get<NodePose>(scene.nodes[0].pose).scale == DoubleVec3{2, 2, 2});
    CHECK(std::get<DoubleTransform>(scene.nodes[1].pose).translation == DoubleVec3{7, 8, 9});
    CHECK(scene.nodes[1].morph_weights == std::vector<float>{0.25f, 0});
    CHECK(scene.nodes[2].parent == 0);
    CHECK(scene.nodes[2].skin == 0);
    CHECK(scene.skins.at(0).joints == std::vector<uint32_t>{0});
    for (const Instance& instance : scene.instances) CHECK(instance.mesh == (instance.node == 1 ? 1u : 0u));
}

TEST_CASE("animation channels are read with their key frames") {
    Messages messages;
    const Scene scene = test::read_gltf_text(
        file(sampler(1, 2) + "," + sampler(1, 7, R"(,"interpolation":"STEP")") + "," +
                 sampler(1, 4, R"(,"interpolation":"CUBICSPLINE")") + "," + sampler(1, 5),
             channel(0, "translation") + "," + channel(0, "rotation", 1) + "," + channel(2, "scale", 2) + "," +
                 channel(1, "weights", 3) + R"(,{"sampler":0,"target":{"path":"pointer"}})"),
        messages);
    REQUIRE(scene.animations.size() == 1);
    CHECK(scene.animations[0].name == "walk");
    CHECK(scene.animations[0].origin == "/animations/0");
    const std::vector<AnimationChannel>& channels = scene.animations[0].channels;
    REQUIRE(channels.size() == 4);
    CHECK(channels[0].target == 0);
    CHECK(channels[0].part == AnimatedPart::Translation);
    CHECK(channels[0].interpolation == Interpolation::Linear);
    CHECK(channels[0].times == std::vector<float>{0, 1, 2});
    CHECK(channels[0].values == std::vector<float>{0, 0, 0, 1, 2, 3, 4, 5, 6});
    CHECK(channels[1].part == AnimatedPart::Rotation);
    CHECK(channels[1].interpolation == Interpolation::Step);
    CHECK(channels[1].values == std::vector<float>{0, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 0});
    CHECK(channels[2].interpolation == Interpolation::CubicSpline);
    CHECK(channels[2].values.size() == 27);
    CHECK(channels[3].part == AnimatedPart::Weights);
    CHECK(channels[3].values.size() == 6);
    CHECK(std::ranges::any_of(messages.all(), [](const Message& message) {
        return message.text.find("/animations/0/channels/4/target: ") != std::string::npos;
    }));
    CHECK_NOTHROW(validate_nodes(scene, "file"));
}

TEST_CASE("animation channels with invalid numbers are left out with a warning that names them") {
    const auto left_out = [](const std::string& samplers, const std::string& channels, const std::string& why) {
        Messages messages;
        const Scene scene = test::read_gltf_text(file(samplers, channels), messages);
        CHECK(scene.animations.at(0).channels.empty());
        CHECK(test::has_warning(messages, {"/animations/0/channels/0", why, "the channel is left out"}));
    };
    left_out(sampler(1, 8), channel(0, "rotation"), "the rotation of key 1 is 0");
}

TEST_CASE("an animation channel that the format does not allow is left out with its pointer, and the others play") {
    const auto check = [](const std::string& samplers, const std::string& channels, const std::string& message) {
        CAPTURE(message);
        const std::string error = test::gltf_fault(file(samplers, channels));
        CAPTURE(error);
        CHECK(error.find(message) != std::string::npos);
        Messages messages; // the next channel is kept
        const std::string good = channel(2, "scale", 7);
        const std::string others = sampler(1, 2);
        const std::string padded = samplers + "," + others + "," + others + "," + others + "," + others + "," + others +
                                   "," + others + "," + others;
        const Scene scene = test::read_gltf_text(file(padded, channels + "," + good), messages);
        REQUIRE(!scene.animations.at(0).channels.empty());
        CHECK(scene.animations[0].channels.back().target == 2);
    };
    const std::string at = "model.gltf: /animations/0/channels/0";
    check(sampler(1, 2), channel(3, "translation"), at + "/target/node: 3; expected an index");
    check(sampler(1, 2), channel(0, "colour"), at + "/target/path: \"colour\"; expected translation");
    check(sampler(1, 2), channel(1, "translation"), at + "/target: node 1 has a matrix");
    check(sampler(1, 5), channel(0, "weights"), at + "/target: the mesh of node 0 has no morph targets");
    check(sampler(1, 2), channel(0, "translation", 99), at + "/sampler: 99; expected an index into \"samplers\"");
    check(sampler(1, 2), channel(0, "scale") + "," + channel(0, "scale"), "channels/1/target: an earlier channel");
    const std::string of = "model.gltf: /animations/0/samplers/0";
    check(sampler(99, 2), channel(0, "scale"), of + "/input: 99; expected an index into \"accessors\"");
    check(sampler(2, 2), channel(0, "scale"), of + "/input: the accessor's type is VEC3; expected SCALAR");
    check(sampler(1, 3), channel(0, "scale"), of + "/output: the accessor's type is VEC4; expected VEC3");
    check(sampler(1, 9), channel(0, "scale"), of + "/output: 2 elements for 3 key times");
    check(sampler(1, 2, R"(,"interpolation":"CUBICSPLINE")"), channel(0, "scale"), of + "/output: 3 elements");
    check(sampler(1, 2, R"(,"interpolation":"SMOOTH")"), channel(0, "scale"), of + "/interpolation: \"SMOOTH\"");
}

TEST_CASE("validate_nodes refuses graphs that readers must not produce") {
    const auto refused = [](auto&& spoil, const std::string& message) {
        Messages messages;
        Scene scene = test::read_gltf_text(file(sampler(1, 2), channel(0, "translation")), messages);
        spoil(scene);
        CHECK_THROWS_WITH_AS(validate_nodes(scene, "file"), doctest::Contains(message.c_str()), Error);
    };
    refused([](Scene& s) { s.nodes[1].parent = 3; }, "node 3 is out of range; there are 3");
    refused([](Scene& s) { s.nodes[0].parent = 2; }, "2 of 3 nodes");
    refused([](Scene& s) { s.nodes[2].skin = 1; }, "skin 1 is out of range");
    refused([](Scene& s) { s.skins[0].joints = {3}; }, "joint 3 is out of range");
    refused([](Scene& s) { s.instances[0].node = 3; }, "node 3 is out of range");
    refused([](Scene& s) { s.lights.push_back({.name = "lamp", .node = 9}); }, "lamp: node 9 is out of range");
    refused([](Scene& s) { s.cameras.push_back({.name = "eye", .node = 9}); }, "eye: node 9 is out of range");
    refused([](Scene& s) { std::get<NodePose>(s.nodes[0].pose).scale.y = kInfinity; }, "its transform is not finite");
    refused([](Scene& s) { s.nodes[1].morph_weights[0] = kInfinity; }, "a morph weight is not finite");
    refused([](Scene& s) { s.animations[0].channels[0].target = 3; }, "channel 0: node 3 is out of range");
    refused([](Scene& s) { s.animations[0].channels[0].times[1] = -1; }, "channel 0: key time 1 is -1");
    refused([](Scene& s) { s.animations[0].channels[0].values.pop_back(); }, "8 numbers for 3 key times; expected 9");
    refused([](Scene& s) { s.animations[0].channels[0].values[4] = kInfinity; }, "number 4 of its values");
    refused([](Scene& s) { s.animations[0].channels[0].times.clear(); }, "it has no key times");
}

TEST_CASE("KHR_animation_pointer animates nodes, views and lights, and other targets are named and left out") {
    GltfBuilder builder = numbers();
    builder.add("SCALAR", std::vector<float>{1, 0.5f, 0.25f}); // 10
    const auto pointer = [](const std::string& to, int number) {
        return R"({"sampler":)" + std::to_string(number) +
               R"(,"target":{"path":"pointer","extensions":{"KHR_animation_pointer":{"pointer":")" + to + R"("}}}})";
    };
    const auto document = [&](const std::string& channels) {
        return builder.json(
            R"("extensionsUsed":["KHR_lights_punctual","KHR_animation_pointer","EXT_lights_ies"],"extensions":{)"
            R"("EXT_lights_ies":{"lights":[{"uri":"data:,TILT=NONE%0A1 1 1 2 1 1 1 0 0 0 1 1 1 0 90 0 9 9"}]},)"
            R"("KHR_lights_punctual":{"lights":[{"type":"point","color":[0.5,1,0.25],"intensity":2}]}},)"
            R"("cameras":[{"type":"perspective","perspective":{"yfov":1}}],)"
            R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
            R"("nodes":[{"mesh":0},{"camera":0},{"camera":0},{"extensions":{"KHR_lights_punctual":{"light":0},"EXT_lights_ies":{"light":0}}},{"extensions":{"EXT_lights_ies":{"light":0}}}],)"
            R"("animations":[{"samplers":[)" +
            sampler(1, 2) + "," + sampler(1, 10) + R"(],"channels":[)" + channels + "]}]");
    };
    const std::string light = "/extensions/KHR_lights_punctual/lights/0/";
    Messages messages;
    const Scene scene = test::read_gltf_text(
        document(pointer("/nodes/0/translation", 0) + "," + pointer("/cameras/0/perspective/yfov", 1) + "," +
                 pointer(light + "intensity", 1) + "," + pointer("/materials/0/alphaCutoff", 1) + "," +
                 pointer("/nodes/9/scale", 0)),
        messages);
    const std::vector<AnimationChannel>& channels = scene.animations.at(0).channels;
    REQUIRE(channels.size() == 4); // two nodes hold the camera
    CHECK(channels[0].part == AnimatedPart::Translation);
    CHECK(channels[0].target == 0);
    CHECK(channels[1].part == AnimatedPart::CameraFov);
    CHECK(channels[1].values == std::vector<float>{1, 0.5f, 0.25f});
    CHECK(channels[1].target == 0);
    CHECK(channels[2].target == 1);
    CHECK(channels[3].part == AnimatedPart::LightIntensity);
    REQUIRE(scene.lights.size() == 3); // two of EXT_lights_ies
    CHECK(scene.lights[channels[3].target].kind == LightKind::Point);
    CHECK(channels[3].values == std::vector<float>{0.5f, 1, 0.25f, 0.25f, 0.5f, 0.125f, 0.125f, 0.25f, 0.0625f});
    CHECK(test::has_warning(messages, {"/animations/0/channels/3", "/materials/0/alphaCutoff", "is not animated"}));
    CHECK(test::has_warning(messages, {"/animations/0/channels/4", "/nodes/9/scale"}));

    const Scene others =
        test::read_gltf_text(document(pointer(light + "range", 1) + "," + pointer(light + "spot/innerConeAngle", 1) +
                                      "," + pointer("/cameras/0/orthographic/ymag", 1)),
                             messages);
    const std::vector<AnimationChannel>& numbers_of = others.animations.at(0).channels;
    REQUIRE(numbers_of.size() == 4);
    CHECK(numbers_of[0].part == AnimatedPart::LightRange);
    CHECK(numbers_of[0].values == std::vector<float>{1, 0.5f, 0.25f});
    CHECK(numbers_of[1].part == AnimatedPart::LightInnerCone);
    CHECK(numbers_of[2].part == AnimatedPart::CameraHeight);
    CHECK(numbers_of[3].values == std::vector<float>{2, 1, 0.5f}); // to both sides of the centre

    const Scene colored = test::read_gltf_text(document(pointer(light + "color", 0)), messages);
    CHECK(colored.animations.at(0).channels.at(0).values == std::vector<float>{0, 0, 0, 2, 4, 6, 8, 10, 12});
    test::read_gltf_text(document(pointer(light + "color", 0) + "," + pointer(light + "intensity", 1)), messages);
    CHECK(test::has_warning(messages, {"colour and intensity of one light"}));
}

TEST_CASE("KHR_animation_pointer animates numbers of materials, within their ranges, and emission with its strength") {
    GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});     // 0
    builder.add("SCALAR", std::vector<float>{0, 1});                        // 1
    builder.add("SCALAR", std::vector<float>{0.25f, 2});                    // 2
    builder.add("VEC3", std::vector<float>{0, 0, 0, 0.5f, 0.25f, 1});       // 3
    builder.add("VEC4", std::vector<float>{1, 1, 1, 1, 0, 0.5f, 1, 0.25f}); // 4
    builder.add("SCALAR", std::vector<float>{0, 1.5f});                     // 5
    const auto channel = [](const std::string& to, int number) {
        return R"({"sampler":)" + std::to_string(number) +
               R"(,"target":{"path":"pointer","extensions":{"KHR_animation_pointer":{"pointer":"/materials/)" + to +
               R"("}}}})";
    };
    const auto document = [&](const std::string& channels) {
        return builder.json(
            R"("extensionsUsed":["KHR_animation_pointer","KHR_materials_ior"],"materials":[{},{"emissiveFactor":[1,0.5,0],"extensions":)"
            R"({"KHR_materials_emissive_strength":{"emissiveStrength":4},"KHR_materials_dispersion":{"dispersion":2}}}],)"
            R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":1}]}],"nodes":[{"mesh":0}],)"
            R"("animations":[{"samplers":[)" +
            sampler(1, 2) + "," + sampler(1, 3) + "," + sampler(1, 4) + "," + sampler(1, 5) + R"(],"channels":[)" +
            channels + "]}]");
    };
    Messages messages;
    const std::string emission = "1/emissiveFactor",
                      strength = "1/extensions/KHR_materials_emissive_strength/emissiveStrength";
    PosedScene posed(test::read_gltf_text(document(channel("1/pbrMetallicRoughness/roughnessFactor", 0) + "," +
                                                   channel("1/pbrMetallicRoughness/baseColorFactor", 2) + "," +
                                                   channel(emission, 1)),
                                          messages));
    CHECK(messages.left_out().empty());
    const Material& material = posed.scene().materials.at(0);
    CHECK(material.emission == Rgb{4, 2, 0});
    const SceneUpdate update = posed.set_time(1);
    CHECK(update.materials_changed);
    CHECK(update.lights_changed);
    CHECK(update.keeps_surfaces());
    CHECK(material.roughness == 1); // 2 is outside its range
    CHECK(material.base_color == Rgb{0, 0.5f, 1});
    CHECK(material.alpha == 0.25f);
    CHECK(material.emission == Rgb{2, 1, 4});
    CHECK(material.metallic == 1);
    PosedScene coated(
        test::read_gltf_text(document(channel("1/extensions/KHR_materials_clearcoat/clearcoatFactor", 0)), messages));
    CHECK(coated.set_time(1).lights_changed); // light leaves an emitter through its coat
    CHECK(posed.set_time(1).is_empty());
    posed.set_time(0.5);
    CHECK(material.base_color == Rgb{0.5f, 0.75f, 1});
    CHECK(material.roughness == 1);
    posed.edit([](Scene& scene) {
        scene.materials[0].metallic = 0.5f;
        SceneUpdate edited;
        edited.materials_changed = true;
        return edited;
    });
    posed.set_time(0);
    CHECK(material.metallic == 0.5f);
    CHECK(material.roughness == 0.25f);
    CHECK(material.emission == Rgb{0, 0, 0});
    CHECK(may_emit(posed.scene()) == std::vector<bool>{true});

    const Scene by_strength =
        test::read_gltf_text(document(channel(strength, 0) + "," + channel(emission, 1)), messages);
    REQUIRE(by_strength.animations.at(0).channels.size() == 1);
    CHECK(by_strength.animations[0].channels[0].values == std::vector<float>{0.25f, 0.125f, 0, 2, 1, 0});
    CHECK(test::has_warning(messages, {"/animations/0/channels/1"}));
    const Scene dispersing =
        test::read_gltf_text(document(channel("1/extensions/KHR_materials_dispersion/dispersion", 0)), messages);
    CHECK(dispersing.animations.at(0).channels.at(0).values == std::vector<float>{0.25f * 0.05f, 0.1f}); // over 1
    CHECK(dispersing.materials.at(0).transmission_dispersion_abbe_number == 1.0f);
    PosedScene bending(test::read_gltf_text(document(channel("1/extensions/KHR_materials_ior/ior", 3)), messages));
    const Material& glass = bending.scene().materials.at(0);
    bending.set_time(0);
    CHECK(glass.ior == kMostIor); // that of 0 at rest
    CHECK_FALSE(glass.has_relative_ior);
    bending.set_time(0.5);
    CHECK(glass.ior == 0.75f);
    CHECK(glass.has_relative_ior);
    bending.set_time(1);
    CHECK(glass.ior == 1.5f);
    CHECK_FALSE(glass.has_relative_ior);
    Messages unused, unknown; // a material that nothing has is not read
    CHECK(test::read_gltf_text(document(channel("0/alphaCutoff", 0)), unused).animations.at(0).channels.empty());
    test::read_gltf_text(document(channel("1/doubleSided", 0) + "," + channel("7/alphaCutoff", 0)), unknown);
    CHECK(unknown.left_out().size() == 2);
}

TEST_CASE("KHR_animation_pointer animates the transforms of textures, whose other parts stay those at rest") {
    GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}); // 0
    builder.add("SCALAR", std::vector<float>{0, 1});                    // 1
    builder.add("VEC2", std::vector<float>{0, 0, 0.5f, 0.25f});         // 2
    builder.add("SCALAR", std::vector<float>{0, 0.5f});                 // 3
    builder.add("VEC2", std::vector<float>{0, 0, 0, 0});                // 4
    builder.add("VEC2", std::vector<float>{0, 0, 1, 0, 0, 1});          // 5
    const auto channel = [](const std::string& to, int number) {
        return R"({"sampler":)" + std::to_string(number) +
               R"(,"target":{"path":"pointer","extensions":{"KHR_animation_pointer":{"pointer":"/materials/0/)" + to +
               R"("}}}})";
    };
    const std::string transform = "/extensions/KHR_texture_transform/";
    const std::string red =
        "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGP4z8AAAAMBAQDJ/pLvAAAAAElFTkSuQmCC";
    const auto document = [&](const std::string& channels) {
        return builder.json(
            R"("extensionsUsed":["KHR_animation_pointer","KHR_texture_transform"],"images":[{"uri":"data:image/png;base64,)" +
            red +
            R"("}],"textures":[{"source":0}],"materials":[{"emissiveFactor":[1,1,1],"emissiveTexture":{"index":0},)"
            R"("pbrMetallicRoughness":{"baseColorTexture":{"index":0,"extensions":{"KHR_texture_transform":)"
            R"({"offset":[0.5,0.25],"scale":[-1,2]}}},"metallicRoughnessTexture":{"index":0}}}],)"
            R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":5},"material":0}]}],"nodes":[{"mesh":0}],)"
            R"("animations":[{"samplers":[)" +
            sampler(1, 2) + "," + sampler(1, 3) + "," + sampler(1, 4) + R"(],"channels":[)" + channels + "]}]");
    };
    Messages messages;
    PosedScene posed(test::read_gltf_text(
        document(channel("pbrMetallicRoughness/baseColorTexture" + transform + "rotation", 1) + "," +
                 channel("pbrMetallicRoughness/metallicRoughnessTexture" + transform + "offset", 0)),
        messages));
    CHECK(messages.left_out().empty());
    const Material& material = posed.scene().materials.at(0);
    SceneUpdate update = posed.set_time(1);
    CHECK(update.materials_changed);
    CHECK_FALSE(update.lights_changed);
    CHECK(update.keeps_surfaces());
    const TextureRef& color = material.base_color_texture;
    CHECK(color.m00 == doctest::Approx(-std::cos(0.5)));
    CHECK(color.m01 == doctest::Approx(2 * std::sin(0.5)));
    CHECK(color.m10 == doctest::Approx(std::sin(0.5)));
    CHECK(color.m11 == doctest::Approx(2 * std::cos(0.5)));
    CHECK(color.m02 == 0.5f);
    CHECK(color.m12 == 0.25f);
    for (const TextureRef& both : {material.metallic_texture, material.roughness_texture}) {
        CHECK(both.m02 == 0.5f);
        CHECK(both.m12 == 0.25f);
        CHECK(both.m00 == 1);
    }
    CHECK(posed.set_time(1).is_empty());
    posed.set_time(0);
    CHECK(color.m00 == -1);
    CHECK(color.m11 == 2);
    CHECK(material.roughness_texture.m02 == 0);

    PosedScene glowing(test::read_gltf_text(document(channel("emissiveTexture" + transform + "scale", 2) + "," +
                                                     channel("emissiveTexture" + transform + "offset", 0)),
                                            messages));
    update = glowing.set_time(0.5);
    CHECK(update.lights_changed);
    CHECK(glowing.scene().materials.at(0).emission_texture.m00 == 0);
    CHECK(glowing.scene().materials.at(0).emission_texture.m02 == 0.25f);
    CHECK(messages.left_out().empty());
    test::read_gltf_text(document(channel("emissiveTexture" + transform + "texCoord", 1) + "," +
                                  channel("occlusionTexture" + transform + "scale", 0)),
                         messages);
    CHECK(messages.left_out().size() == 2);
}

TEST_CASE("KHR_animation_pointer shows and hides nodes with all that they hold") {
    GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});            // 0
    builder.add("SCALAR", std::vector<float>{1, 2});                               // 1
    builder.add("SCALAR", std::vector<uint8_t>{1, 0});                             // 2
    builder.add("SCALAR", std::vector<uint8_t>{0, 1});                             // 3
    builder.add("SCALAR", std::vector<float>{0, 1});                               // 4
    builder.add("VEC4", std::vector<uint8_t>{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}); // 5
    builder.add("VEC4", std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});   // 6
    const auto channel = [](int node, int number) {
        return R"({"sampler":)" + std::to_string(number) +
               R"(,"target":{"path":"pointer","extensions":{"KHR_animation_pointer":{"pointer":"/nodes/)" +
               std::to_string(node) + R"(/extensions/KHR_node_visibility/visible"}}}})";
    };
    const std::string hidden = R"("extensions":{"KHR_node_visibility":{"visible":false}})";
    const auto document = [&](const std::string& more_samplers, const std::string& channels) {
        return builder.json(
            R"("extensionsUsed":["KHR_animation_pointer","KHR_node_visibility","KHR_lights_punctual"],)"
            R"("extensions":{"KHR_lights_punctual":{"lights":[{"type":"point","intensity":5}]}},)"
            R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]},)"
            R"({"primitives":[{"attributes":{"POSITION":0,"JOINTS_0":5,"WEIGHTS_0":6}}]}],"skins":[{"joints":[4]}],)"
            R"("nodes":[{"mesh":0},{)" +
            hidden +
            R"(,"children":[2,3,5]},)"
            R"({"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,2,0,0,1]},{"extensions":{"KHR_lights_punctual":{"light":0}}},)"
            R"({"mesh":0,)" +
            hidden + R"(},{"mesh":1,"skin":0}],"animations":[{"samplers":[)" +
            sampler(1, 2, R"(,"interpolation":"STEP")") + "," + sampler(1, 3) + more_samplers + R"(],"channels":[)" +
            channels + "]}]");
    };
    // Node 0 vanishes at 2 s, node 1 appears then with a mesh, a light and a skinned mesh; node 4 stays hidden.
    Messages messages;
    PosedScene posed(test::read_gltf_text(document("", channel(0, 0) + "," + channel(1, 1)), messages));
    CHECK(messages.left_out().empty());
    const Scene& scene = posed.scene();
    REQUIRE(scene.instances.size() == 3);
    REQUIRE(scene.lights.size() == 1);
    const auto seen = [&] {
        std::vector<uint32_t> nodes;
        for (const Instance& instance : scene.instances) {
            if (!instance.is_hidden) nodes.push_back(instance.node);
        }
        return nodes;
    };
    CHECK(seen() == std::vector<uint32_t>{0});
    CHECK(scene.lights[0].is_hidden);
    posed.edit([](Scene&) { return SceneUpdate{}; });
    CHECK(scene.lights[0].is_hidden);
    CHECK(posed.set_time(1.9).is_empty());
    const SceneUpdate update = posed.set_time(2);
    CHECK(update.moved_instances == std::vector<uint32_t>{0, 1, 2});
    CHECK(update.lights_changed);
    CHECK(seen() == std::vector<uint32_t>{2, 5});
    CHECK_FALSE(scene.lights[0].is_hidden);
    CHECK(shown_intensity(scene.lights[0]).g == 5);
    CHECK(scene.instances[1].world_from_local.translation.x == 2);
    const PosedScene::Placements before = posed.placements_at(1);
    CHECK(before.instances[0]);
    CHECK_FALSE(before.instances[1]);
    CHECK(seen() == std::vector<uint32_t>{2, 5});
    posed.set_time(0);
    CHECK(seen() == std::vector<uint32_t>{0});

    // Between values there is nothing, so a spline is refused, and floats are read as bytes are. A node with a matrix
    // has a visibility, too.
    PosedScene by_floats(
        test::read_gltf_text(document("," + sampler(1, 4), channel(1, 2) + "," + channel(2, 0)), messages));
    by_floats.set_time(1.5);
    CHECK(by_floats.scene().instances.at(1).is_hidden);
    CHECK(by_floats.scene().instances.at(2).is_hidden);
    by_floats.set_time(2);
    CHECK(by_floats.scene().instances.at(1).is_hidden);
    CHECK_FALSE(by_floats.scene().instances.at(2).is_hidden);
    CHECK(messages.left_out().empty());
    builder.add("SCALAR", std::vector<float>{0, 0, 0, 0, 1, 0}); // 7
    test::read_gltf_text(document("," + sampler(1, 7, R"(,"interpolation":"CUBICSPLINE")"), channel(0, 2)), messages);
    CHECK(messages.left_out().size() == 1);
}

TEST_CASE("nodes with one mesh share it, except those with animated weights") {
    Messages messages;
    const Scene scene = test::read_gltf_text(
        numbers().json(
            R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"targets":[{"POSITION":2},{"POSITION":2}]}]}],)"
            R"("nodes":[{"mesh":0},{"mesh":0},{"mesh":0},{"mesh":0}],"animations":[{"samplers":[)" +
            sampler(1, 5) + R"(],"channels":[)" + channel(1, "weights") + "," + channel(3, "weights") + "]}]"),
        messages);
    REQUIRE(scene.instances.size() == 4);
    CHECK(scene.instances[0].mesh == scene.instances[2].mesh);
    CHECK(scene.instances[0].mesh != scene.instances[1].mesh);
    CHECK(scene.instances[1].mesh != scene.instances[3].mesh);
    REQUIRE(scene.shapes.size() == 3);
    for (const MeshShape& shape : scene.shapes) CHECK(shape.targets.size() == 2);
    CHECK(scene.shapes[1].node == 1);
}

TEST_CASE("a skin's joints and weights are kept, four for each set") {
    GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    builder.add("VEC4", std::vector<uint8_t>{0, 1, 9, 9, 1, 0, 0, 0, 0, 0, 0, 0});
    builder.add("VEC4", std::vector<float>{0.5f, 0.25f, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
    builder.add("MAT4", std::vector<float>{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -7, 0, 0, 1, //
                                           1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0,  0, 0, 1});
    const Scene scene = test::read_gltf_text(builder.json(
        R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"JOINTS_0":1,"WEIGHTS_0":2,"JOINTS_1":1,)"
        R"("WEIGHTS_1":2}}]}],"skins":[{"joints":[1,2],"inverseBindMatrices":3}],"nodes":[{"mesh":0,"skin":0},{},{}])"));
    REQUIRE(scene.shapes.size() == 1);
    const MeshShape& shape = scene.shapes[0];
    CHECK(shape.joints_per_vertex == 8);
    CHECK(std::vector(shape.joints.begin(), shape.joints.begin() + 8) == std::vector<uint32_t>{0, 1, 0, 0, 0, 1, 0, 0});
    CHECK(std::vector(shape.weights.begin(), shape.weights.begin() + 8) ==
          std::vector<float>{0.5f, 0.25f, 0, 0, 0.5f, 0.25f, 0, 0});
    CHECK(scene.skins[0].joint_from_mesh[0].translation == Vec3{-7, 0, 0});
    CHECK(shape.positions == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
}
