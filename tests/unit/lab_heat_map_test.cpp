#include <doctest/doctest.h>

#include "lab/heat_map.h"

using namespace pertev;

TEST_CASE("a heat map gets lighter as counts rise, and carries its scale below") {
    const auto light = [](FalseColor c) { return 2 * c.r + 7 * c.g + c.b; };
    for (int i = 1; i <= 50; ++i) {
        CHECK(light(false_color(static_cast<float>(i) / 50)) >= light(false_color(static_cast<float>(i - 1) / 50)));
    }
    std::vector<uint32_t> counts(64 * 32, 5);
    counts[64 * 31 + 63] = 1'000'000;
    CHECK(scale_end(counts) == 5); // one outlier does not darken the rest
    CHECK(scale_end({}) == 1);
    const Rgba8Image image = draw_heat_map(counts, 64, 32, 10);
    CHECK(image.width == 64);
    CHECK(image.height == 48);
    const FalseColor middle = false_color(0.5f);
    CHECK(image.pixels[0] == middle.r);
    CHECK(image.pixels[1] == middle.g);
    const std::size_t bottom = std::size_t(4) * 64 * 47;
    CHECK(image.pixels[bottom + 4 * 63] > image.pixels[bottom]);
}
