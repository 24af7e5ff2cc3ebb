// Denoising gives cut peaks back to the pixels around: a room lit through a door's gap keeps its light.

#include <doctest/doctest.h>

#include "formats/read_scene.h"
#include "session/session.h"
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
