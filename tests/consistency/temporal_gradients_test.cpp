// Changing light, and the delay until frames show it.

#include <doctest/doctest.h>

#include <cmath>
#include <utility>

#include "denoise/contacts.h"
#include "denoise/reconstruction.h"
#include "denoise/temporal_gradients_view.h"
#include "image/picture_hash.h"
#include "render/update_scene.h"
#include "session/session.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

/// A scene with only a point light.
Scene emitter_scene() {
    Scene scene = make_mixed_scene();
    scene.environment.reset();
    for (Material& material : scene.materials) material.emission = {0, 0, 0};
    Light emitter;
    emitter.position = {0.5f, 3, 1};
    emitter.intensity = {20, 20, 20};
    scene.lights = {emitter};
    return scene;
}

constexpr uint32_t kStill = 16, kDimming = 6;
constexpr float kStep = 0.8f; // factor of the emitter's light from frame to frame

/// Renders frames under an emitter that is constant, then dims by kStep per frame. The scene is updated before each
/// frame. `has_contacts`: otherwise nothing is above the floor, and pictures are no means of shown ones.
Image last_frame(Queue& queue, bool follows, bool dims, bool has_contacts = true, Hash128* before_dimming = nullptr) {
    Messages messages;
    Scene scene = emitter_scene();
    if (!has_contacts) scene.instances.resize(1);
    PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings;
    settings.width = 64, settings.height = 48;
    settings.path.max_depth = 3;
    Session session(queue, prepared, mixed_scene_camera(), settings);
    SceneUpdate update;
    update.lights_changed = true;
    for (uint32_t k = 0; k < kStill + kDimming; ++k) {
        if (dims && k >= kStill) scene.lights[0].intensity = kStep * scene.lights[0].intensity;
        prepared = update_scene(prepared, scene, update, messages);
        session.update_scene(prepared, parts_of(update));
        session.render_frame(k, {.temporal_gradients = follows, .anti_alias = has_contacts});
        if (before_dimming != nullptr && k + 1 == kStill) *before_dimming = picture_hash(session.frame().picture());
    }
    return session.frame().picture();
}

} // namespace

TEST_CASE("frames follow a dimming emitter from its first frame on") {
    Queue queue = requested_queue();
    const double still = mean_of(last_frame(queue, true, false));
    const double expected = still * std::pow(static_cast<double>(kStep), kDimming);
    CHECK(mean_of(last_frame(queue, true, true)) == doctest::Approx(expected).epsilon(0.05));
    CHECK(mean_of(last_frame(queue, false, true)) > 1.2 * expected); // the change is large enough to be detected
}

namespace {

constexpr Vec3 kEmitterAtLeft = {-3, 2, 1}, kEmitterAtRight = {3, 2, 1};

/// Two emitters, one over each half of the view. The left one is scaled by `left`.
Scene scene_of_two(float left) {
    Scene scene = emitter_scene();
    scene.lights.resize(2, scene.lights[0]);
    scene.lights[0].position = kEmitterAtLeft;
    scene.lights[1].position = kEmitterAtRight;
    scene.lights[0].intensity = left * scene.lights[0].intensity;
    return scene;
}

/// Returns the light of the left and of the right half of a picture.
struct Halves {
    double left = 0, right = 0;
};

Halves halves_of(const Image& picture) {
    Halves halves;
    for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
        const bool is_left = i / 3 % picture.width < picture.width / 2;
        (is_left ? halves.left : halves.right) += static_cast<double>(picture.pixels[i]);
    }
    return halves;
}

/// Returns both halves of the last frame of a sequence in which the left emitter's light changes by `step` per frame.
Halves halves_of_two(Queue& queue, bool follows, float step) {
    Messages messages;
    Scene scene = scene_of_two(1);
    PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings;
    settings.width = 64, settings.height = 48;
    settings.path.max_depth = 3;
    Session session(queue, prepared, mixed_scene_camera(), settings);
    SceneUpdate update;
    update.lights_changed = true;
    for (uint32_t k = 0; k < kStill + kDimming; ++k) {
        if (k >= kStill) scene.lights[0].intensity = step * scene.lights[0].intensity;
        prepared = update_scene(prepared, scene, update, messages);
        session.update_scene(prepared, parts_of(update));
        session.render_frame(k, {.temporal_gradients = follows});
    }
    return halves_of(session.frame().picture());
}

} // namespace

TEST_CASE("with two emitters, frames follow the loss of the dimming one and part of the gain of the brightening one") {
    Queue queue = requested_queue();
    const auto reference = [&](float left) {
        RenderSettings settings;
        settings.width = 64, settings.height = 48;
        settings.path.max_depth = 3;
        settings.samples = 256;
        return halves_of(render(queue, scene_of_two(left), mixed_scene_camera(), settings).picture);
    };
    for (const bool dims : {true, false}) {
        CAPTURE(dims);
        const float step = dims ? kStep : 1 / kStep;
        const Halves expected = reference(std::pow(step, static_cast<float>(kDimming)));
        const Halves followed = halves_of_two(queue, true, step), late = halves_of_two(queue, false, step);
        MESSAGE("left ", expected.left, ": ", followed.left, ", late ", late.left, "; right ", expected.right, ": ",
                followed.right, ", late ", late.right);
        // The fraction of the way from delayed to correct. The emitters' shares change, so the same numbers
        // occasionally select the other one.
        const double followed_share = (followed.left - late.left) / (expected.left - late.left);
        CHECK(followed_share > (dims ? 0.7 : 0.4));
        CHECK(followed_share < 1.1);
        // Pixels that the unchanged emitter lights.
        CHECK(followed.right > (dims ? 0.85 * expected.right : late.right));
        CHECK(followed.right < 1.05 * expected.right);
    }
}

namespace {

/// Renders six frames under an emitter that dims with each, and calls `look` with the session after each.
template <class Look>
Hash128 dimming_frames(Queue& queue, uint32_t width, uint32_t height, const ReconstructionSettings& frames,
                       const Look& look) {
    Messages messages;
    Scene scene = emitter_scene();
    PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings;
    settings.width = width, settings.height = height;
    Session session(queue, prepared, mixed_scene_camera(), settings);
    SceneUpdate update;
    update.lights_changed = true;
    for (uint32_t k = 0; k < 6; ++k) {
        scene.lights[0].intensity = kStep * scene.lights[0].intensity;
        prepared = update_scene(prepared, scene, update, messages);
        session.update_scene(prepared, parts_of(update));
        session.render_frame(k, frames);
        look(session);
    }
    return picture_hash(session.frame().picture());
}

} // namespace

TEST_CASE("temporal gradients reuse the reconstruction's memory") {
    Queue queue = requested_queue();
    for (const auto& [width, height] : {std::pair(1u, 1u), std::pair(1u, 9u), std::pair(5u, 3u), std::pair(64u, 48u)}) {
        CAPTURE(width);
        CAPTURE(height);
        const std::size_t pixels = std::size_t(width) * height, small = TemporalGradientsMemory::pixels(width, height);
        const Reconstruction frames(queue, width, height);
        const TemporalGradientsMemory memory = frames.gradients_memory();
        const auto apart = static_cast<std::size_t>(memory.numbers - memory.after);
        CHECK(apart >= TemporalGradientsMemory::kPicture * small);
        CHECK(apart >= 2 * pixels); // the frame's own signals
    }
    const auto bytes = [](uint32_t width, uint32_t height) {
        Queue dry = Queue::make_dry_run(false);
        const Reconstruction frames(dry, width, height);
        return dry.allocated_bytes();
    };
    CHECK(bytes(1920, 1080) == std::size_t(248) * 1920 * 1080);
    // A pixel has its histories, 7 and 5 values of the small pictures, the squares, and another 7 values.
    CHECK(bytes(1, 1) == (10 + 7 + 5 + 1 + 7) * sizeof(Float4));

    const auto held_by_frames = [&](bool follows) {
        std::size_t held = 0;
        dimming_frames(queue, 64, 48, {.temporal_gradients = follows},
                       [&](Session&) { held = queue.allocated_bytes(); });
        return held;
    };
    Queue dry = Queue::make_dry_run(false);
    const ContactFinder contacts(dry, 64, 48); // has memory of its own, because its rays are traced beside the frame
    CHECK(held_by_frames(true) == held_by_frames(false) + dry.allocated_bytes());
}

TEST_CASE("a frame rendered separately does not change the following frames") {
    Queue queue = requested_queue();
    const auto frames = [&](float scale, bool looks) {
        const ReconstructionSettings settings = {
            .temporal_gradients = true, .keep_layers = true, .resolution_scale = scale};
        return dimming_frames(queue, 33, 17, settings, [&](Session& session) {
            if (!looks) return;
            session.frames().tones();
            session.frame().display(ToneMap::Agx, 0);
            session.frame().motion();
        });
    };
    for (const float scale : {1.0f, 0.5f}) CHECK(frames(scale, true) == frames(scale, false));
}

TEST_CASE("temporal gradients do not change frames of constant light where there are no contacts") {
    Queue queue = requested_queue();
    Hash128 with, without;
    CHECK(mean_of(last_frame(queue, true, false, false, &with)) > 0);
    last_frame(queue, false, false, false, &without);
    CHECK(with == without);
}

TEST_CASE("frames of a dimming emitter have the same bytes on every device") {
    if (!cuda_requested()) return;
    Queue cpu = Queue::make_cpu(), cuda = make_cuda_queue();
    CHECK(picture_hash(last_frame(cpu, true, true)) == picture_hash(last_frame(cuda, true, true)));
}

TEST_CASE("a mean follows light by its ratio and never rises by more than the difference") {
    CHECK(followed(4, 2, 1) == 2);    // light is half as bright
    CHECK(followed(1, 2, 3) == 1.5f); // is darker than its surroundings
    CHECK(followed(4, 2, 3) == 5);    // brighter
    CHECK(followed(0.5f, 0, 2) == 2.5f);
    CHECK(followed(0.5f, 0, 0) == 0.5f);
    CHECK(followed(3, 2, 0) == 0);
    CHECK(frames_in_change(32, 1, 1) == 32);
    CHECK(frames_in_change(32, 1, 0.9f) < 5);
    CHECK(frames_in_change(32, 0, 1) == 1);
    CHECK(frames_in_change(32, 0, 0) == 32);
}

TEST_CASE("a temporal gradient is taken from a nearby pixel of the same object and a similar normal") {
    constexpr uint32_t kWidth = 3, kHeight = 2;
    std::vector<Float4> guide(kWidth * kHeight, pack({{0, 0, 1}, 1, 2, 7})), was(guide.size(), Float4{2, 2, 2, 1}),
        is(guide.size(), Float4{1, 1, 1, 3});
    is[1] = {4, 4, 4, 3};
    guide[1] = pack({{0, 0, 1}, 1, 2, 8});
    const TemporalGradientsView change = {guide.data(), was.data(), is.data(), nullptr, kWidth, kHeight, 0.25f, 0.25f};
    const LightStep step = light_step(change, {4, 4}, {0, 0, 1}, 7); // between all four pixels on the left
    CHECK(step.was.r == doctest::Approx(2));
    CHECK(step.is.r == doctest::Approx(1));
    CHECK(step.gloss_is == doctest::Approx(3));
    CHECK(light_step(change, {4, 4}, {0, 0, 1}, 8).is.r == doctest::Approx(4));
    CHECK(light_step(change, {4, 4}, {0, 0, 1}, 9).is.r == 0); // another object
    CHECK(light_step(change, {4, 4}, {1, 0, 0}, 7).is.r == 0); // the normal faces away
    CHECK(light_step(change, {-40, 4}, {0, 0, 1}, 7).is.r == 0);
    CHECK(light_step(change, {kInfinity, 1e30f}, {0, 0, 1}, 7).was.r == 0);
}
