// Look-up tables, p-values, and 16 bits.

#include "image/cube_lut.h"

#include <cmath>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "image/display_image.h"
#include "image/significance.h"

using namespace pertev;

namespace {

CubeLut lut_of(uint32_t side, const auto& change) {
    std::string text = fmt::format("LUT_3D_SIZE {}\r\n", side);
    const auto step = [&](uint32_t i) { return static_cast<float>(i) / static_cast<float>(side - 1); };
    for (uint32_t b = 0; b < side; ++b)
        for (uint32_t g = 0; g < side; ++g)
            for (uint32_t r = 0; r < side; ++r) {
                const Rgb to = change(Rgb{step(r), step(g), step(b)});
                text += fmt::format("{} {} {}\r\n", to.r, to.g, to.b);
            }
    return CubeLut::parse(std::as_bytes(std::span(text)), "x.cube");
}

Image flat_image(std::initializer_list<float> pixels) {
    return {static_cast<uint32_t>(pixels.size() / 3), 1, 3, {pixels}};
}

} // namespace

TEST_CASE("a table is exact at its points, linear functions everywhere, and clamped outside its domain") {
    const CubeLut affine = lut_of(4, [](Rgb c) { return Rgb{0.5f * c.r + 0.25f * c.g, c.b, 1 - c.g}; });
    for (const Rgb c : {Rgb{0.1f, 0.7f, 0.4f}, {0.9f, 0.2f, 0.95f}, {1, 1, 1}, {0, 0, 0}, {0.5f, 0.5f, 0.5f}}) {
        const Rgb to = affine(c);
        CHECK(to.r == doctest::Approx(0.5f * c.r + 0.25f * c.g));
        CHECK(to.g == doctest::Approx(c.b));
        CHECK(to.b == doctest::Approx(1 - c.g));
    }
    CHECK(affine({2, -1, 5}).g == 1);
    CHECK(affine({2, -1, 5}).b == 1);
    CHECK(affine({NAN, 0, 0}).r == 0);
    CHECK(affine({INFINITY, 0, 0}).r == 0.5f);
}

TEST_CASE("between its points a table is interpolated over tetrahedra along the grey axis") {
    // The product of r and g is 0 at three corners of a cell and 1 at the fourth: over a tetrahedron it is the smaller.
    const CubeLut product = lut_of(2, [](Rgb c) { return Rgb{c.r * c.g, c.r * c.g * c.b, max(c.r, c.b)}; });
    const Rgb to = product({0.75f, 0.25f, 0.5f});
    CHECK(to.r == doctest::Approx(0.25f));
    CHECK(to.g == doctest::Approx(0.25f)); // trilinear: 0.09375
    CHECK(to.b == doctest::Approx(0.75f));
}

TEST_CASE("curves are linear between their points, clamp to their range, and shape light for the table after them") {
    const auto parsed = [](const std::string& text) {
        return CubeLut::parse(std::as_bytes(std::span(text)), "x.cube");
    };
    const std::string curves = "0 1 -2\n1 0 -2\n4 0 6\n";
    for (const char* range : {"LUT_1D_INPUT_RANGE 1 3\n", "DOMAIN_MIN 1 1 1\nDOMAIN_MAX 3 3 3\n"}) {
        const CubeLut lut = parsed(std::string("LUT_1D_SIZE 3\n") + range + curves);
        CHECK(lut.side() == 0);
        const Rgb inside = lut({1.5f, 1.25f, 2.5f}), outside = lut({0, 9, NAN});
        CHECK(inside.r == 0.5f);
        CHECK(inside.g == 0.75f);
        CHECK(inside.b == 2);
        CHECK(outside.r == 0);
        CHECK(outside.g == 0);
        CHECK(outside.b == -2);
    }
    // The table inverts what the curves leave of its range [0, 2].
    const std::string sizes = "LUT_1D_SIZE 3\nLUT_1D_INPUT_RANGE 0 2\nLUT_3D_SIZE 2\nLUT_3D_INPUT_RANGE 0 2\n";
    const CubeLut both = parsed(sizes + curves + "1 1 1\n0 1 1\n1 0 1\n0 0 1\n1 1 0\n0 1 0\n1 0 0\n0 0 0\n");
    const Rgb shaped = both({0.5f, 0.5f, 1.25f});
    CHECK(shaped.r == 0.75f); // 1 - 0.5 / 2
    CHECK(shaped.g == 0.75f);
    CHECK(shaped.b == 1); // the curve has 0
    // Each is a whole table with one fault.
    const std::string curve = "LUT_1D_SIZE 2\n", two = "0 0 0\n1 1 1\n",
                      corners = "1 1 1\n0 1 1\n1 0 1\n0 0 1\n1 1 0\n0 1 0\n1 0 0\n0 0 0\n";
    CHECK_NOTHROW(parsed(curve + two));
    CHECK_NOTHROW(parsed(sizes + curves + corners));
    CHECK_NOTHROW(parsed("LUT_3D_SIZE 2\nLUT_3D_INPUT_RANGE 0 1\n" + corners));
    std::string long_curve = "LUT_1D_SIZE 65537\n";
    for (int i = 0; i < 65537; ++i) long_curve += "0 0 0\n";
    for (const std::string& bad :
         {sizes + curves, "DOMAIN_MIN 0 0 0\n" + sizes + curves + corners, curves + sizes + corners,
          curve + curve + two, curve + "LUT_1D_INPUT_RANGE 1 1\n" + two, long_curve,
          "LUT_3D_SIZE 2\nLUT_3D_INPUT_RANGE 0\n" + corners})
        CHECK_THROWS(parsed(bad));
}

TEST_CASE("16 bits keep what 8 bits round, with alpha, before and after a table") {
    const Image linear = {2, 1, 4, {0.25f, 0.5f, 0.1f, 0.5f, 0, 2, NAN, 1}};
    for (const bool has_lut : {false, true}) {
        DisplayTransform transform;
        if (has_lut) transform.lut = std::make_shared<const CubeLut>(lut_of(3, [](Rgb c) { return c; }));
        const Rgba8Image narrow = display_image(linear, transform);
        const Rgba16Image wide = display_image_16(linear, transform);
        REQUIRE(wide.pixels.size() == 8);
        for (std::size_t i = 0; i < 8; ++i)
            CHECK(std::abs(static_cast<float>(wide.pixels[i]) / 257 - static_cast<float>(narrow.pixels[i])) < 0.51f);
        CHECK(wide.pixels[3] == 32768);
        CHECK(wide.pixels[5] == 65535);
    }
}

TEST_CASE("p-values are those of the normal distribution, and 1 or 0 where there is no variance") {
    const Image zero = flat_image({0, 0, 0}), variance = flat_image({1, 0.5f, 0});
    const Image p = p_values(flat_image({1.96f, 0, 1}), variance, zero, flat_image({0, 0.5f, 0}));
    CHECK(p.pixels[0] == doctest::Approx(0.05).epsilon(1e-3));
    CHECK(p.pixels[1] == 1);
    CHECK(p.pixels[2] == 0);
    CHECK(p_values(flat_image({1, 1, 1}), zero, flat_image({1.00005f, 1.0002f, 1}), zero).pixels ==
          std::vector<float>{1, 0, 1});
    CHECK(p_values(flat_image({NAN, 0, 0}), variance, zero, variance).pixels[0] == 0);
    const Significance few = significance_of(flat_image({0.005f, 0.5f, 0.9f}));
    CHECK(few.p == doctest::Approx(1 - std::pow(0.995, 3)));
    CHECK(few.share_below == doctest::Approx(1.0 / 3));
    CHECK(significance_of(flat_image({0, 1, 1})).p == 0);
    CHECK(significance_of(flat_image({1, 1, 1})).p == 1);
}
