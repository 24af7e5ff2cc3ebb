#include <doctest/doctest.h>

#include "formats/read_scene.h"
#include "image/shrink_image.h"
#include "image/srgb.h"
#include "image/write_png.h"
#include "tests/support/options.h"
#include "tests/support/write_text.h"

namespace fs = std::filesystem;
using namespace pertev;

TEST_CASE("a picture is scaled down to the longer side, and keeps its shape") {
    using Size = std::pair<uint32_t, uint32_t>;
    CHECK(shrunk_size(100, 50, 10) == Size{10, 5});
    CHECK(shrunk_size(50, 100, 10) == Size{5, 10});
    CHECK(shrunk_size(1000, 1, 10) == Size{10, 1});
    CHECK(shrunk_size(7, 10, 10) == Size{7, 10});
    CHECK(shrunk_size(65536, 65536, 1) == Size{1, 1});
}

TEST_CASE("a pixel that is scaled down is the mean of its area, also where sizes do not divide") {
    Image image{5, 2, 2, {}};
    for (uint32_t i = 0; i < 10; ++i) image.pixels.insert(image.pixels.end(), {static_cast<float>(i), 1});
    const Image half = shrink_image(image, 2, false); // 2.5 pixels each, and both rows
    REQUIRE(half.width == 2);
    REQUIRE(half.height == 1);
    CHECK(half.at(0, 0)[0] == doctest::Approx((0 + 1 + 0.5 * 2) / 2.5 + 2.5));
    CHECK(half.at(1, 0)[0] == doctest::Approx((0.5 * 2 + 3 + 4) / 2.5 + 2.5));
    CHECK(half.at(1, 0)[1] == 1);
}

TEST_CASE("colours that are sRGB-encoded have the mean of their light, alpha and data that of their numbers") {
    const Rgba8Image image{2, 1, {0, 0, 0, 0, 255, 255, 255, 255}};
    const Rgba8Image colours = shrink_image(image, 1, true), data = shrink_image(image, 1, false);
    CHECK(colours.pixels == std::vector<uint8_t>{188, 188, 188, 128});
    CHECK(data.pixels == std::vector<uint8_t>{128, 128, 128, 128});
    const Rgba8Image grey_and_black{2, 1, {0, 0, 0, 255, 128, 128, 128, 255}};
    CHECK(shrink_image(grey_and_black, 1, true).pixels == std::vector<uint8_t>{92, 92, 92, 255});
    const Image encoded{2, 1, 4, {0, 0, 0, 0, 1, 1, 1, 1}};
    CHECK(shrink_image(encoded, 1, true).pixels[0] == doctest::Approx(srgb_encode(0.5f)));
    CHECK(shrink_image(encoded, 1, true).pixels[3] == 0.5f);
}

TEST_CASE("textures of a scene are at most as large as requested, each by its use") {
    const fs::path folder = test::scratch_folder();
    Rgba8Image image{8, 8, {}};
    for (int i = 0; i < 64; ++i) {
        const uint8_t value = i % 2 * 255;
        image.pixels.insert(image.pixels.end(), {value, value, value, 255});
    }
    write_png(folder / "colour.png", image, false);
    write_png(folder / "data.png", image, false);
    test::write_text(folder / "a.mtl", "newmtl m\nmap_Kd colour.png\nmap_Pr data.png\n");
    const fs::path path = test::write_text(
        folder / "a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n");
    for (const uint32_t most : {0u, 4u, 8u}) {
        Messages messages;
        const Scene scene = read_scene(path, {.max_texture_size = most}, messages);
        REQUIRE(scene.images.size() == 2);
        const Material& m = scene.materials[0];
        const Rgba8Image& colour = scene.images[static_cast<std::size_t>(m.base_color_texture.image)].rgba8;
        const Rgba8Image& data = scene.images[static_cast<std::size_t>(m.roughness_texture.image)].rgba8;
        CHECK(colour.width == (most == 4 ? 4 : 8));
        CHECK(colour.pixels[0] == (most == 4 ? 188 : 0));
        CHECK(data.pixels[0] == (most == 4 ? 128 : 0));
    }
}
