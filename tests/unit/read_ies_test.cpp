// IES photometric files, in scenes of glTF and by setting.

#include <cmath>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "formats/gltf_writer/write_glb.h"
#include "formats/ies/read_ies.h"
#include "formats/read_scene.h"
#include "session/opening/set_profiles.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/lit_scenes.h"
#include "tests/support/options.h"
#include "tests/support/thrown_error.h"
#include "tests/support/write_text.h"

namespace fs = std::filesystem;
using namespace pertev;

namespace {

/// A file with these angles and candelas.
std::string ies_text(const std::string& vertical, const std::string& horizontal, const std::string& candelas,
                     int vertical_count, int horizontal_count, const std::string& factors = "1") {
    return fmt::format("IESNA:LM-63-2002\n[TEST] a lamp\nTILT=NONE\n1 -1 {} {} {} 1 2 0 0 0\n1 1 50\n{}\n{}\n{}\n",
                       factors, vertical_count, horizontal_count, vertical, horizontal, candelas);
}
const std::string kRound = ies_text("0 45 90", "0", "100 80 0", 3, 1, "2"); // candelas are twice that

IntensityTable parse_quietly(const std::string& text) {
    Messages messages;
    IntensityTable table = parse_ies(text, "a.ies", messages);
    CHECK(messages.all().empty());
    return table;
}

/// Candelas of a file in the direction of these angles in degrees, from a light that points down with +x its 0.
double candelas_at(const std::string& text, double vertical, double horizontal) {
    Light light;
    float greatest = 0;
    light.kind = LightKind::Goniometric;
    light.table = make_intensity_table(parse_quietly(text), greatest);
    light.intensity = grey(greatest);
    light.direction = {0, -1, 0}, light.up = {0, 0, -1};
    Scene scene;
    scene.lights = {light};
    const test::Lights lights(scene);
    const double v = vertical * 3.14159265358979 / 180, h = horizontal * 3.14159265358979 / 180;
    const Vec3 at = {static_cast<float>(2 * std::sin(v) * std::cos(h)), static_cast<float>(-2 * std::cos(v)),
                     static_cast<float>(-2 * std::sin(v) * std::sin(h))};
    LightSample sample;
    if (!sample_light(lights.view, at, {7, 9}, sample)) return 0;
    return 4 * static_cast<double>(sample.radiance.g); // times the squared distance
}

} // namespace

TEST_CASE("ies: candelas are exact at the file's angles and linear between them") {
    CHECK(candelas_at(kRound, 0, 0) == doctest::Approx(200));
    CHECK(candelas_at(kRound, 45, 77) == doctest::Approx(160));
    CHECK(candelas_at(kRound, 22.5, 200) == doctest::Approx(180));
    CHECK(candelas_at(kRound, 67.5, 3) == doctest::Approx(80));
    CHECK(candelas_at(kRound, 91, 0) == 0);
    const std::string uneven = ies_text("0 2.5 17.5 30", "0", "8 4 16 2", 4, 1);
    CHECK(candelas_at(uneven, 2.5, 0) == doctest::Approx(4));
    CHECK(candelas_at(uneven, 10, 0) == doctest::Approx(10));
    CHECK(candelas_at(uneven, 17.5, 0) == doctest::Approx(16));
    CHECK(candelas_at(uneven, 30.5, 0) == 0);
}

TEST_CASE("ies: files may give a quarter, a half or the whole of the horizontal circle") {
    const std::string quarter = ies_text("0 90", "0 90", "10 20 10 40", 2, 2);
    for (const double h : {0.0, 180.0, 360.0})
        CHECK(candelas_at(quarter, 89.999, h) == doctest::Approx(20).epsilon(1e-3));
    for (const double h : {90.0, 270.0}) CHECK(candelas_at(quarter, 89.999, h) == doctest::Approx(40).epsilon(1e-3));
    for (const double h : {45.0, 135.0, 225.0, 315.0})
        CHECK(candelas_at(quarter, 89.999, h) == doctest::Approx(30).epsilon(1e-3));
    const std::string half = ies_text("0 90", "0 90 180", "1 10 1 20 1 40", 2, 3);
    CHECK(candelas_at(half, 89.999, 90) == doctest::Approx(20).epsilon(1e-3));
    CHECK(candelas_at(half, 89.999, 270) == doctest::Approx(20).epsilon(1e-3));
    CHECK(candelas_at(half, 89.999, 225) == doctest::Approx(30).epsilon(1e-3));
    const std::string other_half = ies_text("0 90", "90 180 270", "1 10 1 20 1 40", 2, 3);
    CHECK(candelas_at(other_half, 89.999, 0) == doctest::Approx(20).epsilon(1e-3));
    CHECK(candelas_at(other_half, 89.999, 45) == doctest::Approx(15).epsilon(1e-3));
    CHECK(candelas_at(other_half, 89.999, 270) == doctest::Approx(40).epsilon(1e-3));
    const std::string whole = ies_text("0 90", "0 90 180 270 360", "1 10 1 20 1 40 1 80 1 10", 2, 5);
    CHECK(candelas_at(whole, 89.999, 90) == doctest::Approx(20).epsilon(1e-3));
    CHECK(candelas_at(whole, 89.999, 270) == doctest::Approx(80).epsilon(1e-3));
    CHECK(candelas_at(whole, 89.999, 315) == doctest::Approx(45).epsilon(1e-3));
}

TEST_CASE("ies: photometry of types A and B is around its own poles") {
    const std::string text = ies_text("-90 0 90", "0 90", "10 20 30 5 5 5", 3, 2);
    for (const char* const type : {"3", "2"}) { // A, B
        std::string of_type = text;
        of_type.replace(text.find("3 2 1 2"), 7, fmt::format("3 2 {} 2", type));
        CHECK(candelas_at(of_type, 0, 0) == doctest::Approx(20));
        CHECK(candelas_at(of_type, 45, 90) == doctest::Approx(25).epsilon(1e-3));
        CHECK(candelas_at(of_type, 45, 270) == doctest::Approx(15).epsilon(1e-3));
        for (const double side : {0.0, 180.0})
            CHECK(candelas_at(of_type, 45, side) == doctest::Approx(12.5).epsilon(1e-3));
        CHECK(candelas_at(of_type, 91, 0) == 0);
        // The direction (sin 60, cos 60 sin 45, cos 60 cos 45) is 60 degrees across and 45 up in type B.
        const double wanted = *type == '2' ? 25 - 20 * 60.0 / 90 : 9.269;
        CHECK(candelas_at(of_type, 69.2952, 22.2077) == doctest::Approx(wanted).epsilon(2e-3));
    }
}

TEST_CASE("ies: the ballast-lamp factor counts in editions before 1995") {
    std::string text = kRound;
    text.replace(text.find("1 1 50"), 6, "0.5 3 50");
    CHECK(candelas_at(text, 0, 0) == doctest::Approx(100));
    CHECK(candelas_at(text.replace(0, text.find('\n'), "IESNA91"), 0, 0) == doctest::Approx(300));
}

TEST_CASE("ies: a damaged file is refused with its line") {
    struct Fault {
        std::string text;
        std::size_t line;
        const char* why;
    };
    const auto changed = [](const std::string& from, const std::string& to) {
        std::string text = kRound;
        return text.replace(text.find(from), from.size(), to);
    };
    for (const Fault& fault : {Fault{"", 1, "TILT="},
                               {"not one\n", 2, "TILT="},
                               {changed("100 80 0\n", "100 80\n"), 9, "candelas"},
                               {changed("100 80", "100 8e38"), 8, "expected at most 2^40"},
                               {changed("1 -1 2", "1 -1 1e300"), 8, "expected at most 2^40"},
                               {changed("100 80", "100 x80"), 8, "x80 is not a number"},
                               {changed("0 45 90", "0 95 90"), 6, "90 after 95"},
                               {changed("0 45 90", "0 45 190"), 7, "vertical angles"},
                               {changed("3 1 1 2", "3 1 4 2"), 4, "the type of photometry"},
                               {changed("3 1 1 2", "3 1 2 2"), 7, "from 0 to 0"},
                               {changed("3 1 1 2", "4000 4000 1 2"), 5, "cannot hold"},
                               {changed("3 1 1 2", "-3 1 1 2"), 4, "from 2 to"},
                               {changed("3 1 1 2", "3 1.5 1 2"), 4, "horizontal"},
                               {changed("\n0\n", "\n7\n"), 7, "expected from 0"}}) {
        CAPTURE(fault.text);
        Messages messages;
        const auto error = test::thrown_error([&] { (void)parse_ies(fault.text, "a.ies", messages); });
        REQUIRE(error);
        CHECK(error->code() == ErrorCode::BadInput);
        REQUIRE(error->remark().location);
        CHECK(error->remark().location->file == "a.ies");
        CHECK(error->remark().location->line == fault.line);
        CHECK(std::string(error->what()).find(fault.why) != std::string::npos);
    }
    Messages messages;
    (void)parse_ies(changed("TILT=NONE", "TILT=INCLUDE\n1\n2\n0 90\n1 0.5"), "a.ies", messages);
    REQUIRE(messages.all().size() == 1);
    CHECK(messages.all()[0].remark.location->line == 3);
}

TEST_CASE("ies: a node's light of EXT_lights_ies shines along -z, and conversion names what it loses") {
    std::string encoded;
    for (const char c : kRound) encoded += fmt::format("%{:02X}", static_cast<unsigned char>(c));
    const fs::path folder = test::scratch_folder();
    const fs::path file = test::write_text(
        folder / "lamp.gltf",
        fmt::format(
            R"({{"asset":{{"version":"2.0"}},"extensionsUsed":["EXT_lights_ies"],"extensions":{{"EXT_lights_ies":{{"lights":[{{"name":"down","uri":"data:,{}"}}]}}}},)"
            R"("scenes":[{{"nodes":[0,1,2]}}],"nodes":[{{"translation":[1,2,3],"extensions":{{"EXT_lights_ies":{{"light":0,"multiplier":0.5,"color":[1,0.5,2]}}}}}},)"
            R"({{"mesh":0}},{{"extensions":{{"EXT_lights_ies":{{"light":1}}}}}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],)"
            R"("buffers":[{{"byteLength":36,"uri":"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}}],"bufferViews":[{{"buffer":0,"byteLength":36}}],)"
            R"("accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}}]}})",
            encoded));
    Messages messages;
    const Scene scene = read_scene(file, {}, messages);
    REQUIRE(messages.left_out().size() == 1); // the light of /nodes/2
    CHECK(messages.left_out()[0].find("1; there are 1") != std::string::npos);
    REQUIRE(scene.lights.size() == 1);
    const Light& light = scene.lights[0];
    CHECK(light.name == "down");
    CHECK(light.position == Vec3{1, 2, 3});
    CHECK(light.direction == Vec3{0, 0, -1});
    CHECK(light.intensity == Rgb{100, 50, 100}); // the brightest direction, of 200 cd
    Messages losses;
    write_glb(folder / "out.glb", scene, losses);
    REQUIRE(losses.left_out().size() == 1);
    CHECK(losses.left_out()[0].find("the table of its intensity is lost") != std::string::npos);
}

TEST_CASE("ies: conversion makes a spot of a round cone, with the part of full intensity as the inner cone") {
    const fs::path folder = test::scratch_folder();
    Scene scene;
    test::add(scene, test::floor_at(0, 1), test::white());
    Light light = {.name = "edge", .kind = LightKind::Goniometric, .direction = {1, 0, 0}, .intensity = {1, 2, 3}};
    float greatest = 0;
    light.table = make_intensity_table(
        make_round_table(0.5f, [](float angle) { return angle <= 0.25f ? 4.0f : 16 * (0.5f - angle); }), greatest);
    scene.lights = {light};
    Messages losses;
    write_glb(folder / "out.glb", scene, losses);
    CHECK(losses.left_out().size() == 1);
    const Scene read = read_scene(folder / "out.glb", {}, losses);
    REQUIRE(read.lights.size() == 1);
    CHECK(read.lights[0].kind == LightKind::Spot);
    CHECK(read.lights[0].direction.x == doctest::Approx(1));
    CHECK(std::acos(read.lights[0].cos_outer) == doctest::Approx(0.5).epsilon(1e-3));
    CHECK(std::acos(read.lights[0].cos_inner) == doctest::Approx(0.25).epsilon(1e-2));
    CHECK(read.lights[0].intensity.b == doctest::Approx(3));
}

TEST_CASE("ies: a setting gives point and spot lights by name the candelas of a file") {
    const std::string file = test::write_text(test::scratch_folder() / "lamp.ies", kRound).string();
    Scene scene;
    scene.lights = {{.name = "bulb", .intensity = {2, 2, 2}},
                    {.name = "sun", .kind = LightKind::Directional, .direction = {0, -1, 0}}};
    Messages messages;
    const std::string text = "bulb=" + file;
    set_profiles(scene, {&text, 1}, 683, messages);
    CHECK(scene.lights[0].kind == LightKind::Goniometric);
    CHECK(scene.lights[0].intensity.g == doctest::Approx(200.0 / 683));
    const test::Lights lights(scene);
    LightSample sample; // E = I / r^2 two metres below
    REQUIRE(sample_punctual_light<EmitterVariant::Coated>(lights.view, 0, 1, {0, -2, 0}, sample));
    CHECK(sample.radiance.g == doctest::Approx(200.0 / 683 / 4));
    const std::string both[] = {text, "b*=" + file};
    CHECK(test::is_about(test::thrown_error([&] { set_profiles(scene, both, 683, messages); }), ErrorCode::BadInput,
                         "ies", both[1]));
    for (const std::string& wrong : std::vector<std::string>{"sun=" + file, "bulb", "=" + file, "lamp=" + file}) {
        CAPTURE(wrong);
        CHECK(test::is_about(test::thrown_error([&] {
                                 set_profiles(scene, {&wrong, 1}, 683, messages);
                             }),
                             ErrorCode::BadInput, "ies", wrong));
    }
}
