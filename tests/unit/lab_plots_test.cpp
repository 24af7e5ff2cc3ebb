#include <doctest/doctest.h>

#include <cmath>

#include "lab/heat_map.h"
#include "lab/svg_plot.h"

using namespace pertev;

TEST_CASE("an axis has at most the steps asked for, at 1, 2 or 5 times a power of ten") {
    for (const double most : {0.003, 0.9, 1.0, 7.0, 12.0, 99.0, 2e6}) {
        const double step = axis_step(most, 6);
        CAPTURE(most);
        CHECK(step * 6 >= most);
        CHECK(step * 6 / 6 < most * 1.0001);
        double mantissa = step;
        while (mantissa < 0.99) mantissa *= 10;
        while (mantissa > 9.9) mantissa /= 10;
        const bool round =
            std::abs(mantissa - 1) < 1e-9 || std::abs(mantissa - 2) < 1e-9 || std::abs(mantissa - 5) < 1e-9;
        CHECK(round);
    }
}

TEST_CASE("a heat map gets lighter as counts rise, and carries its scale below") {
    const auto light = [](FalseColor c) { return 2 * c.r + 7 * c.g + c.b; };
    for (int i = 1; i <= 50; ++i) {
        CHECK(light(false_color(static_cast<float>(i) / 50)) >= light(false_color(static_cast<float>(i - 1) / 50)));
    }
    std::vector<uint32_t> counts(64 * 32, 5);
    counts[64 * 31 + 63] = 1'000'000;
    CHECK(scale_end(counts) == 5); // one mad pixel does not darken the rest
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
