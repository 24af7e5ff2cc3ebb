#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>

#include "formats/ply/read_ply.h"
#include "image/srgb.h"
#include "scene/validate/validate.h"
#include "tests/support/options.h"
#include "tests/support/thrown_error.h"
#include "tests/support/write_text.h"

namespace fs = std::filesystem;
using namespace pertev;

namespace {

Scene load(const std::string& bytes, Messages& messages) {
    const fs::path path = test::write_text(test::scratch_folder() / "a.ply", bytes);
    return read_ply(path, FileAccess(path, {}), {}, messages);
}

Scene load(const std::string& bytes) {
    Messages messages;
    return load(bytes, messages);
}

/// The body of a binary file, in either byte order.
struct Bytes {
    bool big_endian;
    std::string text;

    template <class T>
    Bytes& add(T value) {
        char bytes[sizeof(T)];
        std::memcpy(bytes, &value, sizeof(T));
        if (big_endian) std::reverse(bytes, bytes + sizeof(T));
        text.append(bytes, sizeof(T));
        return *this;
    }
};

/// An unusual file: an unknown element first, faces before vertices, unexpected lists, and mixed types.
const std::string kOddElements =
    "comment made by a test\nobj_info nothing\n"
    "element extra 2\nproperty list ushort double junk\nproperty char c\n"
    "element face 2\nproperty uchar flags\nproperty list uchar ushort vertex_index\n"
    "property list uint float texcoord\n"
    "element empty 4000000000\n"
    "element vertex 4\nproperty double z\nproperty list uchar int links\nproperty short y\n"
    "property float x\nproperty uchar blue\nproperty uchar red\nproperty uchar green\n"
    "property float nz\nproperty float nx\nproperty float ny\nproperty float t\n"
    "property float s\n"
    "end_header\n";

void check_odd(const Scene& scene) {
    REQUIRE(scene.meshes.size() == 1);
    const Mesh& mesh = scene.meshes[0];
    CHECK(mesh.indices == std::vector<uint32_t>{0, 1, 2, 0, 2, 3, 3, 2, 1});
    CHECK(mesh.positions == std::vector<Vec3>{{0, 0, -1.5f}, {2, 0, -1.5f}, {2, 3, -1.5f}, {0, 3, -1.5f}});
    CHECK(mesh.normals[3] == Vec3{0, 0, 1});
    CHECK(mesh.uv[0][1] == Vec2{2, 0.75f});
    CHECK(mesh.colors[0] == Vec4{srgb_decode(255 / 255.0f), srgb_decode(128 / 255.0f), 0, 1});
    CHECK(scene.materials[0].base_color == grey(1));
}

std::string odd_binary(bool big_endian) {
    Bytes b{big_endian, ""};
    b.add<uint16_t>(2).add(1.0).add(2.0).add<int8_t>(7);
    b.add<uint16_t>(0).add<int8_t>(8);
    b.add<uint8_t>(1).add<uint8_t>(4).add<uint16_t>(0).add<uint16_t>(1).add<uint16_t>(2).add<uint16_t>(3);
    b.add<uint32_t>(1).add(0.5f);
    b.add<uint8_t>(1).add<uint8_t>(3).add<uint16_t>(3).add<uint16_t>(2).add<uint16_t>(1).add<uint32_t>(0);
    for (int i = 0; i < 4; ++i) {
        b.add(-1.5).add<uint8_t>(1).add<int32_t>(-1).add<int16_t>(i < 2 ? 0 : 3).add(i == 1 || i == 2 ? 2.0f : 0.0f);
        b.add<uint8_t>(0).add<uint8_t>(255).add<uint8_t>(128);
        b.add(1.0f).add(0.0f).add(0.0f).add(0.25f).add(2.0f);
    }
    return std::string("ply\nformat binary_") + (big_endian ? "big" : "little") + "_endian 1.0\n" + kOddElements +
           b.text;
}

std::string ascii(const std::string& elements, const std::string& body) {
    return "ply\nformat ascii 1.0\n" + elements + "end_header\n" + body;
}

const std::string kVertices = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
const std::string kFaces = "property list uchar int vertex_indices\n";
const std::string kSquare = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

} // namespace

TEST_CASE("ply: ascii and binary of both byte orders give the same mesh for any order of properties") {
    std::string body = "2 1 2 7\n0 8\n1 4 0 1 2 3 1 0.5\n1 3 3 2 1 0\n";
    for (int i = 0; i < 4; ++i) {
        body += std::string("-1.5 1 -1 ") + (i < 2 ? "0 " : "3 ") + (i == 1 || i == 2 ? "2" : "0") +
                " 0 255 128 1 0 0 0.25 2\n";
    }
    check_odd(load("ply\nformat ascii 1.0\n" + kOddElements + body));
    check_odd(load("ply\nformat ascii 1.0\n" + kOddElements + body.substr(0, body.size() - 1)));
    check_odd(load(odd_binary(false)));
    check_odd(load(odd_binary(true)));
}

TEST_CASE("ply: a header with CRLF line ends and float colours, which are sRGB as bytes are") {
    std::string text = ascii("element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                             "property float red\nproperty float green\nproperty float blue\nproperty float alpha\n"
                             "element face 1\n" +
                                 kFaces,
                             "0 0 0 1 0.5 0 0.25\n1 0 0 1 1 1 1\n0 1 0 1 1 1 1\n3 0 1 2\n");
    for (std::size_t at = text.find('\n'); at != text.npos; at = text.find('\n', at + 2)) text.replace(at, 1, "\r\n");
    CHECK(load(text).meshes[0].colors[0] == Vec4{1, srgb_decode(0.5f), 0, 0.25f});
}

TEST_CASE("ply: every other triangle of a strip is reversed, and -1 restarts the strip") {
    const Scene scene = load(ascii(kVertices + "element tristrips 1\n" + kFaces, kSquare + "8 0 1 3 2 -1 2 3 1\n"));
    CHECK(scene.meshes[0].indices == std::vector<uint32_t>{0, 1, 3, 3, 1, 2, 2, 3, 1});
}

TEST_CASE("ply: a file truncated anywhere is an error, never a crash") {
    const std::string whole = odd_binary(false);
    for (std::size_t size = 0; size < whole.size(); ++size) {
        CAPTURE(size);
        const auto error = test::thrown_error([&] { load(whole.substr(0, size)); });
        REQUIRE(error);
        CHECK(error->code() == ErrorCode::BadInput);
    }
}

TEST_CASE("ply: errors have a location") {
    const auto error_of = [](const std::string& text) { return test::thrown_error([&] { load(text); }); };
    CHECK(test::says(error_of(""), "a.ply:1:"));
    CHECK(test::says(error_of("ply\nformat words 1.0\n"), "a.ply:2:"));
    CHECK(test::says(error_of("ply\nformat ascii 1.0\nelement vertex -1\n"), "a.ply:3:"));
    CHECK(test::says(error_of("ply\nformat ascii 1.0\nproperty int x\n"), "a.ply:3:"));
    CHECK(test::says(error_of("ply\nformat binary_big_endian 1.0\nelement vertex 1\nproperty quad x\n"),
                     "a.ply:4: \"quad\""));
    CHECK(test::says(error_of(ascii(kVertices, kSquare)), "no faces"));
    CHECK(test::says(error_of(ascii("element vertex 9\nelement face 1\n" + kFaces, "3 0 1 2\n")), "x, y and z"));
}

TEST_CASE(
    "ply: a face with a missing vertex and the unread rest of a truncated file are left out with their location") {
    const auto left_out = [](int faces, const std::string& lines, std::size_t triangles) {
        Messages messages;
        const std::string header = kVertices + "element face " + std::to_string(faces) + "\n" + kFaces;
        const Scene scene = load(ascii(header, kSquare + lines), messages);
        CHECK(scene.meshes.at(0).triangle_count() == triangles);
        REQUIRE(messages.left_out().size() == 1);
        return messages.left_out()[0];
    };
    const auto says = [](const std::string& text, const std::string& part) {
        return text.find(part) != std::string::npos;
    };
    CHECK(says(left_out(2, "3 0 1 2\n3 0 1 4\n", 1), "face 1: vertex index 4"));
    CHECK(says(left_out(2, "3 0 1 -1\n4 0 1 2 3\n", 2), "index -1"));
    CHECK(says(left_out(3, "3 0 1 2\n3 0 1\n", 1), "a.ply:"));
    CHECK(says(left_out(3, "3 0 1 2\n", 1), "a.ply:"));
    CHECK(says(left_out(1, "3 0 1 9\n", 0), "index 9"));
}

TEST_CASE("ply: only elements with an unreadable value are left out of a text file") {
    const auto load_faces = [](const std::string& vertices, const std::string& faces, Messages& messages) {
        const std::string count = std::to_string(std::count(faces.begin(), faces.end(), '\n'));
        return load(ascii(kVertices + "element face " + count + "\n" + kFaces, vertices + faces), messages)
            .meshes.at(0);
    };
    const std::string faces = "3 0 1 2\n3 0 2 3\n";
    for (const auto& [bad, place] : {std::pair("3 0 x 2\n", "a.ply:14: face 0"),
                                     {"-3 0 1 2\n", "a.ply:14: face 0"},
                                     {"x 0 1 2\n", "a.ply:14: face 0"},
                                     {"900 0 1 2\n", "a.ply:14: face 0"}}) {
        CAPTURE(bad);
        Messages messages;
        CHECK(load_faces(kSquare, bad + faces, messages).indices == std::vector<uint32_t>{0, 1, 2, 0, 2, 3});
        REQUIRE(messages.left_out().size() == 1);
        CHECK(messages.left_out()[0].find(place) != std::string::npos);
        Messages last;
        CHECK(load_faces(kSquare, faces + bad, last).indices == std::vector<uint32_t>{0, 1, 2, 0, 2, 3});
        CHECK(last.left_out().size() == 1);
    }
    Messages messages;
    Scene scene =
        load(ascii(kVertices + "element face 2\n" + kFaces, "0 0 0\n1 1,5 0\n1 1 0\n0 1 0\n" + faces), messages);
    validate(scene, "a.ply", messages);
    CHECK(scene.meshes.at(0).indices == std::vector<uint32_t>{0, 2, 3});
    CHECK(messages.left_out().size() == 2); // one message for the value, one for its triangle
    CHECK(messages.left_out()[0].find("a.ply:11: vertex 1") != std::string::npos);
}

TEST_CASE("ply: whole numbers with a fraction, and types and lines of other writers, are read") {
    const std::string start = "ply\nformat ascii 1.0\n", rest = "element face 1\n" + kFaces + "end_header\n";
    const std::string coloured = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    const Scene colours = load(start + kVertices + coloured + rest +
                               "0 0 0 255.0 0.0 0\n1 0 0 255.0 0 0\n1 1 0 255 0 0\n0 1 0 255.0 0 0\n4 0 1 2 3\n");
    CHECK(colours.meshes[0].colors[0] == Vec4{1, 0, 0, 1});
    for (const std::string type : {"int64", "uint64", "long_double"}) {
        CAPTURE(type);
        const Scene scene = load(start + kVertices + "property " + type + " id\n" + rest +
                                 "0 0 0 7\n1 0 0 18446744073709551615\n1 1 0 7\n0 1 0 7\n4 0 1 2 3\n");
        CHECK(scene.meshes[0].triangle_count() == 2);
    }
    const std::string numbered =
        "element vertex 3\nproperty int64 id\nproperty float x\nproperty float y\nproperty float z\n";
    Bytes body{false, {}};
    for (const float x : {0.0f, 1.0f, 2.0f}) body.add(int64_t(7)).add(x).add(x * x).add(0.5f);
    body.add(uint8_t(3)).add(int32_t(0)).add(int32_t(1)).add(int32_t(2));
    const Scene binary = load("ply\nformat binary_little_endian 1.0\n" + numbered + rest + body.text);
    CHECK(binary.meshes[0].positions.at(2) == Vec3{2, 4, 0.5f});
    for (const std::string& header : {"ply\nformat ascii 1.1\n" + kVertices, start + kVertices + "author me\n",
                                      "ply\nCreated by Blender\nformat ascii 1.0\n" + kVertices}) {
        CAPTURE(header);
        Messages messages;
        CHECK(load(header + rest + kSquare + "4 0 1 2 3\n", messages).meshes[0].triangle_count() == 2);
        CHECK(messages.all().size() == 1);
        CHECK(messages.left_out().empty());
    }
}

TEST_CASE("ply: harmless faults in a header are accepted") {
    const std::string rest = kVertices + "element face 1\n" + kFaces + "end_header\n" + kSquare + "3 0 1 2\n";
    for (const std::string start : {"\xef\xbb\xbfply\nformat ascii 1.0\n", "ply \nformat ascii 1.0 \n",
                                    "ply\ncomment by hand\n\nobj_info x\nformat ascii 1.0\n"}) {
        CAPTURE(start);
        CHECK(load(start + rest).meshes[0].triangle_count() == 1);
    }
    CHECK_THROWS_AS(load("ply\nelement vertex 3\nformat ascii 1.0\n" + rest), Error);
}

TEST_CASE("ply: colours and texture coordinates of faces are left out with warnings") {
    const std::string colours = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    Messages messages;
    load(ascii(kVertices + "element face 1\n" + kFaces + colours + "property list uchar float texcoord\n",
               kSquare + "3 0 1 2 255 0 0 6 0 0 1 0 1 1\n"),
         messages);
    REQUIRE(messages.all().size() == 2);
    CHECK(messages.all()[0].text.find("colours") != std::string::npos);
    CHECK(messages.all()[1].text.find("texture coordinates") != std::string::npos);
}

TEST_CASE("ply: counts are trusted only as far as the file has bytes for them") {
    for (const char* count : {"1000000000", "4294967295", "4294967296", "18446744073709551615"}) {
        for (const char* format : {"ascii", "binary_little_endian"}) {
            CAPTURE(count);
            CAPTURE(format);
            const std::string start = std::string("ply\nformat ") + format + " 1.0\n";
            const std::string face = "element face 1\n" + kFaces + "end_header\n" + std::string(64, '1');
            CHECK_THROWS_AS(load(start + "element vertex " + count + "\nproperty float x\n" + face), Error);
            CHECK_THROWS_AS(load(start + kVertices + "element face " + count + "\n" + kFaces + "end_header\n" +
                                 std::string(64, '1')),
                            Error);
        }
    }
}
