#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "image/srgb.h"
#include "image/srgb_table.h"
#include "image/tone_map.h"
#include "image/tone_map_image.h"

using namespace pertev;

namespace {

constexpr ToneMap kAll[] = {ToneMap::Srgb, ToneMap::Agx, ToneMap::Aces, ToneMap::Neutral};

double encode_in_double(double x) {
    x = std::clamp(x, 0.0, 1.0);
    return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
}

using Colour = std::array<double, 3>;

Colour times(const double (&m)[3][3], const Colour& v) {
    Colour result{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k) result[i] += m[i][k] * v[k];
    return result;
}

void check_close(Rgb got, const Colour& wanted, double tolerance = 2e-5) {
    const double values[] = {double(got.r), double(got.g), double(got.b)};
    for (std::size_t c = 0; c < 3; ++c) CHECK(values[c] == doctest::Approx(wanted[c]).scale(1).epsilon(tolerance));
}

// Reference values: each operator in double precision, written from its publication.

Colour neutral_in_double(Colour c) {
    const double x = std::min({c[0], c[1], c[2]});
    const double offset = x < 0.08 ? x - 6.25 * x * x : 0.04;
    for (double& v : c) v -= offset;
    const double peak = std::max({c[0], c[1], c[2]});
    if (peak >= 0.76) {
        const double new_peak = 1 - 0.24 * 0.24 / (peak + 0.24 - 0.76);
        const double g = 1 / (0.15 * (peak - new_peak) + 1);
        for (double& v : c) v = v * new_peak / peak * g + new_peak * (1 - g);
    }
    for (double& v : c) v = encode_in_double(v);
    return c;
}

Colour aces_in_double(const Colour& c) {
    Colour v = times({{0.59719, 0.35458, 0.04823}, {0.07600, 0.90834, 0.01566}, {0.02840, 0.13383, 0.83777}}, c);
    for (double& x : v) x = (x * (x + 0.0245786) - 0.000090537) / (x * (0.983729 * x + 0.4329510) + 0.238081);
    v = times({{1.60475, -0.53108, -0.07367}, {-0.10208, 1.10813, -0.00605}, {-0.00327, -0.07276, 1.07602}}, v);
    for (double& x : v) x = encode_in_double(x);
    return v;
}

Colour agx_in_double(const Colour& c) {
    Colour v = times({{0.842479062253094, 0.0784335999999992, 0.0792237451477643},
                      {0.0423282422610123, 0.878468636469772, 0.0791661274605434},
                      {0.0423756549057051, 0.0784336, 0.879142973793104}},
                     c);
    for (double& x : v) {
        x = (std::clamp(std::log2(std::max(x, 1e-30)), -12.47393, 4.026069) + 12.47393) / (4.026069 + 12.47393);
        x = 15.5 * std::pow(x, 6) - 40.14 * std::pow(x, 5) + 31.96 * std::pow(x, 4) - 6.868 * std::pow(x, 3) +
            0.4298 * x * x + 0.1191 * x - 0.00232;
    }
    v = times({{1.19687900512017, -0.0980208811401368, -0.0990297440797205},
               {-0.0528968517574562, 1.15190312990417, -0.0989611768448433},
               {-0.0529716355144438, -0.0980434501171241, 1.15107367264116}},
              v);
    for (double& x : v) x = std::clamp(x, 0.0, 1.0);
    return v;
}

} // namespace

TEST_CASE("sRGB decoding and encoding follow IEC 61966-2-1 and are inverse on every byte") {
    for (int i = 0; i < 256; ++i) {
        const double e = i / 255.0, wanted = e <= 0.04045 ? e / 12.92 : std::pow((e + 0.055) / 1.055, 2.4);
        const float decoded = srgb_decode_table()[static_cast<std::size_t>(i)];
        CHECK(std::abs(double(decoded) - wanted) <= 5e-7 * wanted); // 2.4 times the rounding of the base, and pow's
        CHECK(to_byte(srgb_encode(decoded)) == i);
    }
    CHECK(srgb_decode(0.0f) == 0);
    CHECK(srgb_decode(1.0f) == 1);
    CHECK(srgb_encode(1.0f) == 1);
    CHECK(srgb_encode(0.5f) == doctest::Approx(0.7353569).epsilon(1e-6));
    CHECK(srgb_encode(std::numeric_limits<float>::quiet_NaN()) == 0);
    CHECK(srgb_encode(-3.0f) == 0);
    CHECK(srgb_encode(std::numeric_limits<float>::infinity()) == 1);
}

TEST_CASE("every tone map sends black to black and keeps greys grey and in order") {
    for (const ToneMap kind : kAll) {
        CAPTURE(static_cast<int>(kind));
        CHECK(tone_map({}, kind).g == doctest::Approx(0).epsilon(1e-6));
        float before = 0;
        for (float stops = -16; stops < 12; stops += 0.03125f) {
            CAPTURE(stops);
            const Rgb shown = tone_map(grey(std::exp2(stops)), kind);
            CHECK(shown.g >= before);
            CHECK(std::abs(shown.r - shown.g) < 2e-3f); // the published matrices are rounded
            CHECK(std::abs(shown.b - shown.g) < 2e-3f);
            before = shown.g;
        }
        CHECK(before > 0.97f);
    }
}

TEST_CASE("tone maps stay within [0, 1] for every input") {
    const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    const float values[] = {nan, -inf, -3.4e38f, -1, -1e-42f, 0, 1e-42f, 1e-8f, 0.08f, 0.5f, 1, 1e4f, 3.4e38f, inf};
    for (const ToneMap kind : kAll) {
        for (const float r : values) {
            for (const float g : values) {
                for (const float b : values) {
                    for (const float scale : {0.0f, 1.0f, 0x1p100f, inf}) {
                        const Rgb shown = tone_map({r, g, b}, kind, scale);
                        for (const float x : {shown.r, shown.g, shown.b}) REQUIRE((x >= 0 && x <= 1));
                    }
                }
            }
        }
    }
}

TEST_CASE("AgX, ACES and PBR Neutral agree with their formulas in double over a grid of colours") {
    for (double r = 0.001; r < 40; r *= 2.7) {
        for (double g = 0.002; g < 40; g *= 3.1) {
            for (double b = 0.0; b < 40; b = b * 3.3 + 0.01) {
                const Rgb c = {static_cast<float>(r), static_cast<float>(g), static_cast<float>(b)};
                const Colour in = {double(c.r), double(c.g), double(c.b)};
                check_close(tone_map(c, ToneMap::Agx), agx_in_double(in));
                check_close(tone_map(c, ToneMap::Aces), aces_in_double(in));
                check_close(tone_map(c, ToneMap::Neutral), neutral_in_double(in));
            }
        }
    }
}

TEST_CASE("below its knee PBR Neutral is the colour minus the 4 % of a dielectric's reflection") {
    for (const Rgb base : {Rgb{0.04f, 0.3f, 0.75f}, Rgb{0.7f, 0.04f, 0.1f}, Rgb{0.5f, 0.5f, 0.5f}}) {
        const Rgb shown = srgb_decode(tone_map(base + grey(0.04f), ToneMap::Neutral));
        CHECK(shown.r == doctest::Approx(double(base.r)).epsilon(1e-5));
        CHECK(shown.g == doctest::Approx(double(base.g)).epsilon(1e-5));
        CHECK(shown.b == doctest::Approx(double(base.b)).epsilon(1e-5));
    }
    // Above the knee, a peak of 1.96 after the offset becomes 1 - 0.0576 / 1.44 = 0.96.
    CHECK(srgb_decode(tone_map(grey(2.0f), ToneMap::Neutral)).g == doctest::Approx(0.96).epsilon(1e-5));
}

TEST_CASE("AgX maps middle grey to the middle and desaturates bright colours") {
    CHECK(tone_map(grey(0.18f), ToneMap::Agx).g == doctest::Approx(0.5).epsilon(0.01)); // the pivot of AgX
    const Rgb red = tone_map({64, 0, 0}, ToneMap::Agx);
    CHECK(red.g > 0.4f);
    CHECK(red.r > red.g);
}

TEST_CASE("exposure is in stops") {
    CHECK(exposure_scale(0) == 1);
    CHECK(exposure_scale(3) == 8);
    CHECK(exposure_scale(-1) == 0.5f);
    for (const ToneMap kind : kAll) CHECK(tone_map(grey(0.05f), kind, exposure_scale(2)) == tone_map(grey(0.2f), kind));
}

TEST_CASE("tone mapping divides by premultiplied alpha, or composites over black without alpha") {
    const Image image{1, 1, 4, {0.25f, 0.5f, 0, 0.5f}};
    CHECK(tone_map_image(image, ToneMap::Srgb).pixels == std::vector<uint8_t>{188, 255, 0, 128});
    CHECK(tone_map_image(image, ToneMap::Srgb, 0, false).pixels == std::vector<uint8_t>{137, 188, 0, 255});
    const Image grey_image{1, 1, 1, {0.125f}};
    CHECK(tone_map_image(grey_image, ToneMap::Srgb, 1).pixels == std::vector<uint8_t>{137, 137, 137, 255});
}

TEST_CASE("tone maps are found by their names") {
    CHECK(value_named<ToneMap>("agx") == ToneMap::Agx);
    CHECK(value_named<ToneMap>("srgb") == ToneMap::Srgb);
    CHECK(value_named<ToneMap>("aces") == ToneMap::Aces);
    CHECK(value_named<ToneMap>("neutral") == ToneMap::Neutral);
    CHECK(!value_named<ToneMap>("filmic"));
}
