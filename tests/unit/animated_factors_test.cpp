// Factors of glTF materials that KHR_animation_pointer changes from values without effect at rest.

#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "scene/pose/posed_scene.h"
#include "scene/tangents/make_tangents.h"
#include "tests/support/gltf_builder.h"

using namespace pertev;
using test::GltfBuilder;

namespace {

struct Case {
    const char* factor;     // "OWNER/NAME"; the owner is pbrMetallicRoughness or the end of an extension's name
    const char* extensions; // others of the material
    const char* members;    // further ones of the owner
    std::vector<float> rest, last;
};

const char* const kSolid = R"("KHR_materials_transmission":{"transmissionFactor":1},)"
                           R"("KHR_materials_volume":{"thicknessFactor":1,"attenuationDistance":1,)"
                           R"("attenuationColor":[0.5,1,1]})";
const char* const kVolume = R"("KHR_materials_volume":{"thicknessFactor":1,"attenuationDistance":1,)"
                            R"("attenuationColor":[0.5,1,1]})";
const char* const kClear = R"("KHR_materials_transmission":{"transmissionFactor":1})";

const Case kCases[] = {
    {"sheen/sheenColorFactor",
     "",
     R"("sheenRoughnessFactor":0.5,"sheenColorTexture":{"index":0})",
     {0, 0, 0},
     {1, 0.5f, 1}},
    {"specular/specularFactor", "", R"("specularColorFactor":[1,0.5,0.5],"specularTexture":{"index":0})", {0}, {1}},
    {"volume/attenuationColor", kClear, R"("thicknessFactor":1,"attenuationDistance":2)", {1, 1, 1}, {0.5f, 1, 1}},
    {"volume/attenuationDistance", kClear, R"("thicknessFactor":1,"attenuationColor":[0.5,1,1])", {}, {0.5f}},
    {"transmission/transmissionFactor", kVolume, "", {1}, {0.5f}},
    {"transmission/transmissionFactor", kVolume, "", {0}, {0.5f}},
    {"transmission/transmissionFactor", kVolume, "", {0}, {1}},
    {"transmission/transmissionFactor", "", R"("transmissionTexture":{"index":0})", {0}, {1}},
    {"clearcoat/clearcoatFactor",
     "",
     R"("clearcoatRoughnessFactor":0.25,"clearcoatTexture":{"index":0},)"
     R"("clearcoatNormalTexture":{"index":0,"scale":0.5})",
     {0},
     {1}},
    {"iridescence/iridescenceFactor",
     "",
     R"("iridescenceIor":1.75,"iridescenceThicknessMaximum":600,)"
     R"("iridescenceThicknessTexture":{"index":0})",
     {0},
     {1}},
    {"anisotropy/anisotropyStrength", "", R"("anisotropyRotation":1,"anisotropyTexture":{"index":0})", {0}, {0.5f}},
    {"diffuse_transmission/diffuseTransmissionFactor",
     "",
     R"("diffuseTransmissionColorFactor":[0.25,1,0.25],"diffuseTransmissionTexture":{"index":0})",
     {0},
     {0.75f}},
    {"retroreflection/retroreflectionFactor", "", R"("retroreflectionTexture":{"index":0})", {0}, {1}},
    {"dispersion/dispersion", kSolid, "", {0}, {1}},
    {"dispersion/dispersion", kSolid, "", {0.25f}, {3}},
    {"dispersion/dispersion", kSolid, "", {3}, {30}},
    {"pbrMetallicRoughness/metallicFactor", kSolid, "", {0}, {1}},
    {"pbrMetallicRoughness/metallicFactor", R"("KHR_materials_specular":{"specularFactor":0})", "", {0}, {1}},
};

std::string json_of(const std::vector<float>& value) {
    std::string text;
    for (const float number : value) text += (text.empty() ? "" : ",") + std::to_string(number);
    return value.size() == 1 ? text : "[" + text + "]";
}

/// Returns a file whose one material has `value` of the factor; without numbers it lacks the factor. The animation of
/// the factor plays or, if it `waits`, comes after one that does.
std::string file_of(const Case& of, const std::vector<float>& value, bool plays, bool waits = false) {
    const std::string factor = of.factor, owner = factor.substr(0, factor.find('/'));
    const std::string name = factor.substr(factor.find('/') + 1), further = of.extensions, members = of.members;
    const bool is_core = owner == "pbrMetallicRoughness";
    const std::string number = value.empty() ? "" : "\"" + name + "\":" + json_of(value);
    const std::string separator = number.empty() || members.empty() ? "" : ",";
    const std::string extension = "KHR_materials_" + owner;
    const std::string own = "\"" + extension + "\":{" + number + separator + members + "}";
    const std::string extensions = is_core ? further : own + (further.empty() ? "" : ",") + further;
    GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    builder.add("VEC2", std::vector<float>{0, 0, 1, 0, 0, 1});
    builder.add("SCALAR", std::vector<float>{0, 1});
    std::vector<float> values = of.rest.empty() ? of.last : of.rest;
    values.insert(values.end(), of.last.begin(), of.last.end());
    builder.add(of.last.size() == 3 ? "VEC3" : "SCALAR", values);
    const std::string animation =
        R"({"samplers":[{"input":2,"output":3}],"channels":[{"sampler":0,"target":{"path":"pointer",)"
        R"("extensions":{"KHR_animation_pointer":{"pointer":"/materials/0/)" +
        (is_core ? factor : "extensions/" + extension + "/" + name) + R"("}}}}]})";
    const std::string still = R"({"samplers":[],"channels":[]},)";
    return builder.json(
        R"("meshes":[{"primitives":[{"material":0,"attributes":{"POSITION":0,"TEXCOORD_0":1}}]}],"nodes":[{"mesh":0}],)"
        R"("textures":[{"source":0}],"images":[{"uri":"data:image/png;base64,)"
        R"(iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGP4z8AAAAMBAQDJ/pLvAAAAAElFTkSuQmCC"}],)"
        R"("materials":[{"pbrMetallicRoughness":{)" +
        (is_core ? number : R"("metallicFactor":0)") + R"(},"extensions":{)" + extensions + "}}]" +
        (plays || waits ? R"(,"animations":[)" + (waits ? still : "") + animation + "]" : ""));
}

Scene read_of(const Case& of, const std::vector<float>& value, bool plays, bool waits = false) {
    Messages messages;
    Scene scene = test::read_gltf_text(file_of(of, value, plays, waits), messages);
    CHECK(messages.all().empty());
    return scene;
}

/// Returns the material of MetallicRoughness that looks like this one.
Material general(Material material) {
    if (material.kind != MaterialKind::Dielectric) return material;
    material.kind = MaterialKind::MetallicRoughness;
    material.transmission_weight = 1;
    material.thin_walled = false;
    return material;
}

void check_equal(Material a, Material b) {
    CHECK(a.kind == b.kind);
    CHECK(a.thin_walled == b.thin_walled);
    CHECK(a.dispersion() == doctest::Approx(b.dispersion()));
    a.transmission_dispersion_scale = b.transmission_dispersion_scale = 0; // only their quotient counts
    a.transmission_dispersion_abbe_number = b.transmission_dispersion_abbe_number = 20;
    std::vector<float> numbers;
    std::vector<const TextureRef*> textures;
    visit_parameters(
        b, [&](float number, auto&&...) { numbers.push_back(number); },
        [&](const TextureRef& texture, const char*) { textures.push_back(&texture); });
    std::size_t number = 0, slot = 0;
    visit_parameters(
        a,
        [&](float value, const char* name, float, float) {
            CAPTURE(std::string(name));
            CHECK(value == numbers.at(number++));
        },
        [&](const TextureRef& texture, const char* name) {
            CAPTURE(std::string(name));
            const TextureRef& other = *textures.at(slot++);
            CHECK(texture.image == other.image);
            if (!other.has_image()) return;
            CHECK(texture.channel == other.channel);
            CHECK(texture.is_srgb == other.is_srgb);
        });
}

} // namespace

TEST_CASE("a material whose animated factor has no effect at rest ends like one that has the factor's last value") {
    for (const Case& of : kCases) {
        CAPTURE(std::string(of.factor));
        PosedScene posed(read_of(of, of.rest, true));
        posed.set_time(1);
        const Material& shown = posed.scene().materials.at(0);
        const Material last = read_of(of, of.last, false).materials.at(0);
        check_equal(shown, shown.kind == MaterialKind::Dielectric ? last : general(last));
    }
}

TEST_CASE("a glTF animation that does not play changes no material") {
    for (const Case& of : kCases) {
        CAPTURE(std::string(of.factor));
        const Material still = read_of(of, of.rest, false).materials.at(0);
        const Material waiting = read_of(of, of.rest, false, true).materials.at(0);
        CHECK(waiting.transmission_dispersion_scale == still.transmission_dispersion_scale);
        check_equal(waiting, still);
    }
}

TEST_CASE("an animated extension that the material lacks begins from its defaults") {
    const Case sheen = {"sheen/sheenColorFactor", "", "", {0, 0, 0}, {1, 0.5f, 1}};
    std::string file = file_of(sheen, sheen.rest, true);
    const std::string extension = R"("KHR_materials_sheen":{"sheenColorFactor":[0.000000,0.000000,0.000000]})";
    REQUIRE(file.find(extension) != std::string::npos);
    file.erase(file.find(extension), extension.size());
    Messages messages;
    PosedScene posed(test::read_gltf_text(file, messages));
    posed.set_time(1);
    check_equal(posed.scene().materials.at(0), read_of(sheen, sheen.last, false).materials.at(0));
}

TEST_CASE("an animated factor that solid glass or a scattering volume cannot have is named") {
    const auto left_out = [](const Case& of) {
        CAPTURE(std::string(of.factor));
        Messages messages;
        const Scene scene = test::read_gltf_text(file_of(of, of.rest, true), messages);
        CHECK(scene.animations.at(0).channels.empty());
        CHECK(test::has_warning(messages, {"/animations/0/channels/0"}));
    };
    left_out({"specular/specularFactor", kSolid, "", {1}, {0}});
    left_out({"specular/specularColorFactor", kSolid, "", {1, 1, 1}, {0, 0, 0}});
    left_out({"retroreflection/retroreflectionFactor", kSolid, "", {0}, {1}});
    const std::string scatters =
        std::string(kClear) + R"(,"KHR_materials_volume_scatter":{"multiscatterColor":[0.5,0.5,0.5]})";
    left_out({"volume/attenuationDistance",
              scatters.c_str(),
              R"("thicknessFactor":1,"attenuationColor":[0.5,1,1])",
              {1},
              {2}});

    const Case white = {"volume/attenuationColor",
                        scatters.c_str(),
                        R"("thicknessFactor":1,"attenuationDistance":1)",
                        {1, 1, 1},
                        {0.5f, 1, 1}};
    Messages messages;
    PosedScene posed(test::read_gltf_text(file_of(white, white.rest, true), messages));
    CHECK(test::has_warning(messages, {"KHR_materials_volume_scatter"}));
    posed.set_time(1);
    CHECK(posed.scene().materials.at(0).transmission_color == Rgb{0.5f, 1, 1});
    CHECK(posed.scene().materials.at(0).absorbs());
}

TEST_CASE("a medium fills a body that light enters only while it is animated") {
    const std::string medium =
        std::string(kVolume) + R"(,"KHR_materials_volume_scatter":{"multiscatterColor":[0.5,0.5,0.5]})";
    for (const char* factor : {"transmission/transmissionFactor", "diffuse_transmission/diffuseTransmissionFactor"}) {
        const Case of = {factor, medium.c_str(), "", {0}, {0.5f}};
        PosedScene posed(read_of(of, of.rest, true));
        CHECK_FALSE(posed.scene().materials.at(0).encloses());
        posed.set_time(1);
        CHECK(posed.scene().materials.at(0).encloses());
        check_equal(posed.scene().materials.at(0), read_of(of, of.last, false).materials.at(0));
    }
}

TEST_CASE("meshes have the tangents of anisotropies and coats that animations bring") {
    const auto has_tangents = [](const Case& of, const std::vector<float>& value, bool plays) {
        Scene scene = read_of(of, value, plays);
        make_tangents(scene);
        return !scene.meshes.at(0).tangents.empty();
    };
    const Case anisotropy = {"anisotropy/anisotropyStrength", "", "", {0}, {1}};
    const Case coat = {"clearcoat/clearcoatFactor", "", R"("clearcoatNormalTexture":{"index":0})", {0}, {1}};
    for (const Case& of : {anisotropy, coat}) {
        CAPTURE(std::string(of.factor));
        CHECK(has_tangents(of, of.last, false));
        CHECK(has_tangents(of, of.rest, true));
        CHECK_FALSE(has_tangents(of, of.rest, false));
    }
}

TEST_CASE("factors that KHR_materials_pbrSpecularGlossiness replaces are not animated") {
    const std::string gloss = R"("KHR_materials_pbrSpecularGlossiness":{"glossinessFactor":0.5})";
    for (const char* factor : {"pbrMetallicRoughness/roughnessFactor", "ior/ior", "specular/specularFactor"}) {
        const Case of = {factor, gloss.c_str(), "", {1}, {0.25f}};
        Messages messages;
        const Scene scene = test::read_gltf_text(file_of(of, of.rest, true), messages);
        CHECK(scene.animations.at(0).channels.empty());
        CHECK(test::has_warning(messages, {"/animations/0/channels/0", "is not animated"}));
    }
}
