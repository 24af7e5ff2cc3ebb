// Ray casting against closed forms: Lambert's law under a point light, a spot's cone, the edge of a hard shadow.

#include <doctest/doctest.h>

#include "tests/support/flat_scenes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

constexpr uint32_t kSide = 20; // pixels
constexpr float kView = 4;     // metres that they cover
constexpr float kInvPiF = 0.318309886f;

/// Takes one sample through the centre of each pixel.
RenderSettings centre_settings(IntegratorKind integrator = IntegratorKind::Cast) {
    RenderSettings settings;
    settings.width = settings.height = kSide;
    settings.samples = 1;
    settings.filter = PixelFilter::Box;
    settings.filter_radius = 0x1p-20f;
    settings.integrator = integrator;
    return settings;
}

/// Returns the point of the floor y = 0 at the centre of a pixel.
Vec3 floor_point(uint32_t x, uint32_t y) {
    const float pixel = kView / kSide;
    return {(static_cast<float>(x) + 0.5f) * pixel - kView / 2, 0, (static_cast<float>(y) + 0.5f) * pixel - kView / 2};
}

/// No pixel's centre lies on the edge between its triangles, because hits are moved off edges (device_scene/surface.h).
Mesh wide_floor() { return test::sheet({0.05f, 0, 0}, {0, 0, 10}, {10, 0, 0}); }

RenderResult look_down(const Scene& scene, float from_height, const RenderSettings& settings) {
    Queue queue = test::requested_queue();
    return test::render(queue, scene, test::camera_down({0, from_height, 0}, kView), settings);
}

template <class Expected>
void check_floor(const RenderResult& result, const Expected& expected) {
    for (uint32_t y = 0; y < kSide; ++y) {
        for (uint32_t x = 0; x < kSide; ++x) {
            const double wanted = static_cast<double>(expected(floor_point(x, y)));
            CHECK(static_cast<double>(result.picture.at(x, y)[0]) == doctest::Approx(wanted).epsilon(2e-5));
        }
    }
}

} // namespace

TEST_CASE("cast matches Lambert's law on a floor under a point light") {
    Scene scene;
    test::add(scene, wide_floor(), test::white(0.5f));
    const Vec3 light = {0.3f, 1, -0.4f};
    scene.lights.push_back(test::point_light(light, {7, 7, 7}));
    const RenderResult result = look_down(scene, 3, centre_settings());
    check_floor(result, [&](Vec3 p) {
        const float d2 = length_squared(light - p);
        return 0.5f * kInvPiF * 7 * light.y / (d2 * sqrt(d2));
    });
    CHECK(result.rays.camera == kSide * kSide);
    CHECK(result.rays.bounce == 0);
    CHECK(result.rays.shadow == kSide * kSide); // there is one light
}

TEST_CASE("cast shows the cone of a spot light, which is dark from its outer angle on") {
    Scene scene;
    test::add(scene, wide_floor(), test::white(1));
    Light spot = test::point_light({0, 2, 0}, {10, 10, 10});
    spot.kind = LightKind::Spot;
    spot.direction = {0, -1, 0};
    spot.cos_inner = 0.95f;
    spot.cos_outer = 0.85f;
    scene.lights.push_back(spot);
    const RenderResult result = look_down(scene, 3, centre_settings());
    uint32_t dark = 0, full = 0;
    check_floor(result, [&](Vec3 p) {
        const float d2 = 4 + p.x * p.x + p.z * p.z, cosine = 2 / sqrt(d2);
        const float share = clamp((cosine - 0.85f) / 0.1f, 0.0f, 1.0f);
        dark += share == 0 ? 1 : 0;
        full += share == 1 ? 1 : 0;
        return kInvPiF * 10 * share * share * cosine / d2;
    });
    CHECK(dark > 40);
    CHECK(full > 20);
    CHECK(result.rays.shadow == kSide * kSide - dark); // unlit points trace no shadow rays
}

TEST_CASE("cast puts the edge of a hard shadow at its geometric position") {
    Scene scene;
    test::add(scene, wide_floor(), test::white(1));
    test::add(scene, test::floor_at(0.5f, 0.32f),
              test::white(1)); // the sheet is half way to the light, so its shadow is twice as large
    scene.lights.push_back(test::point_light({0, 1, 0}, {1, 1, 1}));
    uint32_t dark = 0;
    check_floor(look_down(scene, 0.4f, centre_settings()), [&](Vec3 p) { // the camera is below the sheet
        const bool is_dark = max(abs(p.x), abs(p.z)) < 0.64f;
        dark += is_dark ? 1 : 0;
        const float d2 = 1 + p.x * p.x + p.z * p.z;
        return is_dark ? 0.0f : kInvPiF / (d2 * sqrt(d2));
    });
    CHECK(dark == 36); // pixels of 0.2 m
    scene.lights.front().kind = LightKind::Directional;
    scene.lights.front().direction =
        normalize(Vec3{1, -1, 0}); // the direction moves the shadow to the right by the sheet's height
    check_floor(look_down(scene, 0.4f, centre_settings()), [&](Vec3 p) {
        const bool is_dark = max(abs(p.x - 0.5f), abs(p.z)) < 0.32f;
        return is_dark ? 0.0f : kInvPiF * 0.70710678f;
    });
}

TEST_CASE("ambient light equals the reflection of a uniform radiance by a diffuse surface") {
    Scene scene;
    test::add(scene, wide_floor(), test::white(0.5f));
    RenderSettings settings = centre_settings();
    settings.ambient = Rgb{0.25f, 0.25f, 0.25f};
    check_floor(look_down(scene, 3, settings), [](Vec3) { return 0.125f; });

    scene.environment = Environment{.image = {}, .scale = {2, 2, 2}};
    settings.ambient.reset();
    check_floor(look_down(scene, 3, settings), [](Vec3) { return 0.0f; }); // cast lacks this setting
    settings.integrator =
        IntegratorKind::Whitted; // cast uses the environment's mean, which is exact for a floor under a uniform sky
    check_floor(look_down(scene, 3, settings), [](Vec3) { return 1.0f; });
    settings.ambient = Rgb{0, 0, 0};
    check_floor(look_down(scene, 3, settings), [](Vec3) { return 0.0f; });
}
