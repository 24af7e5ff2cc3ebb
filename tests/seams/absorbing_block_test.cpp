// Test code renders a block that absorbs and scatters through the path tracer's functions: the Beer-Lambert law
// attenuates camera and shadow rays, and single scattering equals its integral.

#include "tests/seams/absorbing_block.h"

#include <cmath>

#include <doctest/doctest.h>

#include "image/picture_hash.h"
#include "tests/seams/picture_on_device.h"
#include "tests/support/estimate.h"
#include "tests/support/lit_scenes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

constexpr uint32_t kBlockColumns = 40, kBlockRows = 5; // a pixel covers a fifth of a metre
constexpr double kBlockDepth = 0.5;

/// A directional light and optionally a grey floor.
Scene sunny_scene(Vec3 sun, bool has_floor) {
    Scene scene;
    if (has_floor) test::add_emitter(scene, test::make_square(1), {0, 0, 0}, make_scale({20, 1, 20}));
    Light light;
    light.kind = LightKind::Directional;
    light.direction = normalize(sun);
    light.intensity = {3, 2, 1};
    scene.lights = {light};
    return scene;
}

/// A camera's view from above, 8 m wide in x around x = 1.
template <Features kBlock>
Image render_block(Queue& queue, const Scene& scene, PathSettings settings, uint32_t samples) {
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Camera camera;
    camera.projection = Projection::Orthographic;
    camera.ortho_height = 1;
    camera.world_from_camera = look_at({1, 10, 0}, {1, 0, 0}, {0, 0, -1});
    test::PictureOnDevice picture(queue, prepared, camera, kBlockColumns, kBlockRows);
    Film film(queue, kBlockColumns, kBlockRows, 0);
    settings.max_depth = 1;
    test::BlockRounds<kBlock>(queue, kBlockColumns * kBlockRows)
        .render({.picture = picture.view, .settings = settings, .film = film.view(), .layers = {}}, picture.tracer, 0,
                samples);
    film.set_samples({0, samples});
    CHECK(film.invalid_samples() == 0);
    return film.picture(false);
}

double block_rate(const Rgb& rates, uint32_t channel) {
    return test::as_double(channel == 0 ? rates.r : channel == 1 ? rates.g : rates.b);
}
float column_of_block(uint32_t column) { return -3 + 0.2f * (static_cast<float>(column) + 0.5f); }

} // namespace

TEST_CASE("camera rays and shadow rays are attenuated in a block by Beer's law on both devices") {
    const Scene scene = sunny_scene({1, -1, 0}, true);
    Queue cpu = Queue::make_cpu(), queue = test::requested_queue();
    const Image picture = render_block<test::kAbsorbing>(queue, scene, {}, 4);
    CHECK(picture_hash(picture) == picture_hash(render_block<test::kAbsorbing>(cpu, scene, {}, 4)));
    uint32_t seen_through = 0, in_shadow = 0;
    for (uint32_t column = 0; column < kBlockColumns; ++column) {
        const float x = column_of_block(column); // pixels with an edge of the block or of its shadow are left out
        const bool through = std::abs(x) < 0.5f;
        const bool shadow = x > 2 && x < 2.5f;
        if (!through && !shadow && x > -1.5f && x < 4.1f) continue;
        seen_through += through ? 1 : 0, in_shadow += shadow ? 1 : 0;
        const double way = through ? kBlockDepth : shadow ? kBlockDepth * std::sqrt(2.0) : 0.0;
        for (uint32_t c = 0; c < 3; ++c) {
            const double lit = 0.5 / 3.14159265358979 * block_rate({3, 2, 1}, c) * std::sqrt(0.5);
            const double expected = lit * std::exp(-way * block_rate(test::kBlockAbsorbs, c));
            CAPTURE(x);
            CHECK(test::as_double(picture.at(column, 2)[c]) == doctest::Approx(expected).epsilon(1e-5));
        }
    }
    CHECK(seen_through >= 4);
    CHECK(in_shadow >= 2);
}

TEST_CASE("light scattered once in a block equals the integral along the camera ray on both devices") {
    const Scene scene = sunny_scene({0, -1, 0}, false);
    Queue cpu = Queue::make_cpu(), queue = test::requested_queue();
    PathSettings settings;
    settings.sampler = SamplerKind::Independent;
    const Image picture = render_block<test::kScattering>(queue, scene, settings, 8192);
    CHECK(picture_hash(render_block<test::kScattering>(queue, scene, settings, 8)) ==
          picture_hash(render_block<test::kScattering>(cpu, scene, settings, 8)));
    CHECK(picture.at(2, 2)[0] == 0); // outside the block
    std::vector<uint32_t> within;
    for (uint32_t column = 0; column < kBlockColumns; ++column) {
        if (std::abs(column_of_block(column)) < 0.5f) within.push_back(column);
    }
    for (uint32_t c = 0; c < 3; ++c) {
        uint64_t next = 0;
        const test::Estimate mean = test::estimate(within.size() * kBlockRows, [&] {
            const uint64_t i = next++;
            return test::as_double(picture.at(within[i / kBlockRows], static_cast<uint32_t>(i % kBlockRows))[c]);
        });
        const double scatters = test::as_double(test::kBlockScatters);
        const double extinction = scatters + block_rate(test::kBlockAbsorbs, c);
        const double expected = scatters * block_rate({3, 2, 1}, c) / (4 * 3.14159265358979) *
                                -std::expm1(-2 * extinction * kBlockDepth) / (2 * extinction);
        CAPTURE(expected);
        CHECK(std::abs(mean.mean - expected) < 4 * mean.error);
        CHECK(mean.error < 0.006 * expected);
    }
}
