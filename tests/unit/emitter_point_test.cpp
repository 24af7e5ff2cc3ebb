// Light from a stored sample point to any receiver.

#include <doctest/doctest.h>

#include "shading/emitter_point.h"
#include "tests/support/lit_scenes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

/// Two square emitters, a point light, a directional light, and a sky of 4 x 2 pixels.
Scene make_kept_emitters() {
    Scene scene;
    add_emitter(scene, make_square(2), {1, 2, 3}, make_translation({0, 3, 0}));
    add_emitter(scene, make_square(1), {4, 1, 1}, make_translation({2, 2, 1}));
    scene.lights.push_back({.kind = LightKind::Point, .position = {1, 2, -3}, .intensity = {5, 6, 7}});
    scene.lights.push_back({.kind = LightKind::Directional, .direction = {0, -1, 0}, .intensity = {1, 1, 2}});
    scene.environment.emplace();
    scene.environment->image = {4, 2, 3, std::vector<float>(24, 0.25f)};
    for (std::size_t i = 0; i < 12; ++i) scene.environment->image.pixels[i] = 0.1f * static_cast<float>(i);
    return scene;
}

} // namespace

TEST_CASE("a light evaluated again at its emitter point equals its sample") {
    const Lights lights(make_kept_emitters());
    Random random(3);
    uint32_t triangles = 0, punctual = 0, sky = 0;
    const Vec3 from = {0.3f, 0.2f, -0.4f};
    for (int i = 0; i < 4000; ++i) {
        LightSample drawn, found;
        if (!sample_light(lights.view, from, random_bits(random), drawn)) continue;
        float measure = 0;
        REQUIRE(find_light(lights.view, point_of(drawn), from, found, measure));
        CHECK(length(found.wi - drawn.wi) < 1e-6f);
        CHECK(found.radiance.r == doctest::Approx(as_double(drawn.radiance.r)).epsilon(1e-3));
        CHECK(found.distance == drawn.distance);
        CHECK(found.instance == drawn.instance);
        CHECK(found.is_delta == drawn.is_delta);
        if (drawn.instance != kNoLight) {
            ++triangles;
            CHECK(found.pdf == drawn.pdf);
            // The density over weights is the same for all receivers.
            float elsewhere = 0;
            LightSample other;
            if (find_light(lights.view, point_of(drawn), Vec3{1, 0.5f, 1}, other, elsewhere)) {
                CHECK(other.pdf * elsewhere == doctest::Approx(as_double(drawn.pdf * measure)));
            }
        } else if (drawn.is_delta) {
            ++punctual;
            CHECK(measure == 1);
        } else {
            ++sky;
            CHECK(found.pdf == doctest::Approx(as_double(drawn.pdf)).epsilon(1e-3));
        }
    }
    CHECK(triangles > 100);
    CHECK(punctual > 100);
    CHECK(sky > 100);
}

TEST_CASE("no light arrives from an invalid point or from a removed emitter") {
    const Lights lights(make_kept_emitters());
    LightSample sample;
    float measure = 0;
    CHECK_FALSE(find_light(lights.view, {}, Vec3{0, 0, 0}, sample, measure));
    CHECK_FALSE(find_light(lights.view, {kPunctualPoint, 2, 0, 0}, Vec3{0, 0, 0}, sample, measure));
    Scene dark = make_kept_emitters();
    dark.materials[1].emission = {0, 0, 0};
    CHECK_FALSE(find_light(Lights(dark).view, {1, 0, 0.2f, 0.2f}, Vec3{2, 0, 1}, sample, measure));
}
