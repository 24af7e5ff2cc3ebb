// The reconstruction keeps the light of textures of any contrast, and of emitters smaller than a pixel.

#include <doctest/doctest.h>

#include <array>
#include <string>
#include <vector>

#include "formats/read_scene.h"
#include "session/session.h"
#include "tests/support/lit_scenes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

constexpr uint32_t kTexels = 16, kTexelsSide = 48, kShownFrames = 24, kMeanFrames = 8;

/// A wall with a checker of two colours whose fields are three pixels wide, under a uniform sky.
Scene scene_of_texels(std::array<uint8_t, 3> dark) {
    Scene scene;
    TextureImage image;
    image.name = "texels";
    image.rgba8 = {kTexels, kTexels, {}};
    for (uint32_t i = 0; i < kTexels * kTexels; ++i) {
        const bool is_bright = (i / kTexels + i % kTexels) % 2 == 0;
        for (const uint8_t c : dark) image.rgba8.pixels.push_back(is_bright ? 230 : c);
        image.rgba8.pixels.push_back(255);
    }
    scene.images.push_back(image);
    Material wall;
    wall.base_color = {1, 1, 1};
    wall.base_color_texture = {.image = 0, .is_srgb = true};
    scene.materials.push_back(wall);
    scene.meshes.push_back(make_square(1));
    Instance instance;
    instance.mesh = 0, instance.material = 0;
    scene.instances.push_back(instance);
    scene.environment = Environment{.scale = {1, 0.9f, 0.8f}};
    return scene;
}

Camera camera_of_texels() {
    Camera camera;
    camera.projection = Projection::Orthographic;
    camera.ortho_height = 2;
    camera.world_from_camera = look_at({0, -2, 0}, {0, 0, 0}, {0, 0, 1});
    return camera;
}

/// Returns the mean of frames after some that fill the history.
double mean_of_last_frames(Session& session, const ReconstructionSettings& settings) {
    double mean = 0;
    session.cut();
    for (uint32_t k = 0; k < kShownFrames; ++k) {
        session.render_frame(k, settings);
        if (k + kMeanFrames >= kShownFrames) mean += mean_of(session.frame().picture()) / kMeanFrames;
    }
    return mean;
}

} // namespace

TEST_CASE("textures of any contrast keep their light in frames and in denoised pictures") {
    // Linear albedos 0.79 and 0.007; 0.79 and 0; red, whose other channels are black; and a moderate contrast.
    for (const auto& dark : {std::array<uint8_t, 3>{20, 20, 20}, std::array<uint8_t, 3>{0, 0, 0},
                             std::array<uint8_t, 3>{230, 0, 0}, std::array<uint8_t, 3>{120, 120, 120}}) {
        CAPTURE(dark[0]);
        CAPTURE(dark[1]);
        Messages messages;
        const Scene scene = scene_of_texels(dark);
        const PreparedScene prepared = prepare_scene(scene, {}, messages);
        RenderSettings settings;
        settings.width = settings.height = kTexelsSide;
        settings.path.max_depth = 1;
        Queue queue = requested_queue();
        Session session(queue, prepared, camera_of_texels(), settings);
        session.render(64);
        const double expected = mean_of(session.picture());
        CHECK(mean_of_last_frames(session, {}) == doctest::Approx(expected).epsilon(0.01));
        CHECK(mean_of_last_frames(session, {.resolution_scale = 0.5f}) == doctest::Approx(expected).epsilon(0.03));
        settings.samples = 4;
        settings.denoise = Denoise::Svgf;
        const RenderResult denoised = render(queue, scene, camera_of_texels(), settings);
        CHECK(mean_of(denoised.denoised.value()) == doctest::Approx(expected).epsilon(0.01));
    }
}

TEST_CASE("frames at rest keep the light of emitters smaller than a pixel") {
    Messages messages;
    const Scene scene = read_scene("many-lights", {}, messages);
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings;
    settings.width = 64, settings.height = 36;
    Queue queue = requested_queue();
    Session session(queue, prepared, scene.cameras.at(0), settings);
    constexpr uint32_t kSettled = 32, kAfter = 64;
    session.render(kAfter); // the samples of the frames in the mean, so that most of the noise is the same
    const double expected = mean_of(session.picture());
    double mean = 0;
    session.cut();
    for (uint32_t k = 0; k < kSettled + kAfter; ++k) {
        session.render_frame(k < kSettled ? kAfter + k : k - kSettled, {});
        if (k >= kSettled) mean += mean_of(session.frame().picture()) / kAfter;
    }
    MESSAGE("many-lights: ", mean / expected, " of the light");
    // Means clamped to their neighbourhood had 0.49. Frames without any clamping have 0.99.
    CHECK(mean == doctest::Approx(expected).epsilon(0.03));
}
