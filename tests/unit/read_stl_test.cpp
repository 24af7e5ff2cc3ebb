#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "formats/read_scene.h"
#include "tests/support/options.h"
#include "tests/support/thrown_error.h"
#include "tests/support/write_text.h"

namespace fs = std::filesystem;
using namespace pertev;

namespace {

Scene load_stl(const std::string& bytes, Messages& messages, const ReadOptions& options = {}) {
    return read_scene(test::write_text(test::scratch_folder() / "part.stl", bytes), options, messages);
}

std::string facet(const std::string& corners) {
    std::string text = "facet normal 0 0 1\n outer loop\n";
    for (std::size_t at = 0; at < corners.size();) {
        const std::size_t end = std::min(corners.find(';', at), corners.size());
        text += "  vertex " + corners.substr(at, end - at) + "\n";
        at = end + 1;
    }
    return text + " endloop\nendfacet\n";
}

const std::string kFacet = facet("0 0 0;1 0 0;0 1 0");

/// A binary file of triangles (0, 0, i), (1, 0, i), (0, 1, i).
std::string binary_stl(uint32_t stated, uint32_t triangles, const std::string& header = "made by a test",
                       uint16_t attribute = 0) {
    std::string bytes = header + std::string(80 - header.size(), '\0');
    const auto add = [&](const auto& value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof(value)); };
    add(stated);
    for (uint32_t i = 0; i < triangles; ++i) {
        const auto z = static_cast<float>(i);
        const float numbers[12] = {0, 0, 1, 0, 0, z, 1, 0, z, 0, 1, z};
        add(numbers);
        add(attribute);
    }
    return bytes;
}

} // namespace

TEST_CASE("stl: each solid of a text is an instance with its name, and equal corners are one vertex") {
    Messages messages;
    const Scene scene = load_stl("solid big part\n" + kFacet + facet("1 0 0;1 1 0;-0 1 0") + "endsolid big part\n" +
                                     "solid empty\nendsolid\nsolid\r\n" + facet("5 0 0;6 0 0;5 1 0") + "endsolid\n",
                                 messages);
    REQUIRE(scene.instances.size() == 2);
    CHECK(scene.instances[0].name == "big part");
    CHECK(scene.instances[1].name == "part");
    CHECK(scene.materials.size() == 1);
    CHECK(scene.materials[0].name == "part");
    CHECK(scene.materials[0].base_color == grey(0.5f));
    CHECK(scene.meshes[0].indices == std::vector<uint32_t>{0, 1, 2, 1, 3, 2});
    CHECK(scene.meshes[0].positions.size() == 4);
    CHECK(scene.meshes[1].triangle_count() == 1);
    CHECK(scene.meshes[1].positions[0] == Vec3{5, 0, 0});
    CHECK(scene.meshes[0].normals.empty());
    CHECK(messages.all().empty());
}

TEST_CASE("stl: keywords have any case, blanks any form, and facets any number of corners") {
    Messages messages;
    const Scene scene = load_stl("\xef\xbb\xbf SOLID x\r\tFacet Normal 0 0 1 Outer Loop VERTEX +0 0 0 vertex 1e0 0 0\r"
                                 "vertex 1 1. 0 vertex 0 1 0 endloop EndFacet\rendsolid x with facet in its name\r",
                                 messages);
    CHECK(scene.meshes.at(0).indices == std::vector<uint32_t>{0, 1, 2, 0, 2, 3});
    CHECK(scene.instances[0].name == "x");
    CHECK(messages.all().empty());
}

TEST_CASE("stl: what is unreadable in a text is left out with its line, and the rest is read") {
    struct Fault {
        std::string text;
        std::size_t line, triangles;
    };
    for (const Fault& fault : {Fault{"solid x\n" + kFacet + facet("0 0 0;1 0 0") + kFacet + "endsolid\n", 9, 2},
                               Fault{"solid x\n" + facet("0 0 0;1 0 0;0 1,5 0") + kFacet + "endsolid\n", 2, 1},
                               Fault{"solid x\n" + kFacet + "color 1 0 0\n" + kFacet + "endsolid\n", 9, 2},
                               Fault{"solid x\n" + kFacet + kFacet.substr(0, 50), 9, 1}}) {
        CAPTURE(fault.text);
        Messages messages;
        const Scene scene = load_stl(fault.text, messages);
        CHECK(scene.meshes.at(0).triangle_count() == fault.triangles);
        REQUIRE_FALSE(messages.left_out().empty());
        CHECK(messages.left_out()[0].find("part.stl:" + std::to_string(fault.line) + ": ") != std::string::npos);
    }
}

TEST_CASE("stl: binary files are known by what no text has, also if they begin with solid") {
    for (const std::string header : {"made by a test", "solid of a program that writes binary"}) {
        Messages messages;
        const Scene scene = load_stl(binary_stl(3, 3, header), messages);
        REQUIRE(scene.meshes.size() == 1);
        CHECK(scene.meshes[0].triangle_count() == 3);
        CHECK(scene.meshes[0].positions[4] == Vec3{1, 0, 1});
        CHECK(scene.instances[0].name == "part");
        CHECK(messages.all().empty());

        const Scene torn = load_stl(binary_stl(3, 3, header).substr(0, 84 + 2 * 50), messages);
        CHECK(torn.meshes.at(0).triangle_count() == 2);
        CHECK(messages.left_out().size() == 1);
    }
}

TEST_CASE("stl: a binary file with a wrong count or a torn end has the triangles that it holds") {
    const std::string whole = binary_stl(3, 3);
    struct Torn {
        std::string bytes;
        std::size_t triangles;
        bool leaves_out;
    };
    for (const Torn& torn :
         {Torn{whole.substr(0, 84 + 120), 2, true}, Torn{binary_stl(0xffffffffu, 3), 3, true},
          Torn{whole + "bytes", 3, true}, Torn{binary_stl(1, 3), 1, true}, Torn{binary_stl(0, 3), 3, false}}) {
        Messages messages;
        const Scene scene = load_stl(torn.bytes, messages);
        CHECK(scene.meshes.at(0).triangle_count() == torn.triangles);
        CHECK(messages.all().size() == 1);
        CHECK(messages.left_out().size() == (torn.leaves_out ? 1 : 0));
    }
}

TEST_CASE("stl: colours of triangles are left out with a warning, other attributes are ignored") {
    const auto left_out = [](const std::string& bytes) {
        Messages messages;
        load_stl(bytes, messages);
        return messages.left_out().size();
    };
    CHECK(left_out(binary_stl(2, 2, "x", 0x8001)) == 1);
    CHECK(left_out(binary_stl(2, 2, "COLOR=abcd", 0)) == 1);
    CHECK(left_out(binary_stl(2, 2, "x", 0x0001)) == 0);
}

TEST_CASE("stl: triangles without a finite position are left out") {
    std::string bytes = binary_stl(2, 2);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    std::memcpy(bytes.data() + 84 + 12, &nan, 4);
    Messages messages;
    const Scene scene = load_stl(bytes, messages);
    CHECK(scene.meshes.at(0).triangle_count() == 1);
    CHECK(messages.left_out().size() == 1);
}

TEST_CASE("stl: files that hold no triangle, or are no STL, are errors that name the file") {
    for (const std::string& bytes :
         {std::string(), std::string("<html>not here</html>"), std::string(4096, '\0'),
          std::string("solid x\nendsolid x\n"), binary_stl(0, 0), std::string(83, '\1'), std::string(200, 'x')}) {
        CAPTURE(bytes);
        Messages messages;
        const auto error = test::thrown_error([&] { load_stl(bytes, messages); });
        REQUIRE(error);
        CHECK(error->code() == ErrorCode::BadInput);
        CHECK(test::says(error, "part.stl"));
    }
}

TEST_CASE("stl: unit and up axis convert the file, and text far from 0 keeps its precision") {
    Messages messages;
    const Scene scene = load_stl("solid\n" + facet("0 0 0;1000 0 0;0 0 2000"), messages, {.space = {UpAxis::Z, 0.001}});
    const auto placed = [&](std::size_t i) {
        return transform_point(scene.instances.at(0).world_from_local, scene.meshes.at(0).positions.at(i));
    };
    CHECK(length(placed(1) - Vec3{1, 0, 0}) < 1e-6f);
    CHECK(length(placed(2) - Vec3{0, 2, 0}) < 1e-6f);

    const Scene far = load_stl("solid\n" + facet("5000000.001 0 0;5000000.002 0 0;5000000.001 0.001 0"), messages);
    const std::vector<Vec3>& p = far.meshes.at(0).positions;
    CHECK(p.at(1).x - p[0].x == doctest::Approx(0.001).epsilon(1e-4));
    CHECK(far.origin_in_file.x == doctest::Approx(5000000));
}
