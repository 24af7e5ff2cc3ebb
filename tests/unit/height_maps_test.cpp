// Parsing of `displacement` and reading of its heights.

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <vector>

#include "image/write_exr.h"
#include "image/write_png.h"
#include "session/height_maps.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/options.h"
#include "tests/support/thrown_error.h"
#include "tests/support/write_text.h"

using namespace pertev;

namespace {

/// Two materials on sheets with texture coordinates, one on a sheet without.
Scene three_sheets() {
    Scene scene;
    for (const char* name : {"wall left", "wall right", "floor"}) {
        Mesh mesh = test::sheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
        if (std::string(name) != "floor") mesh.uv[0].assign(4, {0, 0});
        test::add(scene, std::move(mesh), {.name = name});
    }
    return scene;
}

} // namespace

TEST_CASE("a height map has a material, a file, a scale and a neutral height") {
    const HeightMapText two = parse_height_map("wall*=a,b=c.png,-0.5");
    CHECK(two.material == "wall*");
    CHECK(two.file == "a,b=c.png");
    CHECK(two.scale == -0.5f);
    CHECK(two.middle == 0);
    const HeightMapText three = parse_height_map("a=b.exr,2,0.25");
    CHECK(three.file == "b.exr");
    CHECK(three.scale == 2);
    CHECK(three.middle == 0.25f);
    for (const char* text :
         {"", "a", "a=", "=b,1", "a=b", "a=,1", "a=b,x", "a=b,1e400", "a=b,nan", "a=b,1,", "a=b,3e6", "a=b,1,3e6"}) {
        CAPTURE(text);
        const auto error = test::thrown_error([&] { parse_height_map(text); });
        CHECK(test::is_about(error, ErrorCode::BadInput, "displacement", text));
    }
}

TEST_CASE("heights are the first channel as stored, for every material of the name, and the last map counts") {
    const std::filesystem::path folder = test::scratch_folder();
    const std::string png = (folder / "h.png").string(), exr = (folder / "h.exr").string();
    write_png(png, Rgba8Image{2, 1, {0, 9, 9, 255, 51, 7, 7, 255}});
    write_exr(exr, Image{1, 2, 3, {-3, 1, 1, 7.5f, 1, 1}});
    const Scene scene = three_sheets();
    CHECK(read_height_maps({}, scene) == nullptr);
    const HeightMapText maps[] = {parse_height_map("wall*=" + png + ",2"),
                                  parse_height_map("wall right=" + exr + ",3,0.5")};
    const auto read = read_height_maps(maps, scene);
    REQUIRE(read != nullptr);
    REQUIRE(read->size() == 2);
    CHECK(read->at(0).material == 0);
    CHECK(read->at(0).heights.width == 2);
    CHECK(read->at(0).heights.pixels == std::vector<float>{0, 0.2f});
    CHECK(read->at(0).scale == 2);
    CHECK(read->at(1).material == 1);
    CHECK(read->at(1).heights.height == 2);
    CHECK(read->at(1).heights.pixels == std::vector<float>{-3, 7.5f});
    CHECK(read->at(1).middle == 0.5f);
}

TEST_CASE("a height map without a material, texture coordinates or picture is refused") {
    const std::filesystem::path folder = test::scratch_folder();
    const std::string file = (folder / "no.png").string(), png = (folder / "h.png").string();
    test::write_text(file, "no picture");
    write_png(png, Rgba8Image{1, 1, {0, 0, 0, 255}});
    const Scene scene = three_sheets();
    const auto fault = [&](const std::string& text) {
        const HeightMapText map[] = {parse_height_map(text)};
        return test::thrown_error([&] { read_height_maps(map, scene); });
    };
    for (const std::string& text : {"door=" + file + ",1", "floor=" + png + ",1"}) {
        CHECK(test::is_about(fault(text), ErrorCode::BadInput, "displacement", text));
    }
    CHECK(test::says(fault("door=" + file + ",1"), "'floor', 'wall left'"));
    CHECK(test::is_at(fault("wall left=" + file + ",1"), ErrorCode::BadInput, {file}));
    for (const char* material : {"wall left", "floor"}) {
        CHECK(test::is_at(fault(fmt::format("{}={}x,1", material, file)), ErrorCode::BadInput, {file + "x"}));
    }
}
