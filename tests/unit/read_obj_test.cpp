#include <doctest/doctest.h>

#include <algorithm>

#include "base/parallel_for.h"
#include "formats/mesh/triangulate_polygon.h"
#include "formats/obj/read_obj.h"
#include "image/write_png.h"
#include "tests/support/options.h"
#include "tests/support/thrown_error.h"
#include "tests/support/write_text.h"

namespace fs = std::filesystem;
using namespace pertev;

namespace {

struct Loaded {
    Scene scene;
    Messages messages;

    bool reports(const std::string& text) const {
        return std::any_of(messages.all().begin(), messages.all().end(),
                           [&](const Message& message) { return message.text.find(text) != std::string::npos; });
    }
    const Material& material(const std::string& name) const {
        for (const Material& material : scene.materials) {
            if (material.name == name) return material;
        }
        throw std::runtime_error("no material " + name);
    }
};

Loaded load(const fs::path& path, const ReadOptions& options = {}) {
    Loaded loaded;
    loaded.scene = read_obj(path, FileAccess(path, options.allowed_paths), options, loaded.messages);
    return loaded;
}

Loaded load_text(const std::string& obj, const std::string& mtl = "") {
    const fs::path folder = test::scratch_folder();
    test::write_text(folder / "a.mtl", mtl);
    return load(test::write_text(folder / "a.obj", obj));
}

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

/// Surface of one material m described by `lines`.
Material material_of(const std::string& lines) {
    return load_text("mtllib a.mtl\n" + kTriangle + "usemtl m\nf 1 2 3\n", "newmtl m\n" + lines).material("m");
}

void write_picture(const fs::path& path, uint32_t size, uint8_t (*value)(uint32_t x, uint32_t channel)) {
    Rgba8Image image{.width = size, .height = size, .pixels = {}};
    for (uint32_t i = 0; i < size * size * 4; ++i) image.pixels.push_back(value(i / 4 % size, i % 4));
    write_png(path, image, true);
}

double area(const std::vector<Vec3>& p, const std::vector<uint32_t>& indices) {
    double sum = 0; // signed, seen from +z
    for (std::size_t i = 0; i < indices.size(); i += 3) {
        const Vec3 n = cross(p[indices[i + 1]] - p[indices[i]], p[indices[i + 2]] - p[indices[i]]);
        CHECK(n.z >= 0);
        sum += 0.5 * static_cast<double>(n.z);
    }
    return sum;
}

} // namespace

TEST_CASE("each material gets one mesh and one instance, in the order of first use") {
    const Loaded l = load_text("mtllib a.mtl\n" + kTriangle +
                                   "usemtl b\nf 1 2 3\ns 1\nusemtl a\nf 3 2 1\nusemtl b\nf 1 3 2\nusemtl unused\n",
                               "newmtl a\nKd 1 0 0\nnewmtl b\nKd 0 1 0\nnewmtl unused\n");
    REQUIRE(l.scene.meshes.size() == 2);
    REQUIRE(l.scene.instances.size() == 2);
    CHECK(l.scene.meshes[0].triangle_count() == 2);
    CHECK(l.scene.meshes[0].positions.size() == 3);
    CHECK(l.scene.materials[l.scene.instances[0].material].base_color == Rgb{0, 1, 0});
    CHECK(l.scene.materials[l.scene.instances[1].material].base_color == Rgb{1, 0, 0});
}

TEST_CASE("corners share a vertex only where position, texture coordinate and normal agree") {
    const Loaded l = load_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0.25\nvt 1 0\nvn 0 0 1\nvn 1 0 0\n"
                               "f 1/1/1 2/2/1 3/1/1\nf 1/1/1 3/1/1 4/2/1\nf 1/2/1 2/2/1 3/1/2\n");
    REQUIRE(l.scene.meshes.size() == 1);
    const Mesh& mesh = l.scene.meshes[0];
    CHECK(mesh.indices == std::vector<uint32_t>{0, 1, 2, 0, 2, 3, 4, 1, 5});
    CHECK(mesh.uv[0][0] == Vec2{0, 0.75f}); // v runs down
    CHECK(mesh.normals[5] == Vec3{1, 0, 0});
    CHECK(mesh.positions[5] == Vec3{1, 1, 0});
}

TEST_CASE(
    "the front of an emitter follows its vertex normals, or else its winding, and no other surface is turned over") {
    const auto read = [](const std::string& normals, const std::string& face, const std::string& emission) {
        return load_text("mtllib a.mtl\n" + kTriangle + normals + "usemtl m\nf " + face + "\n", "newmtl m\n" + emission)
            .scene;
    };
    const auto front_z = [](const Mesh& mesh) {
        const auto corner = [&](std::size_t i) { return mesh.positions[mesh.indices[i]]; };
        return cross(corner(1) - corner(0), corner(2) - corner(0)).z;
    };
    const std::string up = "vn 0 0 1\n", down = "vn 0 0 -1\n", with_normals = "1//1 2//1 3//1";
    CHECK(front_z(read("", "1 2 3", "Ke 1 1 1\n").meshes[0]) > 0);
    CHECK(front_z(read("", "3 2 1", "Ke 1 1 1\n").meshes[0]) < 0);
    CHECK(front_z(read(up, with_normals, "Ke 1 1 1\n").meshes[0]) > 0);
    CHECK(front_z(read(down, with_normals, "Ke 1 1 1\n").meshes[0]) < 0);
    CHECK(front_z(read(down, "1 2//1 3", "Ke 1 1 1\n").meshes[0]) < 0); // some corners have one
    CHECK(front_z(read(down, with_normals, "Kd 1 1 1\n").meshes[0]) > 0);
    const Material emitter = read("", "1 2 3", "Ke 1 1 1\n").materials[0];
    CHECK(emitter.double_sided);
    CHECK_FALSE(emitter.two_sided_emission);
}

TEST_CASE("relative indices, comments, joined lines, CRLF and lone CR line ends are read") {
    const std::vector<uint32_t> expected = {0, 1, 2};
    for (const std::string end : {"\n", "\r\n", "\r"}) {
        std::string text = "\xef\xbb\xbf# a comment;v 0 0 0 # zero;v 1 \\;0 0;\tv  0 1\t0;;f -3 -2 -1 # end;";
        for (std::size_t at = text.find(';'); at != text.npos; at = text.find(';', at)) text.replace(at, 1, end);
        const Loaded l = load_text(text);
        REQUIRE(l.scene.meshes.size() == 1);
        CHECK(l.scene.meshes[0].indices == expected);
        CHECK(l.scene.meshes[0].positions[1] == Vec3{1, 0, 0});
        if (end != "\r") CHECK(l.messages.all().empty());
    }
}

TEST_CASE("numbers are read to the nearest float") {
    const Loaded l = load_text("v 0.1 1e-3 +1e-46\nv 16777217.0000001 1e39 -1e-60\nv .5 -5. 1e999999999\n"
                               "f 1 2 3\n");
    const std::vector<Vec3>& p = l.scene.meshes[0].positions;
    CHECK(p[0] == Vec3{0.1f, 0.001f, 0.0f});
    CHECK(p[1] == Vec3{16777218.0f, kInfinity, 0.0f});
    CHECK(p[2] == Vec3{0.5f, -5.0f, kInfinity});
}

TEST_CASE("missing and unreadable numbers become NaN, with a warning that names the first line") {
    const Loaded l = load_text("v 0 0 0\nv 1 nan 0\nv 1 zero 0\nv 0 1\nf 1 2 3 4\n");
    const std::vector<Vec3>& p = l.scene.meshes[0].positions;
    CHECK(!is_finite(p[1]));
    CHECK(!is_finite(p[2]));
    CHECK(!is_finite(p[3]));
    CHECK(l.reports("a.obj:3: 2 lines"));
}

TEST_CASE("a face with a missing vertex is left out with its line, and the others are read") {
    for (const std::string face : {"f 1 2 4", "f 1 2 -4", "f 0 1 2", "f 1 2 99999999999999999999", "f 1 2 4294967296",
                                   "f 1 2 c", "f 1/1/1/1 2 3", "f 1.5 2 3", "f / 2 3"}) {
        CAPTURE(face);
        const Loaded l = load_text(kTriangle + "f 1 2 3\n" + face + "\n" + face + " 1\nf 3 2 1\n");
        REQUIRE(l.scene.meshes.size() == 1);
        CHECK(l.scene.meshes[0].triangle_count() == 2);
        REQUIRE(l.messages.left_out().size() == 1);
        CHECK(l.messages.left_out()[0].find("a.obj:5: ") != std::string::npos);
        CHECK(l.messages.left_out()[0].find("2 ") != std::string::npos);
    }
    const Loaded none = load_text(kTriangle + "f 1 2 4\n");
    CHECK(none.scene.instances.empty());
    CHECK(none.scene.no_instances.find("a.obj:4: ") != std::string::npos);
}

TEST_CASE("an index may refer to a later vertex, and a texture index to a missing coordinate") {
    const Loaded l = load_text("f 1/7 2/7 3/7\n" + kTriangle);
    CHECK(l.scene.meshes[0].triangle_count() == 1);
    CHECK(l.scene.meshes[0].uv[0].empty());
    CHECK(l.reports("a.obj:1: 3 face corners"));
}

TEST_CASE("lines, points, curves and garbage are left out with one warning per kind") {
    const Loaded l = load_text(kTriangle + "l 1 2\np 1\ncstype bezier\ncurv 0 1 1 2\nwhat is this\nf 1 2\nf 1 2 3\n");
    CHECK(l.scene.meshes[0].triangle_count() == 1);
    CHECK(l.messages.all().size() == 4);
}

TEST_CASE("polygons of any shape are split into triangles that cover them once") {
    const std::vector<Vec3> arrow = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 0.5f, 0}, {0, 2, 0}};
    const std::vector<Vec3> dart = {{0, 0, 0}, {4, -3, 0}, {1, 0, 0}, {4, 3, 0}};
    std::vector<Vec3> comb = {{0, 0, 0}, {100, 0, 0}};
    for (int i = 99; i > 0; --i) comb.push_back({static_cast<float>(i), i % 2 ? 10.0f : 1.0f, 0});
    for (const auto& [polygon, expected] : {std::pair(arrow, 2.5), std::pair(dart, 3.0), std::pair(comb, 549.0)}) {
        for (const float far : {0.0f, 4096.0f}) {
            std::vector<Vec3> moved = polygon;
            for (Vec3& p : moved) p += Vec3{far, far, far};
            std::vector<uint32_t> cut;
            triangulate_polygon(moved, cut);
            CHECK(cut.size() == 3 * (polygon.size() - 2));
            CHECK(area(moved, cut) == doctest::Approx(expected).epsilon(1e-4));
        }
    }
}

TEST_CASE("a polygon of very many corners, spiral or scrambled, is triangulated quickly") {
    std::vector<Vec3> polygon;
    for (uint32_t i = 0; i < 300'000; ++i) {
        const uint32_t scrambled = i * 2654435761u;
        polygon.push_back({static_cast<float>(scrambled >> 16), static_cast<float>(scrambled & 0xffff), 0});
    }
    std::vector<uint32_t> cut;
    triangulate_polygon(polygon, cut);
    CHECK(cut.size() == 3 * (polygon.size() - 2));
}

TEST_CASE("mtl: a Phong material is converted to diffuse and glossy lobes") {
    CHECK(material_of("Kd 0.2 0.3 0.4\nKs 0 0 0\nNs 10\nillum 2").kind == MaterialKind::Diffuse);
    CHECK(material_of("Kd 0.2 0.3 0.4").base_color == Rgb{0.2f, 0.3f, 0.4f});
    CHECK(material_of("Kd 0.8 0.8 0.8\nKs 0.5 0.5 0.5\nNs 225").kind == MaterialKind::Diffuse);
    CHECK(material_of("Kd 0.8 0.8 0.8\nKs 0.4 0.4 0.4\nNs 225\nillum 1").kind == MaterialKind::Diffuse);

    const Material glossy = material_of("Kd 0.5 0.5 0.5\nKs 0.04 0.04 0.04\nNs 30");
    CHECK(glossy.kind == MaterialKind::MetallicRoughness);
    CHECK(glossy.metallic == 0);
    CHECK(glossy.roughness == doctest::Approx(0.5)); // alpha = sqrt(2 / 32) = 1 / 4
    CHECK(glossy.ior == doctest::Approx(1.5));

    const Material mirror = material_of("Kd 0 0 0\nKs 0.9 0.8 0.7\nNs 1000\nillum 3");
    CHECK(mirror.kind == MaterialKind::MetallicRoughness);
    CHECK(mirror.metallic == 1);
    CHECK(mirror.roughness == 0);
    CHECK(mirror.base_color == Rgb{0.9f, 0.8f, 0.7f});

    const Material glass = material_of("Kd 0 0 0\nKs 1 1 1\nTf 0.25 1 1\nNi 1.33\nillum 7");
    CHECK(glass.kind == MaterialKind::Dielectric);
    CHECK(glass.ior == 1.33f);
    CHECK(glass.roughness == 0);
    CHECK(glass.base_color == Rgb{0.5f, 1, 1});
    CHECK(material_of("Kd 0 0 0\nTf 1 1 1\nNi 1.5\nd 0.1").kind == MaterialKind::Dielectric);
    for (const std::string illum : {"4", "9"}) {
        CHECK(material_of("Kd 0.01 0 0\nKs 1 1 1\nNi 1.5\nillum " + illum).kind == MaterialKind::Dielectric);
        CHECK(material_of("Kd 0 0 0\nNi 1.5\nd 0.3\nillum " + illum).kind == MaterialKind::Dielectric);
    }

    const Material pbr = material_of("Kd 1 0 0\nPr 0.3\nPm 0.9");
    CHECK(pbr.kind == MaterialKind::MetallicRoughness);
    CHECK(pbr.roughness == 0.3f);
    CHECK(pbr.metallic == 0.9f);

    const Material clear = material_of("Kd 1 1 1\nd 0.25");
    CHECK(clear.kind == MaterialKind::Diffuse);
    CHECK(clear.alpha_mode == AlphaMode::Blend);
    CHECK(clear.alpha == 0.25f);
    for (const std::string illum : {"2", "4", "9"}) { // a half-transparent red sheet keeps its red
        const Material sheet = material_of("Kd 1 0 0\nNi 1.5\nd 0.5\nillum " + illum);
        CHECK(sheet.kind == MaterialKind::Diffuse);
        CHECK(sheet.base_color == Rgb{1, 0, 0});
        CHECK(sheet.alpha_mode == AlphaMode::Blend);
        CHECK(sheet.alpha == 0.5f);
    }
    CHECK(material_of("Kd 0 0 0\nKe 17 12 4").emission == Rgb{17, 12, 4});
}

TEST_CASE("mtl: a line with a missing, unreadable or infinite number is left out with file and line") {
    for (const std::string line : {"Kd oops 1 1", "Kd nan 0 0", "Kd 1e999 0 0", "Kd", "Kd 1 1", "Kd 1 1 # 1",
                                   "Ks 1,1,1", "illum xx", "d foo", "Tr", "Ns zzz", "Ni inf", "Pr -nan", "aniso x",
                                   "map_Kd -bm x t.png", "map_Kd -clamp maybe t.png", "map_Kd -s 1e99 1 t.png"}) {
        CAPTURE(line);
        const Loaded l = load_text("mtllib a.mtl\n" + kTriangle + "usemtl m\nf 1 2 3\n",
                                   "newmtl m\n# a comment\n" + line + "\nKe 1 2 3\n");
        REQUIRE(l.messages.left_out().size() == 1);
        CHECK(l.reports("a.mtl:3: "));
        CHECK(l.messages.left_out().size() == 1);
        CHECK(l.material("m").base_color == grey(0.5f));
        CHECK(l.material("m").emission == Rgb{1, 2, 3});
    }
}

TEST_CASE("mtl: unread lines cause one warning that names the first") {
    const Loaded l = load_text("mtllib a.mtl\n" + kTriangle + "usemtl m\nf 1 2 3\n",
                               "Kd 1 0 0\nnewmtl m\nfoo 3\nmap_Normal x.png\nKd spectral x.rfl\nmap_Ks t.png\n"
                               "map_Ks u.png\nNs 10 11\naniso 0.5\naniso 0\nKa 1 1 1\nsharpness 60\nmap_Ka t.png\n");
    CHECK(l.reports("a.mtl:1: 3 lines"));
    CHECK(l.reports("a.mtl:5: 1 line of Kd spectral"));
    CHECK(l.reports("a.mtl:6: 2 lines of map_Ks"));
    CHECK(l.reports("a.mtl:8: 1 line"));
    CHECK(l.messages.all().size() == 4);
    CHECK(l.material("m").base_color == grey(0.5f));
}

TEST_CASE("mtl: one number is a grey, keys ignore case, and without Kd a material is grey") {
    CHECK(material_of("Kd 0.25").base_color == grey(0.25f));
    CHECK(material_of("kd 1 0 0 # red").base_color == Rgb{1, 0, 0});
    CHECK(material_of("KE 3").emission == grey(3));
    CHECK(material_of("d -halo 0.5").alpha == 0.5f);
    CHECK(material_of("Tr 0.25").alpha == 0.75f);
    CHECK(material_of("d 0.5\nTr 0.25").alpha == 0.5f);
    CHECK(material_of("Ns 10").base_color == grey(0.5f));
    CHECK(material_of("Ks 0.04\nNs 30").base_color == grey(0.5f));
    CHECK(material_of("Ks 0.9 0.8 0.7\nNs 30").base_color == Rgb{0.9f, 0.8f, 0.7f}); // metal, not a coat on grey
    CHECK(material_of("Kd 0 0 0").base_color == grey(0));
}

TEST_CASE("mtl: byte order marks, comments and blanks around a name are not part of it") {
    for (const std::string start : {"newmtl a b", "newmtl  a b", "newmtl a b ", "newmtl\ta b\r", "newmtl a b # x",
                                    "\xef\xbb\xbfnewmtl a b", "# C:\\scenes\\\nnewmtl a b #", "  newmtl a b"}) {
        CAPTURE(start);
        const Loaded l = load_text("mtllib a.mtl # the materials\n" + kTriangle + "usemtl a b # c\nf 1 2 3\n",
                                   start + "\nKd 1 0 0\n");
        CHECK(l.material("a b").base_color == Rgb{1, 0, 0});
        CHECK(l.messages.all().empty());
    }
    const Loaded l = load_text("mtllib a.mtl\n" + kTriangle + "usemtl Material #25\nf 1 2 3\n",
                               "newmtl Material #25\nKd 1 0 0\nnewmtl Material #26\n");
    CHECK(l.material("Material #25").base_color == Rgb{1, 0, 0});
}

TEST_CASE("mtl: many files on one line may together be longer than a name") {
    const fs::path folder = test::scratch_folder();
    std::string line = "mtllib";
    for (int i = 0; i < 9; ++i) {
        const std::string name = "materials_of_the_building_number_" + std::to_string(i);
        test::write_text(folder / (name + ".mtl"), "newmtl " + std::to_string(i) + "\nKd 1 0 0\n");
        line += " " + name + ".mtl";
    }
    const Loaded l = load(test::write_text(folder / "a.obj", line + "\n" + kTriangle + "usemtl 8\nf 1 2 3\n"));
    CHECK(l.material("8").base_color == Rgb{1, 0, 0});
    CHECK(l.messages.all().empty());

    const std::string endless(100'000, 'x');
    const Loaded none = load_text("mtllib " + endless + "\n" + kTriangle + "usemtl " + endless + "\nf 1 2 3\n");
    REQUIRE(none.messages.all().size() == 2);
    for (const Message& message : none.messages.all()) CHECK(message.text.size() < 1000);
}

TEST_CASE("mtl: a texture on faces without texture coordinates causes a warning") {
    const fs::path folder = test::scratch_folder();
    write_picture(folder / "my t.png", 4, [](uint32_t, uint32_t) -> uint8_t { return 200; });
    test::write_text(folder / "a.mtl",
                     "newmtl m\nmap_Kd -t 0.1 0.1 0.1 -cc on my t.png # colours\nnewmtl plain\nKd 1\n");
    const std::string start = "mtllib a.mtl\nvt 0 0\n" + kTriangle;
    const std::string textured = "usemtl m\nf 1/1 2/1 3/1\n", bare = "f 1 2 3\n", plain = "usemtl plain\nf 1 2 3\n";
    const Loaded good = load(test::write_text(folder / "a.obj", start + textured + plain));
    CHECK(good.messages.all().empty());
    CHECK(good.material("m").base_color_texture.has_image());
    CHECK(good.material("m").base_color == grey(1)); // without Kd only the map counts
    const Loaded bad = load(test::write_text(folder / "b.obj", start + textured + bare + plain));
    CHECK(bad.reports("b.obj: 1 material"));
}

TEST_CASE("mtl: textures may have options, spaces, backslashes and alpha") {
    const fs::path folder = test::scratch_folder();
    fs::create_directories(folder / "my maps");
    const auto outline = [](uint32_t x, uint32_t channel) -> uint8_t { return channel < 3 ? 200 : (x < 8 ? 0 : 255); };
    const auto fade = [](uint32_t x, uint32_t channel) -> uint8_t {
        return channel == 3 ? 255 : static_cast<uint8_t>(16 * x);
    };
    const auto bluish = [](uint32_t, uint32_t channel) -> uint8_t { return channel < 2 ? 128 : 255; };
    write_picture(folder / "my maps" / "leaf one.png", 16, outline);
    write_picture(folder / "fade.png", 16, fade);
    write_picture(folder / "normal.png", 16, bluish);
    test::write_text(folder / "broken.png", "this is not an image");
    test::write_text(folder / "a.mtl", "newmtl leaf\nKd 1 1 1\nmap_Kd -s 2 3 my maps\\leaf one.png\n"
                                       "map_d -imfchan m my maps/leaf one.png\n"
                                       "newmtl fade\nKd 1 1 1\nmap_d fade.png\nmap_Bump -bm 0.2 normal.png\n"
                                       "newmtl offset\nKd 1 1 1\nmap_Kd -clamp on -o 0.25 fade.png\nbump fade.png\n"
                                       "newmtl missing\nKd 0.3 0.3 0.3\nmap_Kd none.png\n"
                                       "newmtl uri\nKd 1 1 1\nmap_Kd file:///C:/x/my%20maps/leaf%20one.png\n"
                                       "newmtl broken\nKd 0.3 0.3 0.3\nmap_Kd broken.png\nnorm normal.png\n");
    std::string obj = "mtllib a.mtl\n" + kTriangle;
    for (const char* name : {"leaf", "fade", "offset", "missing", "broken", "uri"}) {
        obj += std::string("usemtl ") + name + "\nf 1 2 3\n";
    }
    const Loaded l = load(test::write_text(folder / "a.obj", obj));
    REQUIRE(l.scene.images.size() == 4);

    const Material& leaf = l.material("leaf");
    CHECK(leaf.alpha_mode == AlphaMode::Mask);
    CHECK(!leaf.alpha_texture.has_image()); // the image is already the base colour's
    CHECK(leaf.base_color_texture.is_srgb);
    CHECK(leaf.base_color_texture.m00 == 2);
    CHECK(leaf.base_color_texture.m11 == 3);
    CHECK(leaf.base_color_texture.m12 == -2); // top stays v = 0 -> 1 - 3 + 3 v

    const Material& faded = l.material("fade");
    CHECK(faded.alpha_mode == AlphaMode::Blend);
    REQUIRE(faded.alpha_texture.has_image());
    CHECK(faded.alpha_texture.channel == 0);
    CHECK(faded.normal_texture.has_image()); // recognised
    CHECK(!faded.normal_texture.is_srgb);

    const Material& offset = l.material("offset");
    CHECK(offset.base_color_texture.m02 == 0.25f);
    CHECK(offset.base_color_texture.wrap_s == Wrap::ClampToEdge);
    CHECK(offset.normal_texture.image != faded.alpha_texture.image); // its heights became normals

    CHECK(l.material("uri").base_color_texture.image == leaf.base_color_texture.image);
    CHECK(!l.material("missing").base_color_texture.has_image());
    CHECK(l.reports("none.png"));
    CHECK(!l.material("broken").base_color_texture.has_image());
    CHECK(l.material("broken").normal_texture.image == faded.normal_texture.image);
    CHECK(l.reports("broken.png"));
}

TEST_CASE("obj: meshes and materials record their lines") {
    const Scene scene =
        load_text("mtllib a.mtl\n" + kTriangle + "usemtl m\n# a comment\nf 1 2 3\n", "# one\n\nnewmtl m\nKd 1 0 0\n")
            .scene;
    CHECK(scene.meshes.at(0).origin == "line 7");
    CHECK(scene.materials.at(0).origin.ends_with("a.mtl:3"));
}

TEST_CASE("mtl: a missing file or material is grey with a warning, and geometry alone is grey without one") {
    const Loaded missing = load_text("mtllib none.mtl other.mtl\n" + kTriangle + "usemtl x\nf 1 2 3\n");
    CHECK(missing.scene.materials[0].base_color == grey(0.5f));
    CHECK(missing.reports("none.mtl"));
    CHECK(missing.reports("(x is the first)"));

    const fs::path folder = test::scratch_folder();
    test::write_text(folder / "a.mtl", "newmtl x\nKd 1 0 0\nmap_Kd none.png\n");
    const fs::path path = test::write_text(folder / "a.obj", "mtllib a.mtl\n" + kTriangle + "usemtl x\nf 1 2 3\n");
    const Loaded grey_only = load(path, {.allowed_paths = {}, .geometry_only = true});
    CHECK(grey_only.scene.materials[0].base_color == grey(0.5f));
    CHECK(grey_only.messages.all().empty());
}

TEST_CASE("mtl: messages of several files come after those of the geometry, in any schedule") {
    const fs::path folder = test::scratch_folder();
    write_picture(folder / "shared.png", 2, [](uint32_t, uint32_t) { return uint8_t{100}; });
    const std::string first = "newmtl a\nmap_Kd shared.png\nnewmtl twice\nKd 1 0 0\n";
    test::write_text(folder / "a.mtl", first);
    test::write_text(folder / "b.mtl", "newmtl b\nmap_Kd shared.png\nmap_Ka gone.png\nnewmtl twice\nKd 0 1 0\n");
    test::write_text(folder / "bad.mtl", "newmtl c\nKd 1 2\n");
    const std::string faces =
        "vt 0 0\nusemtl a\nf 1/1 2/1 3/1\nusemtl b\nf 1/1 2/1 3/1\nusemtl twice\nf 1 2 3\nl 1 2\n";
    const std::string far(std::size_t(3) << 20, '\n'); // longer than the part that is searched for names
    const auto load_with = [&](const std::string& text) { return load(test::write_text(folder / "many.obj", text)); };
    for (const std::string& before : {std::string(), far}) {
        const Loaded l = load_with(before + "mtllib gone.mtl\nmtllib a.mtl\n" + kTriangle + faces + "mtllib b.mtl\n");
        REQUIRE(l.scene.materials.size() == 3);
        CHECK(l.scene.images.size() == 1);
        CHECK(l.material("a").base_color_texture.image == 0);
        CHECK(l.material("b").base_color_texture.image == 0);
        CHECK(l.material("twice").base_color == Rgb{1, 0, 0});
        const std::vector<Message>& all = l.messages.all();
        REQUIRE(all.size() >= 2);
        CHECK(all[1].text.find("gone.mtl") != std::string::npos);
        CHECK(all[1].is_left_out);

        Messages messages;
        const fs::path bad =
            test::write_text(folder / "bad.obj", before + "mtllib gone.mtl\nmtllib bad.mtl\n" + kTriangle);
        read_obj(bad, FileAccess(bad, {}), {}, messages);
        REQUIRE(messages.left_out().size() == 2);
        CHECK(messages.left_out()[0].find("gone.mtl") != std::string::npos);
        CHECK(messages.left_out()[1].find("bad.mtl:2") != std::string::npos);
    }
    const Loaded at_once = load_with("mtllib a.mtl\n" + kTriangle + faces);
    const UseThreads one(1);
    const Loaded in_turns = load_with("mtllib a.mtl\n" + kTriangle + faces);
    CHECK(in_turns.scene.images.size() == at_once.scene.images.size());
    CHECK(in_turns.messages.all().size() == at_once.messages.all().size());
}

TEST_CASE("mtl: a texture or material file outside the scene's folder is left out unless allowed") {
    const fs::path folder = test::scratch_folder();
    fs::create_directories(folder / "in");
    test::write_text(folder / "out.mtl", "newmtl x\nKd 1 0 0\n");
    const fs::path path =
        test::write_text(folder / "in" / "a.obj", "mtllib ../out.mtl\n" + kTriangle + "usemtl x\nf 1 2 3\n");
    const Loaded without = load(path);
    CHECK(without.reports("`allow_path="));
    CHECK(without.reports("a.obj:1: "));
    CHECK(without.messages.left_out().size() == 2); // one message each for the file and the material
    CHECK(load(path, {.allowed_paths = {folder}}).scene.materials[0].base_color == Rgb{1, 0, 0});

    test::write_text(folder / "in" / "b.mtl", "newmtl x\nmap_Kd /etc/passwd\n");
    const fs::path b = test::write_text(folder / "in" / "b.obj", "mtllib b.mtl\n" + kTriangle + "usemtl x\nf 1 2 3\n");
    const Loaded outside = load(b);
    CHECK(outside.reports("`allow_path="));
    CHECK(outside.reports("b.mtl:2: "));
    CHECK(outside.messages.left_out().size() == 1);
    CHECK(outside.scene.images.empty());
}

TEST_CASE("Sponza is split by material, and its leaves and chains are cut-outs") {
    const auto path = test::test_scene("crytek-sponza/sponza.obj");
    if (!path) return;
    const Loaded l = load(*path);
    CHECK(l.scene.meshes.size() == 24); // one of its 25 materials is not used
    std::size_t triangles = 0;
    for (const Mesh& mesh : l.scene.meshes) triangles += mesh.triangle_count();
    CHECK(triangles == 262'205);
    for (const Material& material : l.scene.materials) {
        const bool is_cut_out = material.name == "leaf" || material.name == "chain";
        CHECK(material.alpha_mode == (is_cut_out ? AlphaMode::Mask : AlphaMode::Opaque));
    }
    CHECK(l.messages.all().empty());
}
