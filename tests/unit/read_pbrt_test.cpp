#include <doctest/doctest.h>

#include <cstring>

#include <fmt/format.h>
#include <zlib.h>

#include "formats/files/closest_name.h"
#include "formats/files/gunzip.h"
#include "formats/pbrt/tokens.h"
#include "formats/read_scene.h"
#include "scene/scene_origin.h"
#include "tests/support/options.h"
#include "tests/support/thrown_error.h"
#include "tests/support/write_text.h"

namespace fs = std::filesystem;
using namespace pertev;

namespace {

const std::string kFlat = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2]\n";

Scene load_pbrt(const std::string& text, Messages& messages, const ReadOptions& options = {}) {
    return read_scene(test::write_text(test::scratch_folder() / "scene.pbrt", text), options, messages);
}

/// Reads a text that is right: nothing is left out.
Scene load_whole(const std::string& text) {
    Messages messages;
    Scene scene = load_pbrt(text, messages);
    CHECK(messages.left_out() == std::vector<std::string>{});
    return scene;
}

void check_at(Vec3 p, Vec3 wanted) {
    CAPTURE(p.x);
    CAPTURE(p.y);
    CAPTURE(p.z);
    CHECK(length(p - wanted) < 1e-5f);
}

std::string gzipped(const std::string& text) {
    z_stream stream = {};
    REQUIRE(deflateInit2(&stream, 9, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY) == Z_OK);
    std::string packed(deflateBound(&stream, static_cast<uLong>(text.size())), '\0');
    std::string in = text;
    stream.next_in = reinterpret_cast<Bytef*>(in.data()), stream.avail_in = static_cast<uInt>(in.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data()), stream.avail_out = static_cast<uInt>(packed.size());
    REQUIRE(deflate(&stream, Z_FINISH) == Z_STREAM_END);
    packed.resize(stream.total_out);
    deflateEnd(&stream);
    return packed;
}

/// Returns the left-out message at a line of scene.pbrt; empty if there is none.
std::string left_out_at(const Messages& messages, std::size_t line) {
    for (const Message& message : messages.all()) {
        if (message.is_left_out && message.remark.location && message.remark.location->line == line)
            return message.remark.reason;
    }
    return "";
}

} // namespace

TEST_CASE("pbrt: tokens are words, quoted texts and brackets with their lines, without comments") {
    pbrt::Tokens tokens("Shape \"a \\\"b\" # no \"word\"\n[ -1.5e3]\n\"open\nnext");
    using pbrt::TokenKind;
    CHECK(tokens.next().is_word("Shape"));
    CHECK(pbrt::unescaped(tokens.next().text) == "a \"b");
    CHECK(tokens.next().kind == TokenKind::Open);
    CHECK(tokens.peek().line == 2);
    CHECK(tokens.next().text == "-1.5e3");
    CHECK(tokens.next().kind == TokenKind::Close);
    const pbrt::Token open = tokens.next();
    CHECK(open.text == "open");
    CHECK(open.is_open_ended);
    CHECK(open.line == 3);
    CHECK(tokens.next().is_word("next"));
    CHECK(tokens.next().kind == TokenKind::End);
    CHECK(pbrt::unescaped("C:\\textures\\a.png") == "C:\\textures\\a.png");
    pbrt::Tokens cut("\"a\\\nnext"); // a backslash does not take the end of a line with it
    CHECK(cut.next().is_open_ended);
    CHECK(cut.peek().is_word("next"));
    CHECK(cut.peek().line == 2);
}

TEST_CASE("the closest name is the one with the fewest changed letters, and far ones are none") {
    constexpr std::string_view kNames[] = {"roughness", "uroughness", "eta"};
    CHECK(closest_name("rougness", kNames) == "roughness");
    CHECK(closest_name("UROUGHNES", kNames) == "uroughness");
    CHECK(closest_name("ets", kNames) == "eta");
    CHECK(closest_name("reflectance", kNames).empty());
    CHECK(closest_name("", kNames).empty());
}

TEST_CASE("pbrt: transforms multiply from the right, and states are restored") {
    const Scene scene = load_whole("WorldBegin\nTranslate 1 2 3 Rotate 90 0 0 1 Scale 2 2 2\n" + kFlat +
                                   "AttributeBegin Material \"diffuse\" Translate 1 0 0\n" + kFlat +
                                   "AttributeEnd CoordinateSystem \"here\" TransformBegin Identity\n"
                                   "Material \"diffuse\" \"rgb reflectance\" [.1 .2 .3]\n" +
                                   kFlat + "TransformEnd\n" + kFlat + "Transform [1 0 0 0 0 1 0 0 0 0 1 0 5 6 7 1]\n" +
                                   kFlat + "ConcatTransform [1 0 0 0 0 1 0 0 0 0 1 0 1 0 0 1]\n" + kFlat +
                                   "CoordSysTransform \"here\"\n" + kFlat);
    REQUIRE(scene.instances.size() == 7);
    const auto x_axis = [&](std::size_t i) {
        return transform_point(scene.instances[i].world_from_local, Vec3{1, 0, 0});
    };
    check_at(x_axis(0), {1, 4, 3});
    check_at(x_axis(1), {1, 6, 3});
    check_at(x_axis(2), {1, 0, 0});
    check_at(x_axis(3), {1, 4, 3});
    check_at(x_axis(4), {6, 6, 7});
    check_at(x_axis(5), {7, 6, 7});
    check_at(x_axis(6), {1, 4, 3});
    // TransformEnd keeps the material, AttributeEnd does not.
    CHECK(scene.materials[scene.instances[0].material].name == "default");
    CHECK(scene.materials[scene.instances[3].material].base_color == Rgb{0.1f, 0.2f, 0.3f});
}

TEST_CASE("pbrt: ActiveTransform changes one end of the shutter's time, and motion is left out") {
    Messages messages;
    const Scene scene =
        load_pbrt("WorldBegin ActiveTransform EndTime Translate 5 0 0 ActiveTransform All Translate 0 1 0\n" + kFlat +
                      "Identity\n" + kFlat,
                  messages);
    REQUIRE(scene.instances.size() == 2);
    check_at(scene.instances[0].world_from_local.translation, {0, 1, 0});
    CHECK(messages.left_out().size() == 1);
}

TEST_CASE("pbrt: instances of an object share its meshes") {
    const Scene scene = load_whole("WorldBegin ObjectBegin \"tree\" Translate 1 0 0 " + kFlat +
                                   "Shape \"sphere\" \"float radius\" 2 ObjectEnd\n" + kFlat +
                                   "Translate 0 0 5 ObjectInstance \"tree\" Scale 2 2 2 ObjectInstance \"tree\"\n"
                                   "Shape \"sphere\" \"float radius\" 3\n");
    CHECK(scene.meshes.size() == 3); // both triangles, and the sphere of radius 1
    REQUIRE(scene.instances.size() == 6);
    CHECK(scene.instances[1].mesh == scene.instances[3].mesh);
    CHECK(scene.instances[2].mesh == scene.instances[5].mesh);
    check_at(transform_point(scene.instances[3].world_from_local, {1, 0, 0}), {4, 0, 5});
    check_at(transform_point(scene.instances[4].world_from_local, {0, 0, 1}), {2, 0, 9});
}

TEST_CASE("pbrt: an undefined object, nested objects and stray ends are left out with their lines") {
    Messages messages;
    const Scene scene =
        load_pbrt("WorldBegin\nObjectInstance \"tre\"\nObjectBegin \"tree\"\nObjectBegin \"inner\"\n" + kFlat +
                      "ObjectInstance \"tree\"\nObjectEnd\nObjectEnd\nAttributeEnd\nTransformEnd\n" + kFlat,
                  messages);
    CHECK(scene.instances.size() == 1);
    for (const std::size_t line : {2, 4, 6, 8, 9, 10}) CHECK_FALSE(left_out_at(messages, line).empty());
    CHECK(messages.left_out().size() == 6);
}

TEST_CASE("pbrt: what is unknown is left out with its line, and the right word is suggested") {
    Messages messages;
    const Scene scene = load_pbrt(
        "WorldBegin\nShap \"sphere\" \"float radius\" 1\nShape \"spere\"\nMaterial \"diffus\"\n"
        "Material \"dielectric\" \"float rougness\" 0.1 \"flot eta\" 2\nShape \"sphere\" \"float radius\" [x]\n" +
            kFlat,
        messages);
    CHECK(scene.instances.size() == 2);
    CHECK(left_out_at(messages, 2).find("\"Shape\"") != std::string::npos);
    CHECK(left_out_at(messages, 3).find("\"sphere\"") != std::string::npos);
    CHECK(left_out_at(messages, 4).find("\"diffuse\"") != std::string::npos);
    std::size_t of_line_5 = 0;
    for (const Message& message : messages.all()) {
        if (!message.remark.location || message.remark.location->line != 5) continue;
        ++of_line_5;
        const bool is_name = message.remark.reason.find("\"roughness\"") != std::string::npos;
        const bool is_type = message.remark.reason.find("\"float\"") != std::string::npos;
        CHECK((is_name || is_type));
    }
    CHECK(of_line_5 == 2);
    CHECK_FALSE(left_out_at(messages, 6).empty());
    CHECK(messages.left_out().size() == 6);
}

TEST_CASE("pbrt: unknown types and parameters of statements before the world are left out with their line") {
    Messages messages;
    const Scene scene = load_pbrt("Sampler \"halto\" \"integer pixelsample\" 16\n"
                                  "Integrator \"volpth\" \"integer maxdept\" 7\n"
                                  "Film \"rgbb\" \"integer xresolution\" 8\n"
                                  "Accelerator \"bvhh\" \"integer maxprim\" 4\n"
                                  "Option \"integer sed\" 3\n"
                                  "WorldBegin\n" +
                                      kFlat,
                                  messages);
    CHECK(scene.instances.size() == 1);
    CHECK(messages.left_out().size() == 8);
    CHECK(left_out_at(messages, 1).find("\"halton\"") != std::string::npos);
    CHECK(left_out_at(messages, 2).find("\"volpath\"") != std::string::npos);
    CHECK(left_out_at(messages, 3).find("\"rgb\"") != std::string::npos);
    CHECK(left_out_at(messages, 4).find("\"bvh\"") != std::string::npos);
    CHECK(left_out_at(messages, 5).find("\"seed\"") != std::string::npos);
    (void)load_whole("Option \"integer seed\" 4\nOption \"bool disablePixelJitter\" true\n"
                     "Option \"bool disable-texture_filtering\" true\nColorSpace \"sRGB\"\n"
                     "Sampler \"stratified\" \"integer xsamples\" 4 \"integer ysamples\" 4 \"bool jitter\" true\n"
                     "Integrator \"mlt\" \"integer maxdepth\" 4 \"integer mutationsperpixel\" 9\n"
                     "Accelerator \"kdtree\" \"float emptybonus\" .2\nWorldBegin\n" +
                     kFlat);
}

TEST_CASE("pbrt: integrators without global light are left out by name") {
    for (const char* type : {"ao", "ambientocclusion", "directlighting", "function", "whitted"}) {
        Messages messages;
        (void)load_pbrt(fmt::format("Integrator \"{}\"\nWorldBegin\n{}", type, kFlat), messages);
        REQUIRE(messages.left_out().size() == 1);
        CHECK(left_out_at(messages, 1).find(type) != std::string::npos);
    }
}

TEST_CASE("pbrt: a light of a surface that is not there, a motion and an unknown spectrum are reported by line") {
    Messages messages;
    (void)load_pbrt("WorldBegin\nAttributeBegin\nAreaLightSource \"diffuse\"\nMaterial \"interface\"\n" + kFlat +
                        "AttributeEnd\nMaterial \"conductor\" \"spectrum eta\" \"metal-Aux-eta\"\n"
                        "ActiveTransform EndTime Translate 5 0 0\n" +
                        kFlat + kFlat,
                    messages);
    CHECK_FALSE(left_out_at(messages, 5).empty());
    CHECK(left_out_at(messages, 7).find("\"metal-Au-eta\"") != std::string::npos);
    CHECK_FALSE(left_out_at(messages, 9).empty());
    CHECK(left_out_at(messages, 10).empty()); // once
    const Scene named = load_whole("WorldBegin\nMaterial \"dielectric\" \"spectrum eta\" \"glass-F11\"\n" + kFlat);
    CHECK(named.materials.at(named.instances.at(0).material).ior == 1.78472f);
}

TEST_CASE("pbrt: a spectrum is unknown only if no file and no list has its name, and is left out once") {
    const fs::path folder = test::scratch_folder(), inner = folder / "inner";
    fs::create_directories(inner);
    test::write_text(inner / "words.spd", "no numbers");
    test::write_text(folder / "outside.spd", "400 1 700 1");
    const std::string reflectance = "\nMaterial \"diffuse\" \"spectrum reflectance\" ";
    Messages messages;
    (void)read_scene(test::write_text(inner / "scene.pbrt", "WorldBegin" + reflectance + "\"words.spd\"" + reflectance +
                                                                "\"stdillum-D65\"" + reflectance +
                                                                "\"../outside.spd\"" + reflectance +
                                                                "\"stdillum-D66\"\n" + kFlat),
                     {}, messages);
    for (std::size_t line = 2; line <= 5; ++line) {
        CHECK_FALSE(left_out_at(messages, line).empty());
        CHECK((left_out_at(messages, line).find("there is no spectrum") != std::string::npos) == (line == 5));
    }
    CHECK(messages.left_out().size() == 4);
}

TEST_CASE("pbrt: faults of syntax cost their statement or parameter alone") {
    for (const std::string fault :
         {"Translate 1 2",
          "Translate 1 2 [3]",
          "Rotate 1 0 0 0",
          "LookAt 0 0 0 0 0 0 0 1 0",
          "Transform [1 2 3]",
          "Shape",
          "Shape sphere",
          "Shape \"sphere",
          "Shape \"sphere\" \"float radius\" [1",
          "Shape \"sphere\" \"float radius\"",
          "Shape \"sphere\" \"float radius\" -1",
          "Shape \"sphere\" \"radius\" 1",
          "Shape \"sphere\" \"float radius\" \"a\"",
          "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 3]",
          "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 -2]",
          "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1] \"integer indices\" [0 1 2]",
          "Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2 3]",
          "Shape \"plymesh\" \"string filename\" \"none.ply\"",
          "Include \"none.pbrt\"",
          "CoordSysTransform \"none\"",
          "NamedMaterial \"none\"",
          "ActiveTransform Never",
          "ColorSpace \"none\"",
          "LightSource \"goniometric\" \"string filename\" \"none.exr\"",
          "] [ 1 \"x\""}) {
        CAPTURE(fault);
        Messages messages;
        const Scene scene = load_pbrt("WorldBegin\nIdentity\n" + fault + "\nIdentity\n" + kFlat, messages);
        CHECK_FALSE(messages.left_out().empty());
        CHECK_FALSE(scene.instances.empty());
        for (const Message& message : messages.all()) {
            if (message.is_left_out && message.remark.location) CHECK(message.remark.location->line <= 4);
        }
    }
}

TEST_CASE("pbrt: a file without shapes is refused, and the expected shapes are listed") {
    Messages messages;
    CHECK(test::thrown_error([&] { (void)load_pbrt("WorldBegin\n", messages); })->code() == ErrorCode::BadInput);
    const fs::path folder = test::scratch_folder();
    CHECK(test::thrown_error([&] { (void)read_scene(folder / "none.pbrt", {}, messages); })->code() ==
          ErrorCode::BadInput);
}

TEST_CASE("pbrt: included files are found from the scene's folder or their own, also gzip'd, and only Import keeps the "
          "state") {
    const fs::path folder = test::scratch_folder();
    fs::create_directory(folder / "parts");
    test::write_text(folder / "parts" / "a.pbrt", "Translate 1 0 0 Include \"parts/b.pbrt\" Include \"c.pbrt.gz\"");
    test::write_text(folder / "parts" / "b.pbrt", kFlat);
    test::write_text(folder / "parts" / "c.pbrt.gz", gzipped(kFlat + "Translate 0 1 0 "));
    Messages messages;
    const Scene scene =
        read_scene(test::write_text(folder / "scene.pbrt", "WorldBegin Import \"parts/a.pbrt\"\n" + kFlat +
                                                               "Include \"parts/a.pbrt\"\n" + kFlat),
                   {}, messages);
    CHECK(messages.all().empty());
    REQUIRE(scene.instances.size() == 6);
    check_at(scene.instances[1].world_from_local.translation, {1, 0, 0});
    check_at(scene.instances[2].world_from_local.translation, {0, 0, 0});
    check_at(scene.instances[5].world_from_local.translation, {1, 1, 0});
    // The whole file may be gzip'd, whatever its name.
    const std::string text = "WorldBegin\n" + kFlat;
    for (const char* name : {"whole.pbrt.gz", "whole.pbrt"}) {
        const fs::path packed = test::write_text(folder / name, gzipped(text));
        CHECK(is_scene_name(packed));
        CHECK(read_scene(packed, {}, messages).instances.size() == 1);
    }
    CHECK_FALSE(is_scene_name("scene.gz"));
    CHECK_FALSE(is_scene_name("scene.obj.gz"));
}

TEST_CASE("pbrt: a gzip'd PLY file is read, and a damaged one costs its shape alone") {
    const fs::path folder = test::scratch_folder();
    const std::string ply = gzipped("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                                    "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                                    "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    test::write_text(folder / "a.ply.gz", ply);
    test::write_text(folder / "b.ply.gz", ply.substr(0, ply.size() - 9));
    Messages messages;
    const Scene scene =
        read_scene(test::write_text(folder / "scene.pbrt", "WorldBegin\n"
                                                           "Shape \"plymesh\" \"string filename\" \"a.ply.gz\"\n"
                                                           "Shape \"plymesh\" \"string filename\" \"b.ply.gz\"\n"),
                   {}, messages);
    REQUIRE(scene.instances.size() == 1);
    CHECK(scene.instances[0].name == "a");
    CHECK(scene.meshes[0].triangle_count() == 1);
    REQUIRE(messages.left_out().size() == 1);
    CHECK(messages.left_out()[0].find("b.ply.gz") != std::string::npos);
    CHECK(read_scene(folder / "a.ply.gz", {}, messages).meshes.at(0).triangle_count() == 1); // by itself
    CHECK_FALSE(defines_space(folder / "a.ply.gz"));
}

TEST_CASE("pbrt: files that include themselves, or grow without reason, end") {
    const fs::path folder = test::scratch_folder();
    Messages messages;
    const fs::path self = test::write_text(folder / "self.pbrt", "WorldBegin\n" + kFlat + "Include \"self.pbrt\"\n");
    CHECK(read_scene(self, {}, messages).instances.size() == 64);
    CHECK(messages.left_out().size() == 1);
    // Doubling at each of 64 levels.
    const fs::path twice = test::write_text(
        folder / "twice.pbrt", std::string(1 << 16, '#') + "\nInclude \"twice.pbrt\" Include \"twice.pbrt\"\n");
    CHECK(test::thrown_error([&] { (void)read_scene(twice, {}, messages); })->code() == ErrorCode::OverLimit);
    const fs::path small = test::write_text(folder / "small.pbrt", "Include \"small.pbrt\" Include \"small.pbrt\"\n");
    CHECK(test::thrown_error([&] { (void)read_scene(small, {}, messages); })->code() == ErrorCode::OverLimit);
    std::string crowd = "WorldBegin ObjectBegin \"a\"\n";
    for (int i = 0; i < 1000; ++i) crowd += "Shape \"sphere\"\n";
    crowd += "ObjectEnd\n";
    for (int i = 0; i < 3000; ++i) crowd += "ObjectInstance \"a\"\n";
    const std::optional<Error> error = test::thrown_error([&] { (void)load_pbrt(crowd, messages); });
    CHECK((error && error->code() == ErrorCode::OverLimit));
    CHECK((error && error->location() && error->location()->line > 1002)); // before all of them are there
}

TEST_CASE("pbrt: lists of attributes, which each statement copies, have a limit together") {
    std::string list;
    for (int i = 0; i < 300; ++i) list += " 0.5";
    const auto attribute = [&](const char* name) {
        return fmt::format("Attribute \"shape\" \"float {}\" [{} ]\n", name, list);
    };
    Messages messages;
    const Scene scene = load_pbrt("WorldBegin\n" + attribute("alpha") + attribute("b") +
                                      "Attribute \"shape\" \"string c\" \"" + std::string(3000, 'c') + "\"\n" + kFlat,
                                  messages);
    REQUIRE(scene.instances.size() == 1);
    CHECK(scene.materials[scene.instances[0].material].alpha == 0.5f); // the first is kept
    CHECK(left_out_at(messages, 2).empty());
    CHECK_FALSE(left_out_at(messages, 3).empty());
    CHECK_FALSE(left_out_at(messages, 4).empty());
    const Scene too_late = load_pbrt("WorldBegin\n" + attribute("b") + attribute("alpha") + kFlat, messages);
    CHECK(too_late.materials[too_late.instances[0].material].alpha == 1);
}

TEST_CASE("pbrt: a camera without a usable view is left out alone") {
    for (const char* view : {"LookAt 0 0 5e12 0 0 0 0 1 0\nCamera \"perspective\"\n",
                             "Camera \"perspective\" \"float screenwindow\"\n[-1e30 1e30 -1e30 1e30]\n",
                             "Camera \"perspective\"\n\"float fov\" 1e-300\n",
                             "Camera \"orthographic\"\n\"float screenwindow\" [0 1e-300 0 1e-300]\n"}) {
        CAPTURE(view);
        Messages messages;
        const Scene scene = load_pbrt(view + ("WorldBegin\n" + kFlat), messages);
        CHECK(scene.instances.size() == 1);
        CHECK(scene.cameras.empty());
        CHECK(messages.left_out().size() == 1);
    }
}

TEST_CASE("pbrt: files outside of the allowed folders are not read") {
    const fs::path folder = test::scratch_folder();
    fs::create_directory(folder / "inside");
    test::write_text(folder / "outside.pbrt", kFlat);
    const std::string text = "WorldBegin\n" + kFlat + "Include \"../outside.pbrt\"\n";
    const fs::path scene = test::write_text(folder / "inside" / "scene.pbrt", text);
    Messages messages;
    CHECK(read_scene(scene, {}, messages).instances.size() == 1);
    CHECK(messages.left_out().size() == 1);
    ReadOptions options;
    options.allowed_paths = {folder};
    Messages none;
    CHECK(read_scene(scene, options, none).instances.size() == 2);
    CHECK(none.left_out().empty());
}

TEST_CASE("gzip: all members are read, and a damaged or multiplied file is refused") {
    const auto bytes_of = [](const std::string& text) {
        std::vector<std::byte> bytes(text.size());
        std::memcpy(bytes.data(), text.data(), text.size());
        return bytes;
    };
    const std::string one = gzipped("one "), two = gzipped(std::string(3'000'000, 'x'));
    const std::vector<std::byte> both = gunzip(bytes_of(one + two), "a.gz");
    CHECK(both.size() == 3'000'004);
    CHECK(static_cast<char>(both[0]) == 'o');
    for (const std::string& bad :
         {one.substr(0, one.size() - 1), two.substr(0, two.size() / 2), one.substr(0, 12) + "????????????"}) {
        CHECK(test::is_at(test::thrown_error([&] { (void)gunzip(bytes_of(bad), "a.gz"); }), ErrorCode::BadInput,
                          {"a.gz"}));
    }
    CHECK(gunzip(bytes_of(two), "a.gz", 3'000'000).size() == 3'000'000);
    CHECK(test::is_at(test::thrown_error([&] { (void)gunzip(bytes_of(two), "a.gz", 2'999'999); }), ErrorCode::OverLimit,
                      {"a.gz"}));
    // A thousandth of what it decompresses to, as a bomb is.
    std::string bomb;
    for (const std::string& piece = gzipped(std::string(1 << 24, ' ')); bomb.size() < 17 * piece.size();) bomb += piece;
    const fs::path scene = test::write_text(test::scratch_folder() / "bomb.pbrt.gz", bomb);
    Messages messages;
    const std::optional<Error> error = test::thrown_error([&] { (void)read_scene(scene, {}, messages); });
    CHECK(test::is_at(error, ErrorCode::OverLimit, {scene.string()}));
    CHECK(test::says(error, "decompresses to over 264 MiB"));
    const UnzippedFile file = read_unzipped(test::write_text(scene.parent_path() / "two.gz", two));
    CHECK(file.bytes.size() == 3'000'000);
    CHECK(file.size == two.size());
}

TEST_CASE("pbrt: a scene far from its origin keeps its precision") {
    std::string text = "Scale -1 1 1 Translate -10000000.25 0 -9 Camera \"perspective\" WorldBegin Shape "
                       "\"trianglemesh\" \"point3 P\" [10000000.125 0 0 10000001 0 0 10000000.125 1 "
                       "0] \"integer indices\" [0 1 2]\n"
                       "LightSource \"point\" \"point3 from\" [10000000.625 0 1]\n";
    const Scene scene = load_whole(text);
    CHECK(scene.is_far);
    const auto is_at = [&](Vec3 p, DoubleVec3 wanted) { CHECK(in_file(scene, p) == wanted); };
    is_at(transform_point(scene.instances[0].world_from_local, scene.meshes[0].positions[0]), {10000000.125, 0, 0});
    is_at(scene.lights[0].position, {10000000.625, 0, 1});
    is_at(scene.cameras[0].world_from_camera.translation, {10000000.25, 0, 9});
}

TEST_CASE("pbrt: geometry alone is grey and dark") {
    Messages messages;
    ReadOptions options;
    options.geometry_only = true;
    const Scene scene =
        load_pbrt("WorldBegin Texture \"a\" \"spectrum\" \"imagemap\" \"string filename\" \"none.png\"\n"
                  "Material \"conductor\" AreaLightSource \"diffuse\" \"rgb L\" [1 1 1]\n" +
                      kFlat,
                  messages, options);
    CHECK(messages.left_out().empty());
    REQUIRE(scene.materials.size() == 1);
    CHECK(scene.materials[0].kind == MaterialKind::Diffuse);
    CHECK(is_black(scene.materials[0].emission));
}
