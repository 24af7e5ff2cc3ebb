#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "formats/obj/bump_normals.h"
#include "formats/obj/read_obj.h"
#include "formats/read_scene.h"
#include "image/write_png.h"
#include "tests/support/options.h"
#include "tests/support/write_text.h"

namespace fs = std::filesystem;
using namespace pertev;

namespace {

struct MtlScene {
    Scene scene;
    Messages messages;

    const Material& material(const std::string& name) const {
        for (const Material& material : scene.materials) {
            if (material.name == name) return material;
        }
        throw std::runtime_error("no material " + name);
    }
    const TextureImage& normals(const std::string& name) const {
        return scene.images.at(static_cast<std::size_t>(material(name).normal_texture.image));
    }
};

/// Reads materials, each on a triangle of its own.
MtlScene mtl_scene(const fs::path& folder, const std::string& mtl) {
    std::string obj = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n";
    for (std::size_t at = mtl.find("newmtl "); at != mtl.npos; at = mtl.find("newmtl ", at + 1)) {
        obj += "use" + mtl.substr(at + 3, mtl.find('\n', at) - at - 3) + "\nf 1/1 2/2 3/3\n";
    }
    test::write_text(folder / "a.mtl", mtl);
    MtlScene read;
    read.scene = read_scene(test::write_text(folder / "a.obj", obj), {}, read.messages);
    return read;
}

void write_heights(const fs::path& path, uint32_t width, uint32_t height, uint8_t (*value)(uint32_t x, uint32_t y)) {
    Rgba8Image image{.width = width, .height = height, .pixels = {}};
    for (uint32_t i = 0; i < width * height; ++i) {
        const uint8_t h = value(i % width, i / width);
        image.pixels.insert(image.pixels.end(), {h, h, h, 255});
    }
    write_png(path, image, false);
}

/// Slope of the surface that a texel's normal stands on, along x to the right and y up.
Vec2 slope_of(const TextureImage& normals, uint32_t x, uint32_t y) {
    const std::size_t at = 4 * (std::size_t(y) * max(normals.rgba8.width, normals.rgba_float.width) + x);
    const auto component = [&](std::size_t c) {
        return normals.rgba8.pixels.empty() ? 2 * normals.rgba_float.pixels[at + c] - 1
                                            : 2 * static_cast<float>(normals.rgba8.pixels[at + c]) / 255 - 1;
    };
    return {-component(0) / component(2), -component(1) / component(2)};
}

} // namespace

TEST_CASE("mtl: Pc, Pcr and Ps put a coat and a sheen on any base") {
    const MtlScene l = mtl_scene(test::scratch_folder(), "newmtl paint\nKd 0.5 0 0\nPr 0.6\nPm 0.2\nPc 0.75\nPcr 0.1\n"
                                                         "newmtl cloth\nKd 0.2 0.2 0.4\nPs 0.5\n"
                                                         "newmtl plain\nKd 1 0 0\nPs 0\nPc 0\nPcr 0.3\n");
    const Material& paint = l.material("paint");
    CHECK(paint.kind == MaterialKind::MetallicRoughness);
    CHECK(paint.coat_weight == 0.75f);
    CHECK(paint.coat_roughness == 0.1f);
    CHECK(paint.roughness == 0.6f);
    CHECK(paint.fuzz_weight == 0);
    const Material& cloth = l.material("cloth");
    CHECK(cloth.kind == MaterialKind::Diffuse);
    CHECK(cloth.fuzz_weight == 0.5f);
    CHECK(cloth.fuzz_color == grey(1));
    CHECK(cloth.coat_weight == 0);
    CHECK_FALSE(l.material("plain").is_stacked());
    CHECK(l.messages.left_out().empty());
}

TEST_CASE("mtl: an index of 1 bends no light, and one that is missing or 0 is 1.5") {
    const MtlScene l = mtl_scene(test::scratch_folder(), "newmtl none\nKd 0 0 0\nTf 1 1 1\nillum 7\n"
                                                         "newmtl air\nKd 0 0 0\nTf 1 1 1\nNi 1.0\nillum 7\n"
                                                         "newmtl water\nKd 0 0 0\nTf 1 1 1\nNi 1.33\nillum 6\n"
                                                         "newmtl zero\nKd 0 0 0\nTf 1 1 1\nNi 0\nillum 7\n"
                                                         "newmtl bubble\nKd 0 0 0\nTf 1 1 1\nNi 0.75\nillum 7\n"
                                                         "newmtl clear\nd 0.5\nTf 1 1 1\nNi 0.75\nillum 2\n"
                                                         "newmtl matt\nKd 1 0 0\nPr 0.5\nNi 1\n"
                                                         "newmtl plain\nKd 1 0 0\nPr 0.5\n");
    for (const char* glass : {"none", "air", "water", "zero"})
        CHECK(l.material(glass).kind == MaterialKind::Dielectric);
    CHECK(l.material("none").ior == 1.5f);
    CHECK(l.material("air").ior == 1);
    CHECK(l.material("water").ior == 1.33f);
    CHECK(l.material("zero").ior == 1.5f);
    CHECK(l.material("bubble").ior == 0.75f);
    CHECK(l.material("bubble").has_relative_ior);
    CHECK(l.material("clear").kind == MaterialKind::Dielectric);
    CHECK(l.material("clear").ior == 0.75f);
    CHECK(l.material("clear").has_relative_ior);
    CHECK_FALSE(l.material("water").has_relative_ior);
    CHECK(l.material("matt").ior == 1);
    CHECK(l.material("plain").ior == 1.5f);
}

TEST_CASE("mtl: aniso stretches reflections, and anisor turns them by a share of a whole turn") {
    const MtlScene l = mtl_scene(test::scratch_folder(), "newmtl brushed\nKd 0.5 0.5 0.5\nPr 0.4\nPm 1\naniso 0.75\n"
                                                         "anisor 0.125\n"
                                                         "newmtl plain\nPr 0.4\nPm 1\naniso 0\nanisor 0.5\n"
                                                         "newmtl clamped\nPr 0.4\naniso 3\n");
    const Material& brushed = l.material("brushed");
    CHECK(brushed.has_anisotropy());
    CHECK(brushed.specular_roughness_anisotropy == 0.75f);
    CHECK(brushed.anisotropy_rotation == doctest::Approx(0.25 * 3.14159265358979));
    CHECK_FALSE(l.material("plain").is_stacked());
    CHECK(l.material("clamped").specular_roughness_anisotropy == 1);
    CHECK(l.messages.left_out().empty());
    CHECK(l.messages.all().size() == 1); // clamped
}

TEST_CASE("mtl: maps of coat and sheen count with their numbers, or alone without") {
    const fs::path folder = test::scratch_folder();
    write_heights(folder / "t.png", 4, 4, [](uint32_t x, uint32_t) { return static_cast<uint8_t>(60 * x); });
    const MtlScene l = mtl_scene(folder, "newmtl all\nmap_Pc t.png\nmap_Pcr t.png\nmap_Ps t.png\n"
                                         "newmtl some\nPc 0.5\nPcr 0.25\nPs 0.125\nmap_Pc t.png\nmap_Pcr t.png\n"
                                         "newmtl none\nmap_Pcr t.png\nmap_aniso t.png\n");
    const Material &all = l.material("all"), &some = l.material("some");
    for (const TextureRef* ref : {&all.coat_texture, &all.coat_roughness_texture, &all.fuzz_color_texture}) {
        CHECK(ref->has_image());
        CHECK_FALSE(ref->is_srgb);
    }
    CHECK(all.coat_weight == 1);
    CHECK(all.coat_roughness == 1);
    CHECK(all.fuzz_weight == 1);
    CHECK(some.coat_weight == 0.5f);
    CHECK(some.coat_roughness == 0.25f);
    CHECK(some.fuzz_weight == 0.125f);
    CHECK(some.coat_roughness_texture.has_image());
    CHECK_FALSE(some.fuzz_color_texture.has_image());
    CHECK_FALSE(l.material("none").has_coat());
    CHECK(l.messages.left_out().size() == 1); // map_aniso
}

TEST_CASE("mtl: heights become normals that face downhill") {
    const fs::path folder = test::scratch_folder();
    // Height rises by 8 a texel to the right and by 4 a row upwards, away from the edges.
    write_heights(folder / "slope.png", 16, 8,
                  [](uint32_t x, uint32_t y) { return static_cast<uint8_t>(8 * x + 4 * (7 - y)); });
    write_heights(folder / "flat.png", 4, 4, [](uint32_t, uint32_t) { return uint8_t{77}; });
    const MtlScene l = mtl_scene(folder, "newmtl slope\nmap_Bump -bm 3 slope.png\n"
                                         "newmtl shared\nmap_Kd slope.png\nbump -bm 0.5 slope.png\n"
                                         "newmtl flat\nbump -bm 100 flat.png\n"
                                         "newmtl both\nnorm flat.png\nbump slope.png\n");
    const float unit = kBumpHeight * 16 / 255; // slope for a step of one along a texel
    for (const uint32_t x : {1u, 9u, 14u}) {
        const Vec2 slope = slope_of(l.normals("slope"), x, 3);
        CHECK(std::abs(slope.x - 8 * unit) < 0.01f);
        CHECK(std::abs(slope.y - 4 * unit) < 0.01f);
    }
    CHECK(slope_of(l.normals("slope"), 0, 3).x < -0.05f); // the picture repeats, so its right edge is the neighbour
    CHECK(l.material("slope").normal_scale == 3);
    CHECK(l.material("shared").normal_scale == 0.5f);
    CHECK(l.material("shared").normal_texture.image == l.material("slope").normal_texture.image);
    CHECK(l.material("shared").base_color_texture.image != l.material("shared").normal_texture.image);
    for (const uint32_t x : {0u, 3u}) {
        CHECK(std::abs(slope_of(l.normals("flat"), x, 2).x) < 0.005f);
        CHECK(std::abs(slope_of(l.normals("flat"), x, 0).y) < 0.005f);
    }
    // "both" keeps its normal map, which here is flat.png as it is; the bumps are named.
    CHECK(l.material("both").normal_scale == 1);
    REQUIRE(l.messages.left_out().size() == 1);
    CHECK(l.messages.left_out()[0].find("a.mtl:10") != std::string::npos);
    CHECK(l.scene.images.size() == 4); // slope.png, its normals, flat.png, its normals
}

TEST_CASE("mtl: a height picture that nothing else uses is replaced by its normals") {
    const fs::path folder = test::scratch_folder();
    write_heights(folder / "h.png", 4, 4, [](uint32_t x, uint32_t) { return static_cast<uint8_t>(x % 2 * 200); });
    write_heights(folder / "c.png", 4, 4, [](uint32_t, uint32_t) { return uint8_t{9}; });
    const MtlScene l = mtl_scene(folder, "newmtl a\nbump h.png\nmap_Kd c.png\nnewmtl b\nbump -bm 2 h.png\n");
    REQUIRE(l.scene.images.size() == 2);
    const Material& a = l.material("a");
    CHECK(l.scene.images[static_cast<std::size_t>(a.base_color_texture.image)].rgba8.pixels[0] == 9);
    CHECK(a.normal_texture.image == l.material("b").normal_texture.image);
    CHECK(a.normal_texture.image != a.base_color_texture.image);
}

TEST_CASE("normals of float heights are floats, of the channel, and flat where a height is not finite") {
    TextureImage heights;
    heights.rgba_float = {8, 8, 4, std::vector<float>(8 * 8 * 4)};
    for (uint32_t i = 0; i < 64; ++i) {
        float* texel = heights.rgba_float.pixels.data() + 4 * i;
        texel[0] = static_cast<float>(i % 8);
        texel[1] = static_cast<float>(i / 8);
    }
    const float unit = kBumpHeight * 8;
    const TextureImage red = normals_of_heights(heights, 'r', Wrap::ClampToEdge);
    const TextureImage green = normals_of_heights(heights, 'g', Wrap::ClampToEdge);
    REQUIRE(red.rgba_float.pixels.size() == 256);
    CHECK(slope_of(red, 4, 4).x == doctest::Approx(unit));
    CHECK(slope_of(red, 4, 4).y == doctest::Approx(0));
    CHECK(slope_of(green, 4, 4).y == doctest::Approx(-unit));
    CHECK(slope_of(red, 0, 4).x == doctest::Approx(unit / 2)); // the edge continues as it is
    CHECK(slope_of(normals_of_heights(heights, 'm', Wrap::ClampToEdge), 4, 4).x == doctest::Approx(0.2126f * unit));
    heights.rgba_float.pixels[4 * (4 * 8 + 4)] = kInfinity;
    const TextureImage broken = normals_of_heights(heights, 'r', Wrap::Repeat);
    CHECK(slope_of(broken, 3, 4).x == 0);
    CHECK(slope_of(broken, 1, 4).x == doctest::Approx(unit));
}
