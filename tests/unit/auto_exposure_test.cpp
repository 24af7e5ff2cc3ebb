// Automatic exposure of a picture of unknown scale.

#include <doctest/doctest.h>

#include <cstddef>

#include "image/auto_exposure.h"
#include "image/tone_map_image.h"

using namespace pertev;

namespace {

constexpr ToneMap kAll[] = {ToneMap::Srgb, ToneMap::Agx, ToneMap::Aces, ToneMap::Neutral};

/// Returns 160 x 80 grey pixels with the values value(x, y).
template <class Value>
Image picture(Value value) {
    Image image{160, 80, 3, {}};
    for (uint32_t y = 0; y < image.height; ++y) {
        for (uint32_t x = 0; x < image.width; ++x) image.pixels.insert(image.pixels.end(), 3, value(x, y));
    }
    return image;
}

float stops_of(const Image& image, ToneMap tone_map = ToneMap::Agx) { return auto_exposure_stops(image, tone_map); }

/// Returns the share of pixels that are displayed as white.
double burnt_share(const Image& image, ToneMap tone_map, float stops) {
    const Rgba8Image shown = tone_map_image(image, tone_map, stops);
    std::size_t burnt = 0;
    for (std::size_t i = 0; i < shown.pixels.size(); i += 4) {
        burnt += shown.pixels[i] == 255 && shown.pixels[i + 1] == 255 && shown.pixels[i + 2] == 255;
    }
    return 4.0 * static_cast<double>(burnt) / static_cast<double>(shown.pixels.size());
}

} // namespace

TEST_CASE("a uniform grey becomes middle grey, and twice the light lowers the exposure by one stop") {
    for (const ToneMap tone_map : kAll) {
        CHECK(stops_of(picture([](uint32_t, uint32_t) { return 0.36f; }), tone_map) == -1.0f);
        CHECK(stops_of(picture([](uint32_t, uint32_t) { return 0.72f; }), tone_map) == -2.0f);
        CHECK(stops_of(picture([](uint32_t, uint32_t) { return 0.18f * 0x1p30f; }), tone_map) == -30.0f);
    }
}

TEST_CASE("noise does not change the exposure") {
    const auto noisy = picture([](uint32_t x, uint32_t y) { return x % 4 == 1 && y % 4 == 2 ? 16 * 0.18f : 0.0f; });
    CHECK(stops_of(noisy) == 0.0f);
}

TEST_CASE("a dark room does not clip the lit fifth of the picture") {
    const Image room = picture([](uint32_t x, uint32_t) { return x < 32 ? 0.5f : 1e-4f; });
    for (const ToneMap tone_map : kAll) {
        const float stops = stops_of(room, tone_map);
        const float shown = pertev::tone_map(grey(0.5f), tone_map, exposure_scale(stops)).g;
        CHECK(shown <= 0.81f);
        CHECK(shown > 0.78f);
    }
}

TEST_CASE("a few very bright pixels clip at most 0.5 % of the picture") {
    for (const uint32_t columns : {1u, 3u}) { // 0.6 and 1.9 % of the picture, at 300 to 3000 times the rest
        const Image image = picture(
            [&](uint32_t x, uint32_t y) { return x < columns ? 60.0f * static_cast<float>(1 + y / 8) : 0.18f; });
        for (const ToneMap tone_map : kAll) {
            const float stops = stops_of(image, tone_map);
            CHECK(burnt_share(image, tone_map, stops) <= 0.005);
            CHECK(burnt_share(image, tone_map, stops + 0.5f) > 0.005); // the exposure is not lower than necessary
        }
    }
    const Image sparks = picture([](uint32_t x, uint32_t y) { return x == 7 && y < 60 ? 1e6f : 0.18f; }); // 0.47 %
    CHECK(stops_of(sparks) == 0.0f);
}

TEST_CASE("paint keeps its colour: its largest channel stays below 0.8 except in a tenth of the picture") {
    const Image plain = picture([](uint32_t, uint32_t) { return 0.0f; });
    for (const Rgb paint : {Rgb{0.8f, 0.02f, 0.02f}, Rgb{0.02f, 0.02f, 0.8f}}) {
        Image image = plain;
        for (std::size_t i = 0; i < image.pixels.size(); i += 3) {
            image.pixels[i] = paint.r, image.pixels[i + 1] = paint.g, image.pixels[i + 2] = paint.b;
        }
        for (const ToneMap tone_map : kAll) {
            const float largest = max_component(paint), stops = stops_of(image, tone_map);
            CHECK(pertev::tone_map(grey(largest), tone_map, exposure_scale(stops)).g <= 0.801f);
            CHECK(stops > -2); // the picture is not darkened for it
        }
    }
}

TEST_CASE("the middle of the picture weighs more in the mean than a pale background") {
    const auto is_middle = [](uint32_t x, uint32_t y) { return x >= 40 && x < 120 && y >= 20 && y < 60; }; // a quarter
    const auto two_tones = [&](float middle, float around) {
        return picture([&](uint32_t x, uint32_t y) { return is_middle(x, y) ? middle : around; });
    };
    // By area the mean of the logarithms would lie three quarters of the way to the background's 2 stops.
    const float dark_thing = stops_of(two_tones(0.18f, 0.72f), ToneMap::Agx);
    CHECK(dark_thing > -1.3f);
    CHECK(dark_thing < 0);
    CHECK(stops_of(two_tones(0.18f, 0.045f), ToneMap::Agx) == doctest::Approx(-dark_thing).epsilon(0.05));
}

TEST_CASE("an object that fills a tenth of the picture clips no more than one that fills the whole picture") {
    Image image{160, 80, 4, {}}; // 4.7 % of the object, which is 0.47 % of the picture, is bright
    for (uint32_t i = 0; i < 160 * 80; ++i) {
        const uint32_t x = i % 160;
        const bool is_thing = x >= 72 && x < 88;
        const float light = is_thing ? (x < 73 && i / 160 < 60 ? 200.0f : 0.18f) : 0.0f;
        image.pixels.insert(image.pixels.end(), {light, light, light, is_thing ? 1.0f : 0.0f});
    }
    CHECK(tone_map(grey(200), ToneMap::Srgb, exposure_scale(stops_of(image, ToneMap::Srgb))).g < 1);
}

TEST_CASE("pixels without alpha do not count, and partly covered pixels count in part") {
    Image image{160, 80, 4, {}};
    for (uint32_t i = 0; i < 160 * 80; ++i) {
        const bool is_emitter = i % 160 >= 40, is_edge = i % 160 == 39; // a half-covered pixel has half the light
        const float light = is_emitter ? 1000.0f : (is_edge ? 0.5f : 1.0f) * 0.72f;
        image.pixels.insert(image.pixels.end(), {light, light, light, is_emitter ? 0.0f : (is_edge ? 0.5f : 1.0f)});
    }
    CHECK(stops_of(image) == -2.0f);
}

TEST_CASE("stops are multiples of 0.01 and stay within their limits") {
    for (const float light : {1e-30f, 0.0123f, 0.777f, 31.4f, 1e30f}) {
        const float stops = stops_of(picture([&](uint32_t, uint32_t) { return light; }));
        CHECK(stops == floor(100 * stops + 0.5f) / 100.0f);
        CHECK(abs(stops) <= 60);
    }
}

TEST_CASE("a picture without light or finite values is left unchanged") {
    CHECK(stops_of(picture([](uint32_t, uint32_t) { return 0.0f; })) == 0.0f);
    CHECK(stops_of(picture([](uint32_t, uint32_t) { return kInfinity; })) == 0.0f);
}
