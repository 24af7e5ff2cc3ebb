// The sky of Preetham, Shirley and Smits: values of the paper's formulas, computed in double by a program of their own,
// the sun's radiance beside Mitsuba's, and the light that a panorama has.

#include "formats/sun_sky/sun_sky.h"

#include <doctest/doctest.h>

#include "math/portable_math.h"

using namespace pertev;

namespace {

constexpr float kDegreeOfSky = kPi / 180;

SunSky sky_of(const std::string& text) {
    const std::optional<SunSky> sky = parse_sun_sky(text);
    REQUIRE(sky.has_value());
    return *sky;
}

Vec3 raised_sun(float elevation_deg, float azimuth_deg) {
    const float up = elevation_deg * kDegreeOfSky, around = azimuth_deg * kDegreeOfSky;
    return {cos(up) * sin(around), sin(up), -cos(up) * cos(around)};
}

/// Luminance times solid angle of all pixels, and of that times the direction.
struct LightOfPanorama {
    double light = 0, x = 0, y = 0, z = 0;
};
LightOfPanorama light_of_panorama(const Environment& environment) {
    const Image& image = environment.image;
    LightOfPanorama sum;
    const auto rows = static_cast<float>(image.height);
    for (uint32_t y = 0; y < image.height; ++y) {
        const float down = kPi * (static_cast<float>(y) + 0.5f) / rows;
        const float area = sin(down) * (kPi / rows) * (kPi / rows);
        for (uint32_t x = 0; x < image.width; ++x) {
            const float around = 2 * kPi * ((static_cast<float>(x) + 0.5f) / (2 * rows) - 0.5f);
            const float* const p = image.at(x, y);
            const auto light = static_cast<double>(area * luminance(Rgb{p[0], p[1], p[2]}));
            sum.light += light;
            sum.x += light * static_cast<double>(sin(down) * sin(around));
            sum.y += light * static_cast<double>(cos(down));
            sum.z -= light * static_cast<double>(sin(down) * cos(around));
        }
    }
    return sum;
}

} // namespace

TEST_CASE("the luminance of the sky is that of the paper's formulas") {
    struct Case {
        const char* sky;
        float elevation;
        double zenith, sun, opposite, beside; // kcd/m2
    };
    const Case cases[] = {{"60,0,2", 60, 5.886743, 17.045086, 3.966821, 12.094645},
                          {"45,90", 45, 7.320358, 28.654828, 5.181303, 8.475977},
                          {"30,200,6", 30, 9.585270, 36.103113, 6.444171, 7.908504},
                          {"10,-90,3", 10, 2.829301, 27.963097, 5.048925, 5.105596}};
    for (const Case& of : cases) {
        CAPTURE(of.sky);
        const SunSky sky = sky_of(of.sky);
        const auto kcd = [&](Vec3 d) { return 0.001 * static_cast<double>(luminance(sky_luminance(sky, d))); };
        const Vec3 sun = sky.sun, aside = normalize(cross({0, 1, 0}, sun));
        CHECK(kcd({0, 1, 0}) == doctest::Approx(of.zenith).epsilon(2e-4));
        CHECK(kcd(sun) == doctest::Approx(of.sun).epsilon(2e-4));
        CHECK(kcd({-sun.x, sun.y, -sun.z}) == doctest::Approx(of.opposite).epsilon(2e-4));
        const float up = 10 * kDegreeOfSky; // a right angle aside of the sun
        CHECK(kcd({cos(up) * aside.x, sin(up), cos(up) * aside.z}) == doctest::Approx(of.beside).epsilon(2e-4));
        CHECK(is_black(sky_luminance(sky, {0.6f, -0.01f, 0.8f})));
    }
    const Rgb blue = sky_luminance(sky_of("45,0,3"), {0, 1, 0}); // x 0.245678, y 0.251476 at 7.32 kcd/m2
    CHECK(blue.b > 1.9f * blue.r);
    CHECK(blue.b > blue.g);
}

TEST_CASE("the sun's radiance is close to Mitsuba's, and redder the lower it is and the more haze there is") {
    const Rgb sun = sun_luminance(sky_of("45,0,3"));
    const double mitsubas = 18029 * kLumensOfFlatLight; // the middle of the sun in the sunsky of Mitsuba 3.9
    CHECK(static_cast<double>(luminance(sun)) == doctest::Approx(mitsubas).epsilon(0.15));
    const auto redness = [](const char* text) {
        const Rgb color = sun_luminance(sky_of(text));
        return color.r / color.b;
    };
    CHECK(redness("10,0,3") > 1.5f * redness("45,0,3"));
    CHECK(redness("45,0,8") > 1.2f * redness("45,0,3"));
    CHECK(luminance(sun_luminance(sky_of("5,0,3"))) < 0.3f * luminance(sun));
}

TEST_CASE("the panorama has the sun's light in its direction, and half of it on the horizon") {
    for (const char* text : {"45,90", "80,-30,2", "3,200,5"}) {
        CAPTURE(text);
        SunSky sky = sky_of(text);
        sky.sky_scale = 0;
        const LightOfPanorama sum = light_of_panorama(make_sun_sky(sky, 683));
        const double all = static_cast<double>(luminance(sun_luminance(sky))) * 6.7967e-5 / 683;
        CHECK(sum.light == doctest::Approx(all).epsilon(1e-3));
        const Vec3 towards =
            normalize(Vec3{static_cast<float>(sum.x), static_cast<float>(sum.y), static_cast<float>(sum.z)});
        CHECK(acos(clamp(dot(towards, sky.sun), -1.0f, 1.0f)) < 0.05f * kDegreeOfSky);
    }
    SunSky low = sky_of("0,45");
    low.sky_scale = 0;
    const double all = static_cast<double>(luminance(sun_luminance(low))) * 6.7967e-5;
    CHECK(light_of_panorama(make_sun_sky(low, 1)).light == doctest::Approx(0.5 * all).epsilon(0.02));

    SunSky blue = sky_of("45,0");
    blue.sun_scale = 0;
    const Environment environment = make_sun_sky(blue, 683);
    CHECK(environment.image.width == 512);
    const LightOfPanorama sum = light_of_panorama(environment);
    CHECK(683 * sum.y > 15'000); // illuminance of level ground by the sky alone, lx
    CHECK(683 * sum.y < 40'000);
}

TEST_CASE("the sun stands where its elevation and azimuth say, and other texts are refused") {
    CHECK(length(sky_of("30,90").sun - raised_sun(30, 90)) < 1e-6f);
    CHECK(sky_of("0,90").sun.x == doctest::Approx(1).epsilon(1e-6));
    CHECK(sky_of("0,0").sun.z == doctest::Approx(-1).epsilon(1e-6));
    CHECK(sky_of("90,10").sun.y == doctest::Approx(1).epsilon(1e-6));
    CHECK(sky_of("45,90,2.5").turbidity == 2.5);
    for (const char* text : {"", "45", "91,0", "-1,0", "45,90,1", "45,90,11", "45,90,3,4", "45;90", "45,90,", "nan,0"})
        CHECK_FALSE(parse_sun_sky(text).has_value());
}
