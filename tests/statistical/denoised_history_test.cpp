// The history of denoised frames: in a scene at rest it lowers noise and keeps the light; where light changes it does
// not stay.

#include <doctest/doctest.h>

#include <cmath>

#include "formats/read_scene.h"
#include "render/update_scene.h"
#include "session/session.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

constexpr uint32_t kSamplesWithHistory = 4;

RenderSettings settings_with_history(uint32_t history) {
    RenderSettings settings = square_settings(64, kSamplesWithHistory, 4);
    settings.denoise = Denoise::Svgf;
    settings.history = history;
    return settings;
}

Camera camera_of_box() {
    Camera camera;
    camera.fov_y = 0.7f;
    camera.world_from_camera = look_at({0, 1, 3.8f}, {0, 1, 0}, {0, 1, 0});
    return camera;
}

/// Mean over pixels of the squared difference, relative to the reference.
double error_of(const Image& picture, const Image& reference) {
    double sum = 0;
    for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
        const double r = static_cast<double>(reference.pixels[i]), d = static_cast<double>(picture.pixels[i]) - r;
        sum += d * d / (r * r + 0.01);
    }
    return sum / static_cast<double>(picture.pixels.size());
}

} // namespace

TEST_CASE("the history of denoised frames lowers the noise of a scene at rest and keeps its light") {
    Messages messages;
    const Scene scene = read_scene("cornell-box", {}, messages);
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    const Camera camera = scene.cameras.empty() ? camera_of_box() : scene.cameras.front();
    Queue queue = requested_queue();
    Session all(queue, prepared, camera, square_settings(64, effort(512, 16384), 4));
    all.render(all.settings().samples);
    const Image reference = all.picture();
    Session session(queue, prepared, camera, settings_with_history(32));
    const uint32_t frames = effort(24, 96);
    double first = 0, light = 0, error = 0;
    for (uint32_t frame = 0; frame < frames; ++frame) {
        session.update_scene(prepared, 0); // the next frame
        session.render(SampleRange{frame * kSamplesWithHistory, (frame + 1) * kSamplesWithHistory});
        const Image denoised = session.denoised().value();
        if (frame == 0) first = error_of(denoised, reference);
        if (frame + 8 >= frames) error += error_of(denoised, reference) / 8, light += mean_of(denoised) / 8;
    }
    MESSAGE("error ", first, " of the first frame, ", error, " of the last ones; light ", light / mean_of(reference));
    CHECK(error < 0.5 * first);
    CHECK(light == doctest::Approx(mean_of(reference)).epsilon(0.005));
}

TEST_CASE("light that dims or grows at once does not stay as it was in denoised frames") {
    for (const float step : {0.25f, 4.0f}) {
        Messages messages;
        Scene scene = make_furnace_scene(0.5f); // a sphere under one light
        scene.environment.reset();
        Light emitter;
        emitter.position = {1, 2, 3};
        emitter.intensity = {20, 20, 20};
        scene.lights = {emitter};
        PreparedScene prepared = prepare_scene(scene, {}, messages);
        Queue queue = requested_queue();
        Camera camera;
        camera.world_from_camera = make_translation({0, 0, 4});
        Session session(queue, prepared, camera, settings_with_history(32));
        SceneUpdate update;
        update.lights_changed = true;
        const auto light_of = [&](uint32_t frame) {
            prepared = update_scene(prepared, scene, update, messages);
            session.update_scene(prepared, parts_of(update));
            session.render(SampleRange{frame * kSamplesWithHistory, (frame + 1) * kSamplesWithHistory});
            return mean_of(session.denoised().value()) / mean_of(session.picture());
        };
        for (uint32_t frame = 0; frame < 8; ++frame) light_of(frame);
        scene.lights[0].intensity = step * scene.lights[0].intensity;
        const double after = light_of(8);
        MESSAGE(after, " of the light after a change to ", step);
        CHECK(after == doctest::Approx(1).epsilon(0.03));
    }
}

TEST_CASE("the history of denoised frames moves with things") {
    Messages messages;
    Scene scene = make_mixed_scene();
    PreparedScene prepared = prepare_scene(scene, {.apart = std::vector<bool>(scene.instances.size(), true)}, messages);
    Queue queue = requested_queue();
    Camera camera = mixed_scene_camera();
    Session session(queue, prepared, camera, settings_with_history(32)),
        other(queue, prepared, camera, settings_with_history(0));
    const Vec3 start = scene.instances[0].world_from_local.translation;
    const uint32_t frames = 8;
    Image with, without;
    for (uint32_t frame = 0; frame < frames; ++frame) {
        scene.instances[0].world_from_local.translation = start + Vec3{0.04f * static_cast<float>(frame), 0, 0};
        SceneUpdate update;
        update.moved_instances = {0};
        prepared = update_scene(prepared, scene, update, messages);
        const SampleRange range = {frame * kSamplesWithHistory, (frame + 1) * kSamplesWithHistory};
        for (Session* const one : {&session, &other}) {
            one->update_scene(prepared, parts_of(update));
            one->render(range);
            (one == &session ? with : without) = one->denoised().value();
        }
    }
    RenderSettings plain = settings_with_history(0);
    plain.denoise = Denoise::None;
    plain.aovs = kAovIds;
    plain.path.seed = 5;
    Session all(queue, prepared, camera, plain);
    all.render(static_cast<uint32_t>(effort(512, 8192)));
    const RenderResult reference = all.result();
    double error[2] = {0, 0};
    for (std::size_t i = 0; i < reference.ids.size(); ++i) {
        if (reference.ids[i].instance != 0) continue; // the thing's own pixels
        for (std::size_t c = 3 * i; c < 3 * i + 3; ++c) {
            const auto off = [&](const Image& picture) {
                return static_cast<double>(picture.pixels[c] - reference.picture.pixels[c]);
            };
            error[0] += off(with) * off(with), error[1] += off(without) * off(without);
        }
    }
    MESSAGE("error of a thing that moves, relative to that without history: ", error[0] / error[1]);
    CHECK(error[1] > 0);
    CHECK(error[0] < 0.9 * error[1]);
}
