#include <doctest/doctest.h>

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "formats/mesh/corner_numbers.h"
#include "formats/obj/parse_obj.h"
#include "tests/support/random.h"

using namespace pertev;

namespace {

struct Parsed {
    ObjData data;
    std::string messages; // the warnings, or the error
};

Parsed parse_in_pieces(const std::string& text, std::size_t piece_bytes) {
    Parsed parsed;
    Messages messages;
    std::vector<uint32_t> found; // lines
    const auto found_materials = [&](const ObjMaterialFiles& files) { found.push_back(files.line); };
    try {
        parsed.data = parse_obj(std::as_bytes(std::span(text)), "a.obj", messages, found_materials, piece_bytes);
        CHECK(found.size() <= 1);
        if (!found.empty()) CHECK(found.front() == parsed.data.material_files.at(0).line);
    } catch (const Error& error) {
        CHECK(error.code() == ErrorCode::BadInput);
        parsed.messages = error.what();
    }
    for (const Message& message : messages.all()) parsed.messages += message.text + "\n";
    return parsed;
}

bool same(const ObjData& a, const ObjData& b) {
    const auto same_bytes = [](const auto& x, const auto& y) { // NaN equals NaN here
        return std::ranges::equal(std::as_bytes(std::span(x)), std::as_bytes(std::span(y)));
    };
    const auto same_corners = [](const ObjCorner& x, const ObjCorner& y) {
        return x.position == y.position && x.uv == y.uv && x.normal == y.normal;
    };
    const auto same_group = [&](const ObjGroup& x, const ObjGroup& y) {
        return x.name == y.name && x.material == y.material && x.line == y.line &&
               std::ranges::equal(x.corners, y.corners, same_corners);
    };
    const auto same_files = [](const ObjMaterialFiles& x, const ObjMaterialFiles& y) {
        return x.names == y.names && x.line == y.line;
    };
    return same_bytes(a.positions, b.positions) && same_bytes(a.colors, b.colors) && same_bytes(a.normals, b.normals) &&
           same_bytes(a.uvs, b.uvs) && std::ranges::equal(a.groups, b.groups, same_group) &&
           std::ranges::equal(a.material_files, b.material_files, same_files);
}

} // namespace

TEST_CASE("a text read in pieces by several threads gives the same result and messages") {
    // Here ; ends a line. The text has every construct whose meaning depends on earlier lines, and each kind of fault.
    const std::string corners = "v 0 0 0;v 1 0 0 1 0.5 0;v 0 1 \\;0;v 1 1 0;vt 0 0;vt 1 0;vn 0 0 1;";
    const std::string faces = "f 1 2 3;o box # one;usemtl red one # note;f -4/-2/-1 -3//-1 -2/-1;# C:\\;f 2 3 4;usemtl "
                              "blue;g left side;f 1 2 \\;4 3;";
    const std::string odd = "v 1 x 2 255 20 3;vt;f 1 2;p 1;vp 0;what;o;f 1/9 2/9 3/9;mtllib b.mtl c.mtl;usemtl;f 2 3 "
                            "4;g;usemtl red one;f 1 2 4;";
    const std::string whole = "mtllib a.mtl;" + corners + faces + odd + corners + "f -1 -2 -3;" + odd + faces;
    std::vector<std::string> texts = {"", ";", "f 1 2 3", whole};
    for (const char* fault : {"f 1 2 99;", "f 1 2 -99;", "f 1 b 2;", "f 0 1 2;"}) {
        texts.push_back(corners + faces + fault + whole);
        texts.push_back(whole + fault + faces + "f 1 2 c;");
    }
    for (std::string text : texts) {
        for (const std::string end : {"\n", "\r\n", "\r"}) {
            std::string lines = text;
            for (std::size_t at = lines.find(';'); at != lines.npos; at = lines.find(';', at))
                lines.replace(at, 1, end);
            const Parsed at_once = parse_in_pieces(lines, lines.size() + 1);
            CHECK((text != whole || at_once.data.groups.size() == 6));
            for (const std::size_t piece_bytes : {1, 2, 3, 5, 8, 13, 40, 100, 300}) {
                CAPTURE(text);
                CAPTURE(piece_bytes);
                const Parsed in_pieces = parse_in_pieces(lines, piece_bytes);
                CHECK(in_pieces.messages == at_once.messages);
                CHECK(same(in_pieces.data, at_once.data));
            }
        }
    }
}

TEST_CASE("corners are numbered in the order of first use, also many of one position and those far apart") {
    for (const uint32_t apart : {1u, 1000u}) {
        test::Random random(apart);
        std::vector<VertexKey> corners;
        for (int i = 0; i < 4000; ++i) { // position 5 has more corners than are tried before they are hashed
            const uint32_t position = random.below(2) == 0 ? 5 : random.below(300);
            corners.push_back({apart * position, random.below(40), random.below(2) == 0 ? 0xffffffffu : 7});
        }
        CornerNumbers found(corners);
        KeyNumbers<VertexKey> expected(corners.size());
        uint32_t wrong = 0;
        for (const VertexKey& corner : corners) wrong += found.number_of(corner) != expected.number_of(corner) ? 1 : 0;
        CHECK(wrong == 0);
        CHECK(found.keys() == expected.keys());
    }
    CHECK(CornerNumbers({}).keys().empty());
}
