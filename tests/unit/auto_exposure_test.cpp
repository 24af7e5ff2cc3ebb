// The exposure that brings a picture of unknown scale to a middle grey.

#include <doctest/doctest.h>

#include <cstddef>

#include "image/auto_exposure.h"
#include "math/portable_math.h"

using namespace pertev;

namespace {

/// 160 x 80 grey pixels, each as `value(x, y)` says.
template <class Value>
Image picture(Value value) {
    Image image{160, 80, 3, {}};
    for (uint32_t y = 0; y < image.height; ++y) {
        for (uint32_t x = 0; x < image.width; ++x) image.pixels.insert(image.pixels.end(), 3, value(x, y));
    }
    return image;
}

} // namespace

TEST_CASE("an even grey becomes middle grey, and twice the light takes one stop off") {
    const float once = auto_exposure_stops(picture([](uint32_t, uint32_t) { return 0.36f; }));
    const float twice = auto_exposure_stops(picture([](uint32_t, uint32_t) { return 0.72f; }));
    CHECK(once == doctest::Approx(-1).epsilon(1e-5));
    CHECK(twice == doctest::Approx(-2).epsilon(1e-5));
}

TEST_CASE("noise does not change the exposure") {
    const auto noisy = picture([](uint32_t x, uint32_t y) { return x % 4 == 1 && y % 4 == 2 ? 16 * 0.18f : 0.0f; });
    CHECK(auto_exposure_stops(noisy) == doctest::Approx(0).epsilon(1e-4));
}

TEST_CASE("a dark room does not burn out the fifth of the picture that is lit") {
    const float stops = auto_exposure_stops(picture([](uint32_t x, uint32_t) { return x < 32 ? 0.5f : 1e-4f; }));
    CHECK(stops == doctest::Approx(1).epsilon(1e-5));
}

TEST_CASE("a picture without light, or without anything finite, is left as it is") {
    CHECK(auto_exposure_stops(picture([](uint32_t, uint32_t) { return 0.0f; })) == 0.0f);
    CHECK(auto_exposure_stops(picture([](uint32_t, uint32_t) { return kInfinity; })) == 0.0f);
}
