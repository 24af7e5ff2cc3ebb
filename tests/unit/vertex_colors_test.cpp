#include <doctest/doctest.h>

#include "formats/obj/read_obj.h"
#include "formats/ply/read_ply.h"
#include "image/srgb.h"
#include "image/write_png.h"
#include "tests/support/options.h"
#include "tests/support/write_text.h"

namespace fs = std::filesystem;
using namespace pertev;

namespace vertex_colors_test { // test files are compiled together

struct Loaded {
    Scene scene;
    Messages messages;
};

Loaded load(const std::string& name, const std::string& text) {
    const fs::path path = test::write_text(test::scratch_folder() / name, text);
    Loaded l;
    l.scene = name.ends_with(".ply") ? read_ply(path, FileAccess(path, {}), {}, l.messages)
                                     : read_obj(path, FileAccess(path, {}), {}, l.messages);
    return l;
}

Loaded load_obj(const std::string& a, const std::string& b = "0 0 0", const std::string& c = "0 0 0") {
    return load("a.obj", "v 0 0 0 " + a + "\nv 1 0 0 " + b + "\nv 0 1 0 " + c + "\nf 1 2 3\n");
}

/// Three vertices of one colour.
Loaded load_ply(const std::string& type, const std::string& color) {
    std::string text =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
    for (const char* channel : {"red", "green", "blue", "alpha"}) text += "property " + type + " " + channel + "\n";
    text += "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    for (const char* place : {"0 0 0 ", "1 0 0 ", "0 1 0 "}) text += place + color + "\n";
    return load("a.ply", text + "3 0 1 2\n");
}

void check_color(const Loaded& l, Vec4 right) {
    const Vec4 c = l.scene.meshes[0].colors[0];
    CHECK(c.x == doctest::Approx(right.x).epsilon(1e-5));
    CHECK(c.y == doctest::Approx(right.y).epsilon(1e-5));
    CHECK(c.z == doctest::Approx(right.z).epsilon(1e-5));
    CHECK(c.w == doctest::Approx(right.w).epsilon(1e-5));
}

TEST_CASE("obj: vertex colours are read as sRGB, and the material is white") {
    const Loaded l = load_obj("1 0.5 0", "0 1 0", "0 0 1");
    check_color(l, {1, srgb_decode(0.5f), 0, 1});
    CHECK(l.scene.materials[0].base_color == grey(1));
    CHECK(l.messages.all().empty());
}

TEST_CASE("obj: colours are read as 0 to 255 if any in the file is 2 or more, with a notice") {
    const Loaded bright = load_obj("255 128 0");
    check_color(bright, {1, 0.215861f, 0, 1});
    REQUIRE(bright.messages.all().size() == 1);
    CHECK_FALSE(bright.messages.all()[0].is_warning);
    check_color(load_obj("20 10 1"), {0.00699541f, 0.00303527f, 0.000303527f, 1});
    check_color(load_obj("1 0 1", "0 0 0", "0 2 0"),
                {0.000303527f, 0, 0.000303527f, 1}); // another vertex has a value of 2 or more
    check_color(load_obj("1 0.5 0", "1.5 1 1"), {1, srgb_decode(0.5f), 0, 1}); // a highlight, not a byte
    check_color(load_obj("1.0000001 0.5 0"), {srgb_decode(1.0000001f), srgb_decode(0.5f), 0, 1});
}

TEST_CASE("obj: a vertex without a colour among coloured ones is white, in either range") {
    for (const std::string color : {"255 0 0", "1 0 0"}) {
        const Loaded l = load("a.obj", "v 0 0 0\nv 1 0 0 " + color + "\nv 0 1 0\nf 1 2 3\n");
        const std::vector<Vec4>& colors = l.scene.meshes[0].colors;
        CHECK(colors == std::vector<Vec4>{{1, 1, 1, 1}, {1, 0, 0, 1}, {1, 1, 1, 1}});
    }
}

TEST_CASE("ply: colours mean the same in bytes, floats and OBJ") {
    const Vec4 right = {1, 0.215861f, 0, 1};
    check_color(load_ply("uchar", "255 128 0 255"), right);
    check_color(load_ply("float", "1 0.50196078 0 1"), right);
    check_color(load_ply("double", "1 0.50196078 0 1"), right);
    check_color(load_ply("ushort", "65535 32896 0 65535"), right);
    check_color(load_ply("float", "255 128 0 255"), right);
    check_color(load_ply("float", "255 128 0 1"), right); // only alpha is present
    check_color(load_ply("float", "0.5 0.5 0.5 0.25"), {0.2140411f, 0.2140411f, 0.2140411f, 0.25f});
    check_color(load_ply("uchar", "128 128 128 51"), {0.215861f, 0.215861f, 0.215861f, 0.2f});
}

TEST_CASE("vertex colours with a texture are left out with a warning, but used if the texture cannot be read") {
    const fs::path folder = test::scratch_folder();
    write_png(folder / "t.png", Rgba8Image{.width = 1, .height = 1, .pixels = {255, 0, 0, 255}}, true);
    test::write_text(folder / "a.mtl", "newmtl t\nmap_Kd t.png\nnewmtl broken\nmap_Kd a.mtl\nnewmtl plain\nKd 1 1 1\n");
    std::string obj = "mtllib a.mtl\nv 0 0 0 0 1 0\nv 1 0 0 0 1 0\nv 0 1 0 0 1 0\nvt 0 0\n";
    for (const char* name : {"t", "broken", "plain"}) obj += std::string("usemtl ") + name + "\nf 1/1 2/1 3/1\n";
    const fs::path path = test::write_text(folder / "a.obj", obj);
    Messages messages;
    const Scene scene = read_obj(path, FileAccess(path, {}), {}, messages);
    CHECK(scene.meshes[0].colors.empty());
    CHECK(scene.meshes[1].colors.size() == 3);
    CHECK(scene.meshes[2].colors.size() == 3);
    CHECK(messages.all().size() == 2); // one message about the colours, and one about the unreadable picture
}

} // namespace vertex_colors_test
