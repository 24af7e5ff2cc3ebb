// Documents of Mitsuba's scenes: elements, names, values, references, includes, transforms and cameras.

#include <algorithm>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "formats/mitsuba/object.h"
#include "formats/mitsuba/parse_values.h"
#include "formats/mitsuba/read_transform.h"
#include "formats/read_scene.h"
#include "math/portable_math.h"
#include "tests/support/mitsuba_materials.h"
#include "tests/support/options.h"
#include "tests/support/thrown_error.h"
#include "tests/support/write_text.h"

namespace fs = std::filesystem;
using namespace pertev;

namespace {

const std::string kMitsubaSquare = "<shape type=\"rectangle\"/>\n";

std::string in_scene(const std::string& text, const std::string& version = "3.0.0") {
    return "<scene version=\"" + version + "\">\n" + text + "</scene>\n";
}

Scene load_mitsuba(const std::string& text, Messages& messages, const ReadOptions& options = {}) {
    return read_scene(test::write_text(test::scratch_folder() / "scene.xml", text), options, messages);
}
Scene load_mitsuba(const std::string& text) {
    Messages messages;
    Scene scene = load_mitsuba(text, messages);
    CHECK(test::left_out_besides_backs(messages) == std::vector<std::string>{});
    return scene;
}

/// Returns what a scene with a square and `text` leaves out, without the path of its folder.
std::vector<std::string> mitsuba_left_out(const std::string& text) {
    Messages messages;
    const Scene scene = load_mitsuba(in_scene(text + kMitsubaSquare), messages);
    CHECK(scene.instances.size() >= 1);
    std::vector<std::string> texts = test::left_out_besides_backs(messages);
    for (std::string& line : texts) line.erase(0, std::min(line.find("scene.xml"), line.size()));
    return texts;
}
bool begins_with(const std::vector<std::string>& texts, const std::string& begin) {
    return texts.size() == 1 && texts[0].starts_with(begin);
}

/// The corner of the first instance that was at (1, 1, 0).
Vec3 corner_of(const Scene& scene) {
    return transform_point(scene.instances.at(0).world_from_local, scene.meshes.at(0).positions.at(2));
}
Vec3 corner_after(const std::string& steps, const std::string& version = "3.0.0", const char* name = "to_world") {
    return corner_of(load_mitsuba(in_scene(
        fmt::format("<shape type=\"rectangle\"><transform name=\"{}\">{}</transform></shape>", name, steps), version)));
}
void check_corner(Vec3 p, Vec3 wanted) { CHECK(length(p - wanted) < 1e-5f); }

std::string mitsuba_suggestion(const Scene& scene, const std::string& name) {
    for (const SuggestedSetting& setting : scene.suggested) {
        if (setting.name == name) return setting.text;
    }
    return "";
}

/// A point of a scene as its first camera has it: x to the right, y up, in front at negative z.
Vec3 seen_from(const Scene& scene, Vec3 p) {
    return transform_point(inverse(scene.cameras.at(0).world_from_camera), p);
}

float fov_y_of(const std::string& parameters, int width, int height, const std::string& version = "3.0.0") {
    const Scene scene = load_mitsuba(
        in_scene(fmt::format("<sensor type=\"perspective\">{}<film type=\"hdrfilm\"><integer name=\"width\" "
                             "value=\"{}\"/><integer name=\"height\" value=\"{}\"/></film></sensor>",
                             parameters, width, height) +
                     kMitsubaSquare,
                 version));
    return scene.cameras.at(0).fov_y;
}

} // namespace

TEST_CASE("mitsuba: numbers and colours of attributes") {
    CHECK(mitsuba::parse_numbers("1, 2.5\t-3e2") == std::vector<double>{1, 2.5, -300});
    CHECK(mitsuba::parse_numbers("1, two").empty());
    CHECK(mitsuba::parse_numbers("1;2").empty());
    CHECK(mitsuba::parse_color("0.5", false) == std::vector<double>{0.5, 0.5, 0.5});
    CHECK(mitsuba::parse_color("#ff0080", false)[0] == 1);
    CHECK(mitsuba::parse_color("#ff0080", false)[2] == doctest::Approx(0.21586).epsilon(1e-3));
    CHECK(mitsuba::parse_color("0.5 0 1", true)[0] == doctest::Approx(0.21404).epsilon(1e-3));
    CHECK(mitsuba::parse_color("#ff00g0", false).empty());
    CHECK(mitsuba::parse_color("nan", false).empty());
}

TEST_CASE("mitsuba: names of 0.6 are those of 3") {
    CHECK(mitsuba::snake_case("toWorld") == "to_world");
    CHECK(mitsuba::snake_case("intIOR") == "int_ior");
    CHECK(mitsuba::snake_case("fovAxis") == "fov_axis");
    CHECK(mitsuba::snake_case("alpha_u") == "alpha_u");
}

TEST_CASE("mitsuba: a later step of a transform is applied later") {
    check_corner(corner_after("<translate x=\"1\"/><scale value=\"2\"/>"), {4, 2, 0});
    check_corner(corner_after("<scale x=\"2\"/><translate x=\"1\" z=\"3\"/>"), {3, 1, 3});
    check_corner(corner_after("<scale value=\"2, 3, 4\"/>"), {2, 3, 0});
    check_corner(corner_after("<rotate z=\"1\" angle=\"90\"/><translate x=\"5\"/>"), {4, 1, 0});
    check_corner(corner_after("<rotate value=\"1,0,0\" angle=\"90\"/>"), {1, 0, 1});
    check_corner(corner_after("<matrix value=\"1 0 0 5  0 2 0 6  0 0 1 7  0 0 0 1\"/>"), {6, 8, 7});
    check_corner(corner_after("<matrix value=\"2 0 0 0  0 2 0 0  0 0 2 0  0 0 0 2\"/>"), {1, 1, 0});
    check_corner(corner_after("<translate x=\"1\"/><scale value=\"2\"/>", "0.6.0", "toWorld"), {4, 2, 0});
}

TEST_CASE("mitsuba: nine numbers are a map without a translation, and of texture coordinates one of the plane") {
    check_corner(corner_after("<matrix value=\"1 0 0 0 2 0 5 0 1\"/>"), {1, 2, 5});
}

TEST_CASE("mitsuba: a camera looks along +z with +x to the left") {
    const std::string square = "<shape type=\"rectangle\"><transform name=\"to_world\"><translate x=\"3\" "
                               "y=\"1\" z=\"9\"/></transform></shape>";
    const Scene plain = load_mitsuba(in_scene("<sensor type=\"perspective\"/>" + square));
    check_corner(seen_from(plain, {3, 1, 9}), {-3, 1, -9});
    const Scene aimed = load_mitsuba(in_scene("<sensor type=\"perspective\"><transform name=\"to_world\"><lookat "
                                              "origin=\"0,0,5\" target=\"0,0,0\" up=\"0,1,0\"/></transform></sensor>" +
                                              square));
    check_corner(seen_from(aimed, {3, 1, 1}), {3, 1, -4});
    const Scene old = load_mitsuba(in_scene("<sensor type=\"perspective\"><transform name=\"toWorld\"><lookAt "
                                            "origin=\"0 0 5\" target=\"0 0 0\"/></transform></sensor>" +
                                                square,
                                            "0.6.0"));
    check_corner(seen_from(old, {0, 0, 1}), {0, 0, -4});
}

TEST_CASE("mitsuba: a mirroring sensor shows a mirrored world") {
    const Scene scene = load_mitsuba(
        in_scene("<sensor type=\"perspective\"><transform name=\"to_world\"><scale x=\"-1\"/></transform></sensor>" +
                 kMitsubaSquare));
    // Without the mirror (1, 1, 0) would be on the left.
    CHECK(seen_from(scene, corner_of(scene)).x == doctest::Approx(1));
}

TEST_CASE("mitsuba: the field of view is that of its axis") {
    const auto tangent = [](float fov_y) { return static_cast<double>(tan(0.5f * fov_y)); };
    const auto half = [](double degrees) { return std::tan(degrees * 3.14159265358979 / 360); };
    const std::string fov = "<float name=\"fov\" value=\"60\"/>";
    const auto axis = [&](const char* name) {
        return fov + fmt::format("<string name=\"fov_axis\" value=\"{}\"/>", name);
    };
    CHECK(tangent(fov_y_of(fov, 200, 100)) == doctest::Approx(half(60) / 2));
    CHECK(tangent(fov_y_of(axis("y"), 200, 100)) == doctest::Approx(half(60)));
    CHECK(tangent(fov_y_of(axis("smaller"), 200, 100)) == doctest::Approx(half(60)));
    CHECK(tangent(fov_y_of(axis("larger"), 100, 200)) == doctest::Approx(half(60)));
    CHECK(tangent(fov_y_of(axis("diagonal"), 400, 300)) == doctest::Approx(half(60) * 3 / 5));
    CHECK(tangent(fov_y_of("<string name=\"fovAxis\" value=\"y\"/>" + fov, 200, 100, "0.6.0")) ==
          doctest::Approx(half(60)));
    // A film of 36 x 24 mm has a diagonal of 43.27 mm.
    CHECK(tangent(fov_y_of("<string name=\"focal_length\" value=\"50mm\"/>", 360, 240)) == doctest::Approx(12.0 / 50));
}

TEST_CASE("mitsuba: thin lenses, orthographic views, principal points and several sensors") {
    const Scene scene = load_mitsuba(in_scene(
        "<sensor type=\"thinlens\" id=\"near\"><float name=\"aperture_radius\" value=\"0.25\"/><float "
        "name=\"focus_distance\" value=\"7\"/><float name=\"fov\" value=\"40\"/></sensor>"
        "<sensor type=\"orthographic\" id=\"plan\"><transform name=\"to_world\"><scale x=\"3\" y=\"3\"/></transform>"
        "<film type=\"hdrfilm\"><integer name=\"width\" value=\"200\"/><integer name=\"height\" "
        "value=\"100\"/></film></sensor>"
        "<sensor type=\"perspective\"><float name=\"principal_point_offset_x\" value=\"0.25\"/><float "
        "name=\"fov\" value=\"90\"/></sensor>" +
        kMitsubaSquare));
    REQUIRE(scene.cameras.size() == 3);
    CHECK(scene.cameras[0].name == "near");
    CHECK(scene.cameras[0].aperture_radius == 0.25f);
    CHECK(scene.cameras[0].focus_distance == 7);
    CHECK(scene.cameras[1].projection == Projection::Orthographic);
    CHECK(scene.cameras[1].ortho_height == doctest::Approx(3));
    REQUIRE(scene.cameras[2].intrinsics);
    CHECK(scene.cameras[2].intrinsics->centre_x == doctest::Approx(768 * 0.25)); // the picture moves to the left
    CHECK(scene.cameras[2].intrinsics->centre_y == doctest::Approx(288));
    CHECK(scene.cameras[2].intrinsics->focal_x == doctest::Approx(384));
}

TEST_CASE("mitsuba: film, sampler and integrator suggest settings") {
    const Scene scene = load_mitsuba(in_scene(
        "<integrator type=\"moment\"><integrator type=\"path\"><integer name=\"maxDepth\" value=\"9\"/></integrator>"
        "</integrator><sensor type=\"perspective\"><sampler type=\"ldsampler\"><integer name=\"sampleCount\" "
        "value=\"36\"/></sampler><film type=\"hdrfilm\"><integer name=\"width\" value=\"64\"/><integer name=\"height\" "
        "value=\"48\"/><rfilter type=\"tent\"/></film></sensor>" +
            kMitsubaSquare,
        "0.6.0"));
    CHECK(mitsuba_suggestion(scene, "size") == "64x48");
    CHECK(mitsuba_suggestion(scene, "spp") == "36");
    CHECK(mitsuba_suggestion(scene, "max_depth") == "8"); // Mitsuba counts the emitter's vertex
    CHECK(mitsuba_suggestion(scene, "filter") == "tent");
    CHECK(mitsuba_suggestion(scene, "filter_radius") == "1");
    const Scene direct = load_mitsuba(in_scene("<integrator type=\"direct\"/>" + kMitsubaSquare));
    CHECK(mitsuba_suggestion(direct, "max_depth") == "1");
    CHECK(
        mitsuba_left_out(
            "<integrator type=\"path\"><boolean name=\"hide_emitters\" value=\"false\"/></integrator><sensor "
            "type=\"perspective\"><film type=\"hdrfilm\"><integer name=\"crop_width\" value=\"768\"/></film></sensor>")
            .empty());
    CHECK(mitsuba_left_out("<integrator type=\"path\"><boolean name=\"hide_emitters\" value=\"true\"/></integrator>")
              .size() == 1);
    CHECK(
        begins_with(mitsuba_left_out("<sensor type=\"perspective\"><film type=\"hdrfilm\"><integer name=\"crop_width\" "
                                     "value=\"3\"/></film></sensor>"),
                    "scene.xml:2: the parameter \"crop_width\""));
}

TEST_CASE("mitsuba: no default light is added to a file without lights") {
    const Scene scene = load_mitsuba(in_scene(kMitsubaSquare));
    REQUIRE(scene.environment);
    CHECK(is_black(scene.environment->scale));
    CHECK(scene.cameras.empty());
}

TEST_CASE("mitsuba: defaults and defined values replace $NAME") {
    const std::string text = in_scene("<default name=\"a\" value=\"2\"/><default name=\"ab\" value=\"5\"/><default "
                                      "name=\"a\" value=\"9\"/><shape type=\"rectangle\"><transform name=\"to_world\">"
                                      "<scale x=\"$a\" y=\"$ab\" z=\"1\"/></transform></shape>");
    check_corner(corner_of(load_mitsuba(text)), {2, 5, 0});
    Messages messages;
    ReadOptions options;
    options.defines = {"a=3", "zz=1"};
    check_corner(corner_of(load_mitsuba(text, messages, options)), {3, 5, 0});
    REQUIRE(messages.all().size() >= 1);
    CHECK(messages.all()[0].remark.setting == "define");
    CHECK(messages.all()[0].remark.value == "zz");
    CHECK(messages.all()[0].remark.reason == "the file has no $zz"); // a name does not mean itself
    options.defines = {"abc=1"};
    Messages close;
    (void)load_mitsuba(text, close, options);
    CHECK(close.all().at(0).remark.reason.find("\"ab\"") != std::string::npos);
    options.defines = {"a"};
    Messages refused;
    CHECK(test::is_about(test::thrown_error([&] { load_mitsuba(text, refused, options); }), ErrorCode::BadInput,
                         "define", "a"));
    CHECK(begins_with(mitsuba_left_out("<bsdf type=\"diffuse\"><float name=\"x\" value=\"$none\"/></bsdf>"),
                      "scene.xml:2: $none"));
}

TEST_CASE("mitsuba: values that multiply each other are left out") {
    std::string text = "<default name=\"n0\" value=\"aaaaaaaaaaaaaaaa\"/>";
    for (int i = 1; i < 12; ++i) {
        text += fmt::format("<default name=\"n{}\" value=\"", i);
        for (int k = 0; k < 10; ++k) text += fmt::format("$n{}", i - 1);
        text += "\"/>";
    }
    CHECK(!mitsuba_left_out(text).empty());
}

TEST_CASE("mitsuba: entities of a document type are not expanded") {
    Messages messages;
    const Scene scene = load_mitsuba("<!DOCTYPE s [<!ENTITY a \"<shape type='cube'/>\"><!ENTITY b \"&a;&a;\">]>" +
                                         in_scene("<shape type=\"rectangle\" id=\"&b;\"/>"),
                                     messages);
    REQUIRE(scene.instances.size() == 1);
    CHECK(scene.instances[0].name == "&b;");
}

TEST_CASE("mitsuba: references, aliases and named references") {
    const Scene scene = load_mitsuba(
        in_scene("<shape type=\"rectangle\"><ref id=\"later\"/></shape><alias id=\"red\" as=\"rot\"/>"
                 "<bsdf type=\"diffuse\" id=\"red\"><rgb name=\"reflectance\" value=\"1 0 0\"/></bsdf>"
                 "<shape type=\"cube\"><ref name=\"bsdf\" id=\"rot\"/></shape>"
                 "<bsdf type=\"diffuse\" id=\"later\"><rgb name=\"reflectance\" value=\"0 0 1\"/></bsdf>"));
    REQUIRE(scene.instances.size() == 2);
    CHECK(scene.materials[scene.instances[0].material].base_color == Rgb{0, 0, 1});
    CHECK(scene.materials[scene.instances[1].material].base_color == Rgb{1, 0, 0});
    CHECK(begins_with(
        mitsuba_left_out("\n<shape type=\"cube\"><ref id=\"glas\"/></shape><bsdf type=\"diffuse\" id=\"glass\"/>"),
        "scene.xml:3: there is no object with the id glas (did you mean \"glass\"?)"));
}

TEST_CASE("mitsuba: an id in a file that looks like one of an unnamed object refers to nothing") {
    CHECK(!mitsuba_left_out("<shape type=\"cube\"><ref id=\"\x01zz\"/></shape>").empty());
    CHECK(!mitsuba_left_out("<shape type=\"cube\"><ref id=\"\x01"
                            "99999\"/></shape>")
               .empty());
}

TEST_CASE("mitsuba: cycles of references and of includes end") {
    CHECK(!mitsuba_left_out("<bsdf type=\"twosided\" id=\"a\"><ref id=\"b\"/></bsdf><bsdf type=\"mask\" id=\"b\"><ref "
                            "id=\"a\"/></bsdf><shape type=\"cube\"><ref id=\"a\"/></shape>")
               .empty());
    CHECK(!mitsuba_left_out("<texture type=\"scale\" id=\"t\"><ref id=\"t\"/></texture><shape type=\"cube\"><bsdf "
                            "type=\"diffuse\"><ref id=\"t\" name=\"reflectance\"/></bsdf></shape>")
               .empty());
    CHECK(!mitsuba_left_out("<shape type=\"merge\" id=\"m\"><ref id=\"m\"/></shape>").empty());
    CHECK(!mitsuba_left_out("<include filename=\"scene.xml\"/>").empty());
    const std::string twice = "<include filename=\"scene.xml\"/><include filename=\"scene.xml\"/>"; // at 16 levels
    const std::optional<Error> error = test::thrown_error([&] { (void)mitsuba_left_out(twice); });
    CHECK((error && error->code() == ErrorCode::OverLimit));
    CHECK(test::says(error, "more than 4096 times"));
}

TEST_CASE("mitsuba: included files are found beside the scene, in <path> and beside each other") {
    const fs::path folder = test::scratch_folder();
    fs::create_directories(folder / "parts" / "more");
    test::write_text(folder / "parts" / "a.xml",
                     in_scene("<include filename=\"b.xml\"/><include filename=\"c.xml\"/>"));
    test::write_text(folder / "parts" / "b.xml", "<shape version=\"3.0.0\" type=\"cube\"/>");
    test::write_text(folder / "parts" / "more" / "c.xml", in_scene("<shape type=\"sphere\"/>"));
    fs::create_directories(folder / "parts" / "less"); // is not searched
    test::write_text(folder / "parts" / "less" / "c.xml", in_scene("<shape type=\"cube\"/>"));
    Messages messages;
    const fs::path path =
        test::write_text(folder / "scene.xml",
                         in_scene("<path value=\"parts/more\"/><include filename=\"parts/a.xml\"/>" + kMitsubaSquare));
    const Scene scene = read_scene(path, {}, messages);
    CHECK(test::left_out_besides_backs(messages) == std::vector<std::string>{});
    REQUIRE(scene.instances.size() == 3);
    CHECK(scene.instances[0].name == "cube");
    CHECK(scene.instances[1].name == "sphere");
    CHECK(begins_with(mitsuba_left_out("<include filename=\"none.xml\"/>"), "scene.xml:2: there is no file none.xml"));
    CHECK(!mitsuba_left_out("<path value=\"/etc\"/><include filename=\"passwd\"/>").empty());
}

TEST_CASE("mitsuba: what is unknown or unreadable is left out with its line") {
    CHECK(begins_with(mitsuba_left_out("\n<shap type=\"cube\"/>"),
                      "scene.xml:3: there is no such element (did you mean \"shape\"?)"));
    CHECK(begins_with(mitsuba_left_out("<shape type=\"spher\"/>"),
                      "scene.xml:2: shapes of the type spher are left out (did you mean \"sphere\"?)"));
    CHECK(begins_with(
        mitsuba_left_out("<shape type=\"sphere\">\n<float name=\"radus\" value=\"2\"/></shape>"),
        "scene.xml:3: the parameter \"radus\" of the shape sphere is unknown and left out (did you mean \"radius\"?)"));
    CHECK(begins_with(mitsuba_left_out("<shape type=\"sphere\"><float name=\"radius\" value=\"big\"/></shape>"),
                      "scene.xml:2: value=\"big\""));
    CHECK(begins_with(mitsuba_left_out("<shape type=\"sphere\"><float name=\"radius\" value=\"nan\"/></shape>"),
                      "scene.xml:2: value=\"nan\""));
    CHECK(begins_with(mitsuba_left_out("<shape type=\"sphere\"><float name=\"radius\" value=\"-1\"/></shape>"),
                      "scene.xml:2: the radius is -1"));
    CHECK(begins_with(
        mitsuba_left_out(
            "<shape type=\"cube\"><transform name=\"to_world\"><matrix value=\"1 2 3\"/></transform></shape>"),
        "scene.xml:2: value=\"1 2 3\""));
    CHECK(begins_with(mitsuba_left_out("<shape type=\"cube\"><transform name=\"to_world\"><lookat origin=\"0,0,0\" "
                                       "target=\"0,0,0\"/></transform></shape>"),
                      "scene.xml:2: the transform has no inverse"));
    CHECK(begins_with(mitsuba_left_out("<shape type=\"cube\"><bsdf type=\"null\"/><medium type=\"heterogeneous\" "
                                       "name=\"interior\"/></shape>"),
                      "scene.xml:2: media of the type heterogeneous are left out"));
}

TEST_CASE("mitsuba: broken XML keeps what is in front of the fault, and deep nesting ends") {
    Messages messages;
    const Scene scene = load_mitsuba("<scene version=\"3.0.0\">" + kMitsubaSquare + "<shape type=", messages);
    CHECK(scene.instances.size() == 1);
    CHECK(!messages.left_out().empty());
    std::string deep;
    for (int i = 0; i < 20000; ++i) deep += "<bsdf type=\"twosided\">";
    for (int i = 0; i < 20000; ++i) deep += "</bsdf>";
    CHECK(!mitsuba_left_out("<shape type=\"cube\">" + deep + "</shape>").empty());
    Messages none;
    CHECK(test::thrown_error([&] { load_mitsuba("no XML", none); }).has_value());
}

TEST_CASE("mitsuba: objects that each name two others, and values in values, end at a limit") {
    const auto fault_of_file = [](const std::string& text) {
        return test::thrown_error([&] {
            Messages messages;
            (void)load_mitsuba(in_scene(text), messages);
        });
    };
    std::string blends = "<bsdf type=\"diffuse\" id=\"b0\"/>", merges = "<shape type=\"merge\" id=\"m0\"/>";
    for (int i = 1; i < 30; ++i) {
        const auto both = [&](char c) { return fmt::format("<ref id=\"{0}{1}\"/><ref id=\"{0}{1}\"/>", c, i - 1); };
        blends += fmt::format("<bsdf type=\"blendbsdf\" id=\"b{}\">{}</bsdf>", i, both('b'));
        merges += fmt::format("<shape type=\"merge\" id=\"m{}\">{}</shape>", i, both('m'));
    }
    const auto blend = fault_of_file(blends + "<shape type=\"rectangle\"><ref id=\"b29\"/></shape>");
    REQUIRE(blend);
    CHECK(blend->code() == ErrorCode::OverLimit);
    const auto merge = fault_of_file(merges);
    REQUIRE(merge);
    CHECK(merge->code() == ErrorCode::OverLimit);
    std::string texts = fmt::format("<default name=\"a\" value=\"{}\"/>", std::string(60000, '1'));
    for (int i = 0; i < 600; ++i) texts += "<bsdf type=\"diffuse\" id=\"$a\"/>";
    const auto values = fault_of_file(texts + kMitsubaSquare);
    REQUIRE(values);
    CHECK(values->code() == ErrorCode::OverLimit);
}

TEST_CASE("mitsuba: a lens that is too near to focus is a pinhole") {
    const Scene scene = load_mitsuba(in_scene(kMitsubaSquare +
                                              "<sensor type=\"thinlens\"><float name=\"aperture_radius\" value=\".1\"/>"
                                              "<float name=\"focus_distance\" value=\"1e-60\"/></sensor>"));
    REQUIRE(scene.cameras.size() == 1);
    CHECK(scene.cameras[0].aperture_radius == 0);
}

TEST_CASE("mitsuba: a sky has its sun where the file says, about the axis that points up there") {
    const auto brightest = [](const Scene& scene) {
        const Image& image = scene.environment->image;
        REQUIRE_FALSE(image.pixels.empty());
        std::size_t best = 0;
        for (std::size_t i = 0; i < image.pixels.size(); i += 3) best = image.pixels[i] > image.pixels[best] ? i : best;
        const float x = (static_cast<float>(best / 3 % image.width) + 0.5f) / static_cast<float>(image.width);
        const float y = (static_cast<float>(best / 3 / image.width) + 0.5f) / static_cast<float>(image.height);
        const float around = 2 * kPi * (x - 0.5f), down = kPi * y;
        return Vec3{sin(down) * sin(around), cos(down), -sin(down) * cos(around)};
    };
    Messages messages;
    const std::string direction = "<vector name=\"sun_direction\" x=\"0.6\" y=\"0\" z=\"0.8\"/>";
    const Scene sun =
        load_mitsuba(in_scene(kMitsubaSquare + "<emitter type=\"sunsky\">" + direction + "</emitter>"), messages);
    CHECK(messages.left_out().empty());
    CHECK(messages.all().size() == 1); // it is another model
    CHECK(length(brightest(sun) - Vec3{0.6f, 0, 0.8f}) < 0.01f);
    CHECK(sun.environment->image.width == 2048);
    const Scene sky =
        load_mitsuba(in_scene(kMitsubaSquare + "<emitter type=\"sky\">" + direction + "</emitter>"), messages);
    CHECK(sky.environment->image.width == 512);
    const Scene old = load_mitsuba(
        in_scene(kMitsubaSquare + "<emitter type=\"sun\"><vector name=\"sunDirection\" x=\"0.6\" y=\"0.8\" z=\"0\"/>"
                                  "</emitter>",
                 "0.6.0"),
        messages);
    CHECK(length(brightest(old) - Vec3{0.6f, 0.8f, 0}) < 0.01f);
    // The direction is one of the world, however the sky lies: here with +y up, and moved and scaled in 0.6.
    const std::string turned = "<emitter type=\"sunsky\"><vector name=\"sun_direction\" x=\"0\" y=\"0.6\" z=\"0.8\"/>"
                               "<transform name=\"to_world\"><rotate x=\"1\" angle=\"-90\"/></transform></emitter>";
    CHECK(length(brightest(load_mitsuba(in_scene(kMitsubaSquare + turned), messages)) - Vec3{0, 0.6f, 0.8f}) < 0.01f);
    const std::string on_side = "<emitter type=\"sunsky\"><vector name=\"sunDirection\" x=\"0\" y=\"-0.6\" z=\"0.8\"/>"
                                "<transform name=\"toWorld\"><translate y=\"9\"/><scale value=\"3\"/><rotate x=\"1\" "
                                "angle=\"90\"/></transform></emitter>";
    CHECK(length(brightest(load_mitsuba(in_scene(kMitsubaSquare + on_side, "0.6.0"), messages)) -
                 Vec3{0, -0.6f, 0.8f}) < 0.01f);
    CHECK(messages.left_out().empty());
    // An afternoon in Tokyo: in the west, which is +y, and somewhat south, 46 degrees high.
    const Vec3 tokyo = brightest(load_mitsuba(in_scene(kMitsubaSquare + "<emitter type=\"sun\"/>"), messages));
    CHECK(tokyo.z == doctest::Approx(0.72f).epsilon(0.02));
    CHECK(tokyo.y > 0.65f);
    CHECK(tokyo.x * tokyo.x < 0.0225f);
    const auto below =
        mitsuba_left_out("<emitter type=\"sky\"><vector name=\"sun_direction\" x=\"0\" y=\"0\" z=\"-1\"/></emitter>");
    CHECK(below.size() == 1);
}

TEST_CASE("mitsuba: an opacity does not dim what its surface emits") {
    const auto shape = [](const std::string& opacity) {
        return "<shape type=\"rectangle\"><bsdf type=\"mask\">" + opacity +
               "<bsdf type=\"diffuse\"/></bsdf><ref id=\"lamp\"/></shape>";
    };
    const std::string lamp = "<emitter type=\"area\" id=\"lamp\"><rgb name=\"radiance\" value=\"1 2 3\"/></emitter>";
    const Scene scene = load_mitsuba(
        in_scene("<shape type=\"rectangle\">" + lamp + "</shape>" + shape("<float name=\"opacity\" value=\".5\"/>") +
                 shape("<float name=\"opacity\" value=\".25\"/>") + shape("<float name=\"opacity\" value=\"1\"/>")));
    REQUIRE(scene.instances.size() == 4);
    for (const Instance& instance : scene.instances) {
        const Material& material = scene.materials.at(instance.material);
        CHECK(material.alpha * material.emission == Rgb{1, 2, 3});
    }
    CHECK(mitsuba_left_out(shape("<float name=\"opacity\" value=\"0\"/>").replace(0, 7, lamp + "<shape ")).size() >= 1);
}

TEST_CASE("mitsuba: unknown attributes, types and names are left out with the nearest") {
    const auto about = [](const std::string& text) { return mitsuba_left_out(text).size(); };
    const auto moved = [](const std::string& step) {
        return "<shape type=\"cube\"><transform name=\"to_world\">" + step + "</transform></shape>";
    };
    CHECK(begins_with(
        mitsuba_left_out(moved("<scale valu=\"2\"/>")),
        "scene.xml:2: the attribute \"valu\" of <scale> is unknown and left out (did you mean \"value\"?)"));
    CHECK(about(moved("<translate xx=\"3\"/>")) == 1);
    CHECK(about(moved("<lookat origin=\"0 0 1\" target=\"0 0 0\" upp=\"0 1 0\"/>")) == 1);
    CHECK(about(moved("<rotate y=\"1\" angle=\"3\"/><matrix value=\"1 0 0 0 1 0 0 0 1\"/><lookat origin=\"0 0 1\" "
                      "target=\"0 0 0\" up=\"0 1 0\"/><scale x=\"2\" y=\"2\" z=\"2\"/><translate value=\"1\"/>")) == 0);
    CHECK(about("<shape type=\"cube\" typ=\"sphere\"/>") == 1);
    CHECK(about("<shape xmlns:a=\"b\" a:c=\"d\" type=\"cube\" id=\"e\"/>") == 0);
    CHECK(about("<shape type=\"sphere\"><float nam=\"radius\" value=\"2\"/></shape>") == 2); // it has no name, too
    CHECK(begins_with(mitsuba_left_out("<integrator type=\"pth\"/>"),
                      "scene.xml:2: the integrator pth is unknown and left out (did you mean \"path\"?)"));
    CHECK(about("<integrator type=\"ptracer\"/>") == 0);
    const auto sensor = [](const std::string& inner) { return "<sensor type=\"perspective\">" + inner + "</sensor>"; };
    CHECK(about(sensor("<sampler type=\"independant\"/>")) == 1);
    CHECK(about(sensor("<film type=\"hdrflim\"/>")) == 1);
    CHECK(about(sensor("<film type=\"specfilm\"/><sampler type=\"halton\"/>")) == 0);
}

TEST_CASE("mitsuba: every conductor of its list is known by its short name") {
    const auto metal_of = [](const std::string& name) {
        return in_scene("<shape type=\"rectangle\"><bsdf type=\"conductor\"><string name=\"material\" value=\"" + name +
                        "\"/></bsdf></shape>");
    };
    for (const char* const name :
         {"a-C",  "Ag",   "Al", "AlAs", "AlSb", "Au",  "Be",   "Cr",       "CsI",     "Cu",       "Cu2O", "CuO", "d-C",
          "Hg",   "HgTe", "Ir", "K",    "Li",   "MgO", "Mo",   "Na_palik", "Nb",      "Ni_palik", "Rh",   "Se",  "SiC",
          "SnTe", "Ta",   "Te", "ThF4", "TiC",  "TiN", "TiO2", "VC",       "V_palik", "VN",       "W"}) {
        CAPTURE(name);
        const Scene scene = load_mitsuba(metal_of(name));
        const Material& metal = scene.materials.at(scene.instances.at(0).material);
        CHECK((metal.kind == MaterialKind::Conductor && metal.eta.g > 0.01f));
    }
    Messages messages;
    (void)load_mitsuba(metal_of("HgTa"), messages);
    CHECK(messages.left_out().size() == 1);
}
