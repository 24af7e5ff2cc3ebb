// Denoising gives cut peaks back to the pixels around: a room lit through a door's gap keeps its light. With many
// samples it changes little.

#include <doctest/doctest.h>

#include "formats/read_scene.h"
#include "image/flip.h"
#include "session/session.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;
using namespace pertev::test;

TEST_CASE("a denoised picture has the light of its samples where few of them are lit") {
    Messages messages;
    const Scene scene = read_scene("door", {}, messages);
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Camera camera;
    camera.fov_y = 75 * kPi / 180;
    camera.world_from_camera = look_at({0, 1.5f, 1.9f}, {0, 1.2f, 0}, {0, 1, 0});
    RenderSettings settings;
    settings.width = 160, settings.height = 90;
    settings.denoise = Denoise::Svgf;
    Queue queue = requested_queue();
    Session session(queue, prepared, camera, settings);
    session.render(4);
    const double samples = mean_of(session.picture()), denoised = mean_of(session.denoised().value());
    MESSAGE("door: ", denoised / samples, " of the light");
    CHECK(denoised == doctest::Approx(samples).epsilon(0.015)); // WaveletPass has 0.89 of it
}

TEST_CASE("a denoised picture of few samples keeps the light of lamps smaller than a pixel") {
    Scene scene;
    add(scene, floor_at(0, 4), white(0.2f));
    Material lamp = white(0);
    lamp.emission = {50, 40, 30};
    Mesh lamps;
    constexpr int kRows = 32; // each has an eighth of a pixel's area
    for (int i = 0; i < kRows * kRows; ++i) {
        const auto along = [](int k) { return (static_cast<float>(k) + 0.37f) * 0.125f - 2; };
        const Mesh one = sheet({along(i % kRows), 0.3f, along(i / kRows)}, {0, 0, 0.0055f}, {0.0055f, 0, 0});
        for (const uint32_t index : one.indices)
            lamps.indices.push_back(index + static_cast<uint32_t>(lamps.positions.size()));
        lamps.positions.insert(lamps.positions.end(), one.positions.begin(), one.positions.end());
    }
    add(scene, lamps, lamp);
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    const Camera camera = camera_down({0, 5, 0}, 4);
    RenderSettings settings;
    settings.width = settings.height = 128;
    settings.path.max_depth = 1;
    Queue queue = requested_queue();
    Session all(queue, prepared, camera, settings);
    all.render(128);
    const double expected = mean_of(all.picture());
    settings.denoise = Denoise::Svgf;
    for (const uint32_t samples : {1u, 4u}) {
        Session session(queue, prepared, camera, settings);
        session.render(samples);
        const double denoised = mean_of(session.denoised().value());
        MESSAGE("small lamps: ", denoised / expected, " of the light by ", samples, " samples");
        CHECK(denoised == doctest::Approx(expected).epsilon(0.03)); // far less if emitters without a sample are lost
    }
}

TEST_CASE("the filter of denoised pictures fades as the noise of the samples does") {
    Messages messages;
    const Scene scene = read_scene("cornell-box", {}, messages);
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings;
    settings.width = settings.height = 40;
    settings.path.max_depth = 3;
    settings.denoise = Denoise::Svgf;
    Queue queue = requested_queue();
    Session session(queue, prepared, scene.cameras.front(), settings);
    session.render(16);
    const double few = flip(session.denoised().value(), session.picture()).mean;
    session.render(static_cast<uint32_t>(effort(1024, 4096)) - 16);
    const double many = flip(session.denoised().value(), session.picture()).mean;
    MESSAGE("FLIP between denoised and not: ", few, " with 16 samples, ", many, " with many");
    CHECK(few > 0.02);
    CHECK(many < 0.002);
}
