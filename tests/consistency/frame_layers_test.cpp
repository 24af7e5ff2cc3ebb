// Data that accompanies a frame's picture: block means for the exposure (denoise/sum_blocks.h,
// session/adaptive_exposure.h), and layers of the reconstruction (denoise/keep_layers.h). They are equal on both
// devices.

#include <doctest/doctest.h>

#include <cmath>

#include "image/auto_exposure.h"
#include "image/picture_hash.h"
#include "session/adaptive_exposure.h"
#include "session/session.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

RenderSettings layer_settings() {
    RenderSettings settings;
    settings.width = 200, settings.height = 128; // blocks of 5 pixels, of which the last row is incomplete
    settings.path.max_depth = 3;
    return settings;
}

struct SeenLayers {
    Hash128 picture, scattered, all, motion, deviation;
    float stops = 0;
    bool operator==(const SeenLayers&) const = default;
};

/// Returns the layers of the last of ten frames of a camera that moves sideways.
SeenLayers look_at_frames(Queue& queue) {
    Messages messages;
    const Scene scene = make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Camera camera = mixed_scene_camera();
    Session session(queue, prepared, camera, layer_settings());
    AdaptiveExposure exposure;
    for (uint32_t k = 0; k < 10; ++k) {
        camera.world_from_camera.translation += 0.01f * column(camera.world_from_camera, 0);
        session.set_camera(camera);
        session.render_frame(k, {.keep_layers = true});
        exposure.next(session.frames().tones(), ToneMap::Agx);
    }
    const FrameTones tones = session.frames().tones();
    return {picture_hash(session.frame().picture()),
            picture_hash(tones.scattered),
            picture_hash(tones.all),
            picture_hash(session.frame().motion()),
            picture_hash(session.frame().deviation()),
            exposure.stops()};
}

} // namespace

TEST_CASE("tones, layers and the adapted exposure are the same on every device") {
    Queue cpu = Queue::make_cpu();
    const SeenLayers expected = look_at_frames(cpu);
    CHECK(look_at_frames(cpu) == expected);
    if (cuda_requested()) {
        Queue cuda = make_cuda_queue();
        CHECK(look_at_frames(cuda) == expected);
    }
}

TEST_CASE("tones are the means of the displayed picture, and visible emitters do not count as scattered light") {
    Messages messages;
    const Scene scene = make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = Queue::make_cpu();
    Session session(queue, prepared, mixed_scene_camera(), layer_settings());
    for (uint32_t k = 0; k < 3; ++k) session.render_frame(k, {});
    const Image picture = session.frame().picture();
    const FrameTones tones = session.frames().tones();
    REQUIRE(tones.all.width == 40);
    REQUIRE(tones.all.height == 26); // 128 / 5, and the rest
    for (const uint32_t block : {0u, 41u, 25 * 40 + 7u}) {
        const uint32_t left = 5 * (block % 40), top = 5 * (block / 40), bottom = min(top + 5, picture.height);
        double sum = 0;
        for (uint32_t y = top; y < bottom; ++y) {
            for (uint32_t x = left; x < left + 5; ++x) sum += static_cast<double>(picture.at(x, y)[1]);
        }
        CHECK(tones.all.pixels[3 * block + 1] == doctest::Approx(sum / (5 * (bottom - top))).epsilon(1e-4));
    }
    double some = 0;
    for (std::size_t i = 0; i < tones.all.pixels.size() / 3; ++i) {
        const float share = tones.scattered.pixels[4 * i + 3];
        CHECK(share >= 0);
        CHECK(share <= 1);
        CHECK(tones.scattered.pixels[4 * i + 1] <= tones.all.pixels[3 * i + 1] * 1.0001f + 1e-6f);
        some += static_cast<double>(share);
    }
    CHECK(some > 0.1 * 40 * 26);
    Session dark(queue, prepared, mixed_scene_camera(), [] {
        RenderSettings settings = layer_settings();
        settings.path.max_depth = 0; // only emitters
        return settings;
    }());
    dark.render_frame(0, {});
    const FrameTones of_dark = dark.frames().tones();
    for (std::size_t i = 3; i < of_dark.scattered.pixels.size(); i += 4) {
        const float* block = &of_dark.scattered.pixels[i - 3];
        CHECK(block[0] + block[1] + block[2] == 0);
        if (i > 400) break;
    }
}

TEST_CASE("the exposure approaches the metered one and is 1/e of the difference away after 16 frames") {
    FrameTones tones = {{4, 4, 4, {}}, {4, 4, 3, {}}};
    for (int i = 0; i < 16; ++i) {
        tones.scattered.pixels.insert(tones.scattered.pixels.end(), {0.01f, 0.01f, 0.01f, 1});
        tones.all.pixels.insert(tones.all.pixels.end(), {9, 9, 9}); // the mean includes the sky
    }
    const float goal = auto_exposure_stops(tones.scattered, ToneMap::Agx);
    CHECK(goal > 3);
    AdaptiveExposure exposure;
    exposure.set(goal - 4);
    for (int k = 0; k < 16; ++k) exposure.next(tones, ToneMap::Agx);
    CHECK(goal - exposure.stops() == doctest::Approx(4 / std::exp(1.0)).epsilon(1e-3));
    for (int k = 0; k < 200; ++k) exposure.next(tones, ToneMap::Agx);
    CHECK(exposure.stops() == doctest::Approx(goal).epsilon(1e-3));
    // Emitters and sky count if nothing else is visible.
    for (float& value : tones.scattered.pixels) value = 0;
    for (int k = 0; k < 300; ++k) exposure.next(tones, ToneMap::Agx);
    CHECK(exposure.stops() == doctest::Approx(auto_exposure_stops(tones.all, ToneMap::Agx)).epsilon(1e-2));
}

TEST_CASE("the motion layer holds the motion of each pixel's surface, and layers do not change the frame") {
    Messages messages;
    const Scene scene = make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = Queue::make_cpu();
    const Camera first = mixed_scene_camera();
    Camera second = first;
    second.fov_y *= 0.9f; // everything moves away from the centre
    Session session(queue, prepared, first, layer_settings()), plain(queue, prepared, first, layer_settings());
    session.render_frame(0, {.keep_layers = true});
    for (const float x : session.frame().motion().pixels) CHECK(x == 0); // there was no previous frame
    for (Session* each : {&session, &plain}) {
        if (each == &plain) plain.render_frame(0, {});
        each->set_camera(second);
        each->render_frame(1, {.keep_layers = each == &session});
    }
    CHECK(picture_hash(session.frame().picture()) == picture_hash(plain.frame().picture()));
    const Image motion = session.frame().motion();
    const float growth = tan(0.5f * first.fov_y) / tan(0.5f * second.fov_y);
    for (const uint32_t x : {20u, 100u, 180u}) {
        const float from_middle = static_cast<float>(x) + 0.5f - 100;
        const float* moved = motion.at(x, 30);
        CHECK(moved[0] == doctest::Approx(from_middle * (1 - 1 / growth)).epsilon(0.02));
        CHECK(moved[1] == doctest::Approx((30.5f - 64) * (1 - 1 / growth)).epsilon(0.02));
    }
    float least = 1e30f;
    for (const float d : session.frame().deviation().pixels) {
        CHECK(d >= 0);
        least = min(least, d);
    }
    CHECK(least < 1000);
}
