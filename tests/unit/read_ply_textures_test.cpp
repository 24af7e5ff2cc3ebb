#include <doctest/doctest.h>

#include "base/error.h"
#include "formats/ply/read_ply.h"
#include "image/write_png.h"
#include "tests/support/options.h"
#include "tests/support/write_text.h"

namespace fs = std::filesystem;
using namespace pertev;

namespace read_ply_textures_test { // test files are compiled together

struct Loaded {
    Scene scene;
    Messages messages;

    bool reports(const std::string& text) const {
        for (const Message& message : messages.all()) {
            if (message.text.find(text) != std::string::npos) return true;
        }
        return false;
    }
    /// Returns the first texel of the instance's texture; black without a texture.
    std::array<int, 3> texel(std::size_t instance) const {
        const TextureRef& ref = scene.materials.at(scene.instances.at(instance).material).base_color_texture;
        if (!ref.has_image()) return {0, 0, 0};
        const std::vector<uint8_t>& bytes = scene.images.at(static_cast<std::size_t>(ref.image)).rgba8.pixels;
        return {bytes[0], bytes[1], bytes[2]};
    }
    const Mesh& mesh(std::size_t instance) const { return scene.meshes.at(scene.instances.at(instance).mesh); }
};

/// A file in a folder with red.png and blue one.png.
Loaded load(const std::string& text, bool geometry_only = false) {
    const fs::path folder = test::scratch_folder();
    write_png(folder / "red.png", Rgba8Image{.width = 1, .height = 1, .pixels = {255, 0, 0, 255}}, true);
    write_png(folder / "blue one.png", Rgba8Image{.width = 1, .height = 1, .pixels = {0, 0, 255, 255}}, true);
    const fs::path path = test::write_text(folder / "a.ply", text);
    Loaded l;
    l.scene = read_ply(path, FileAccess(path, {}), {.allowed_paths = {}, .geometry_only = geometry_only}, l.messages);
    return l;
}

const std::string kStart = "ply\nformat ascii 1.0\n", kRed = "comment TextureFile red.png\n";
const std::string kBlue = "comment TextureFile blue one.png\n";
const std::string kVertices = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
const std::string kSquare = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
const std::string kVertexUv = "property float texture_u\nproperty float texture_v\n";
const std::string kSquareUv = "0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 0.75\n0 1 0 0 0.75\n";
const std::string kList = "property list uchar int vertex_indices\n";
const std::string kFaceUv = "property list uchar float texcoord\n";

TEST_CASE("ply: a comment TextureFile is the texture of vertices with texture coordinates") {
    for (const std::string comment : {"comment TextureFile red.png\n", "comment TextureFile  red.png \r\n",
                                      "comment texturefile: red.png\n", "comment TextureFile C:\\scans\\red.png\n"}) {
        CAPTURE(comment);
        const Loaded l = load(kStart + comment + kVertices + kVertexUv + "element face 1\n" + kList + "end_header\n" +
                              kSquareUv + "4 0 1 2 3\n");
        REQUIRE(l.scene.instances.size() == 1);
        CHECK(l.texel(0) == std::array<int, 3>{255, 0, 0});
        CHECK(l.scene.materials[0].base_color == grey(1));
        CHECK(l.scene.materials[0].base_color_texture.is_srgb);
        CHECK(l.mesh(0).uv[0][2] == Vec2{1, 0.25f}); // v runs down
        CHECK(l.messages.all().size() == (comment.find("C:") == comment.npos ? 0 : 1));
    }
}

TEST_CASE("ply: the name of a texture may be quoted or a file: URI") {
    for (const std::string name : {"\"blue one.png\"", "file:///C:/scans/blue%20one.png"}) {
        CAPTURE(name);
        const Loaded l = load(kStart + "comment TextureFile " + name + "\n" + kVertices + kVertexUv +
                              "element face 1\n" + kList + "end_header\n" + kSquareUv + "4 0 1 2 3\n");
        CHECK(l.texel(0) == std::array<int, 3>{0, 0, 255});
    }
}

TEST_CASE("ply: texture coordinates of faces split only the vertices that have several") {
    // The vertices 0 and 2 have the same coordinates in both triangles; 1 and 3 belong to one triangle each.
    const Loaded joined = load(kStart + kRed + kVertices + "element face 2\n" + kList + kFaceUv + "end_header\n" +
                               kSquare + "3 0 1 2 6 0 0 1 0 1 1\n3 0 2 3 6 0 0 1 1 0 1\n");
    CHECK(joined.mesh(0).positions.size() == 4);
    const Loaded split = load(kStart + kRed + kVertices + "element face 2\n" + kFaceUv + kList + "end_header\n" +
                              kSquare + "6 0 0 1 0 1 1 3 0 1 2\n6 0.5 0 1 1 0 1 3 0 2 3\n");
    const Mesh& mesh = split.mesh(0);
    REQUIRE(mesh.positions.size() == 5);
    REQUIRE(mesh.indices.size() == 6);
    const auto corner = [&](std::size_t i) {
        return std::pair(mesh.positions[mesh.indices[i]], mesh.uv[0][mesh.indices[i]]);
    };
    CHECK(corner(0) == std::pair(Vec3{0, 0, 0}, Vec2{0, 1}));
    CHECK(corner(2) == std::pair(Vec3{1, 1, 0}, Vec2{1, 0}));
    CHECK(corner(3) == std::pair(Vec3{0, 0, 0}, Vec2{0.5f, 1}));
    CHECK(corner(4) == std::pair(Vec3{1, 1, 0}, Vec2{1, 0}));
    CHECK(mesh.indices[2] == mesh.indices[4]);
    CHECK(split.messages.all().empty());
    const Loaded quad = load(kStart + kRed + kVertices + "element face 1\n" + kList + kFaceUv + "end_header\n" +
                             kSquare + "4 0 1 2 3 8 0 0 0.5 0 0.5 1 0 1\n");
    CHECK(quad.mesh(0).triangle_count() == 2);
    CHECK(quad.mesh(0).uv[0][1] == Vec2{0.5f, 1});
}

TEST_CASE("ply: texnumber selects one of several textures for a face, and -1 none") {
    const Loaded l =
        load(kStart + kRed + kBlue + kVertices + "property uchar red\nproperty uchar green\nproperty uchar blue\n" +
             "element face 4\n" + kList + kFaceUv + "property int texnumber\nend_header\n" +
             "0 0 0 9 9 9\n1 0 0 9 9 9\n1 1 0 9 9 9\n0 1 0 9 9 9\n" + "3 0 1 2 6 0 0 1 0 1 1 1\n" + "3 0 2 3 0 -1\n" +
             "3 0 1 3 6 0 0 1 0 1 1 0\n" + "3 1 2 3 6 0 0 1 0 1 1 1\n");
    REQUIRE(l.scene.instances.size() == 3);
    CHECK(l.texel(0) == std::array<int, 3>{255, 0, 0});
    CHECK(l.texel(1) == std::array<int, 3>{0, 0, 255});
    CHECK(l.texel(2) == std::array<int, 3>{0, 0, 0});
    CHECK(l.mesh(0).triangle_count() == 1);
    CHECK(l.mesh(1).triangle_count() == 2);
    CHECK(l.mesh(2).triangle_count() == 1);
    CHECK(l.mesh(0).colors.empty()); // the texture is used
    CHECK(l.mesh(2).colors.size() == 3);
    CHECK(l.mesh(2).positions.size() == 3);
    CHECK(l.reports("vertex colours are left out"));
}

TEST_CASE("ply: unusable textures are reported") {
    const std::string face = "element face 1\n" + kList;
    const Loaded without_uv = load(kStart + kRed + kVertices + face + "end_header\n" + kSquare + "4 0 1 2 3\n");
    CHECK(without_uv.reports("a.ply:3: 1 texture left out"));
    CHECK(without_uv.scene.materials[0].base_color == grey(0.5f));
    const Loaded missing = load(kStart + "comment TextureFile gone.png\n" + kVertices + kVertexUv + face +
                                "end_header\n" + kSquareUv + "4 0 1 2 3\n");
    CHECK(missing.reports("there is no texture gone.png"));
    CHECK(missing.scene.materials[0].base_color == grey(0.5f));
    const Loaded wild = load(kStart + kRed + kVertices + kVertexUv + face + "property uchar texnumber\nend_header\n" +
                             kSquareUv + "4 0 1 2 3 7\n");
    CHECK(wild.reports("1 face with a texture that the header does not list"));
    CHECK(wild.texel(0) == std::array<int, 3>{0, 0, 0});
    const Loaded plain = load(kStart + kVertices + kVertexUv + face + "end_header\n" + kSquareUv + "4 0 1 2 3\n");
    CHECK(plain.messages.all().empty());
    const Loaded grey_only = load(kStart + "comment TextureFile gone.png\n" + kVertices + kVertexUv + face +
                                      "end_header\n" + kSquareUv + "4 0 1 2 3\n",
                                  true);
    CHECK(grey_only.messages.all().empty());
}

TEST_CASE("ply: excess numbers on a line are left out with one warning") {
    const std::string head = kStart + kVertices + "element face 2\n" + kList + "end_header\n";
    const Loaded l = load(head + "0 0 0 255 128\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 255 0 0\n3 0 2 3 0 255 0\n");
    CHECK(l.mesh(0).indices == std::vector<uint32_t>{0, 1, 2, 0, 2, 3});
    CHECK(l.mesh(0).positions[1] == Vec3{1, 0, 0});
    REQUIRE(l.messages.all().size() == 1);
    CHECK(l.reports("a.ply:10: 3 lines with more numbers"));
    // Elements that share lines have none of their own.
    const Loaded packed = load(head + "0 0 0 1 0 0 1 1 0\n0 1 0 3 0 1 2 3 0 2 3\n");
    CHECK(packed.mesh(0).indices == std::vector<uint32_t>{0, 1, 2, 0, 2, 3});
    CHECK(packed.messages.all().empty());
    const Loaded broken = load(head + "0 0\n0\n1 0 0\n1 1 0\n0 1 0\n3 0\n1 2\n3 0 2 3"); // elements over several lines
    CHECK(broken.mesh(0).indices == std::vector<uint32_t>{0, 1, 2, 0, 2, 3});
    CHECK(broken.messages.all().empty());
}

TEST_CASE("ply: the line of Blender 2.4 and old Assimp without the word comment is read as a comment") {
    const std::string rest = kVertices + "element face 1\n" + kList + "end_header\n" + kSquare + "4 0 1 2 3\n";
    const Loaded l = load(kStart + "Created by Blender3D 241 - www.blender.org, source file: bust.blend\n" + rest);
    CHECK(l.mesh(0).triangle_count() == 2);
    CHECK(l.reports("a.ply:3: an unknown header line"));
    const std::string binary = "ply\nformat binary_little_endian 1.0\n" + kVertices + "Created by nobody\n";
    CHECK_THROWS_AS(load(binary + "element face 1\n" + kList + "end_header\n" + std::string(65, '\0')),
                    Error); // may look like a property
}

} // namespace read_ply_textures_test
