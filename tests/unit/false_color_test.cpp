// False-colour pictures: the position of a value on the scale, and the scale below the picture.

#include <doctest/doctest.h>

#include "image/false_color.h"

using namespace pertev;

namespace {

Image grey_row(std::initializer_list<float> values) {
    Image image{static_cast<uint32_t>(values.size()), 1, 3, {}};
    for (const float v : values) image.pixels.insert(image.pixels.end(), {v, v, v});
    return image;
}

bool has_color(const Rgba8Image& image, uint32_t x, uint32_t y, float t) {
    const uint8_t* p = &image.pixels[4 * (std::size_t(y) * image.width + x)];
    const FalseColor c = false_color(t);
    return p[0] == c.r && p[1] == c.g && p[2] == c.b && p[3] == 255;
}

} // namespace

TEST_CASE("false colours follow the logarithm from the minimum to the maximum of the scale") {
    const Image row = grey_row({0.0f, -1.0f, 0.5f, 5.0f, 50.0f, 500.0f, 5000.0f});
    const Rgba8Image image = draw_false_colors(row, 2, {1, 1000, "lx"});
    REQUIRE(image.width == 7);
    REQUIRE(image.height == 1 + kFalseColorScaleRows);
    const float places[] = {0, 0, 0, 1.0f / 3, 2.0f / 3, 1, 1};
    for (uint32_t x = 0; x < 7; ++x) CHECK(has_color(image, x, 0, places[x]));
}

TEST_CASE("a wide picture has the scale with numbers and the unit below") {
    Image wide{400, 1, 3, {}};
    wide.pixels.assign(1200, 1.0f);
    const Rgba8Image image = draw_false_colors(wide, 1, {1, 1000, "cd/m2"});
    for (const uint32_t x : {0u, 100u, 399u}) {
        CHECK(has_color(image, x, 5, (static_cast<float>(x) + 0.5f) / 400));
    }
    uint32_t ink[4] = {}; // black points of the numbers, in quarters
    for (uint32_t y = 20; y < 30; ++y) {
        for (uint32_t x = 0; x < 400; ++x) ink[x / 100] += image.pixels[4 * (std::size_t(y) * 400 + x)] == 0 ? 1 : 0;
    }
    for (const uint32_t points : ink) CHECK(points > 20);
    const Rgba8Image small =
        draw_false_colors(grey_row({1}), 1, {1, 1000, "cd/m2"}); // numbers are omitted where there is no room
    CHECK(small.width == 1);
}

TEST_CASE("the scale ends at a round number that at most one pixel in two hundred exceeds") {
    Image image{400, 1, 3, {}};
    image.pixels.assign(1200, 3.0f);
    image.pixels[0] = image.pixels[1] = image.pixels[2] = 1e6f;
    const FalseColorScale scale = fitting_scale(image, 10, "lx");
    CHECK(scale.most == doctest::Approx(50));
    CHECK(scale.least == doctest::Approx(0.05));
    CHECK(scale.unit == "lx");
    CHECK(fitting_scale(grey_row({0, 0}), 1, "lx").most == 1);
}
