// Real-time frames as pictures have the same bytes with every schedule and on every device while scene and camera
// move. Their layers are those of the frame's sample, and their memory equals its prediction.

#include <doctest/doctest.h>

#include "formats/gltf/read_gltf.h"
#include "image/picture_hash.h"
#include "render/update_scene.h"
#include "scene/validate/validate.h"
#include "session/frame_range.h"
#include "session/moving_scene.h"
#include "session/session.h"
#include "session/session_bytes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

RenderSettings result_settings() {
    RenderSettings settings;
    settings.width = 60, settings.height = 40;
    settings.path.max_depth = 3;
    return settings;
}

/// The mixed scene, in which a sphere moves aside for a second.
Scene sliding_scene() {
    Scene scene = make_mixed_scene();
    scene.nodes.resize(1);
    scene.instances[0].node = 0;
    scene.instances[0].node_from_local = scene.instances[0].world_from_local;
    scene.animations.emplace_back();
    scene.animations[0].channels.push_back(
        {0, AnimatedPart::Translation, Interpolation::Linear, {0, 1}, {0, 0, 0, 0.5f, 0.25f, 0}});
    Messages messages;
    validate(scene, "sliding", messages);
    return scene;
}

/// Returns the hashes of a sequence's frames. `before` is the number of frames that were rendered with the session
/// before a cut.
std::vector<Hash128> hashes_of_sequence(Queue& queue, const FrameRange& sequence, const RenderSettings& settings,
                                        const RestirSettings& restir, uint32_t before = 0) {
    Messages messages;
    MovingScene moving(sliding_scene(), sequence.time_of(sequence.first), {}, messages);
    Session session(queue, moving.prepared(), mixed_scene_camera(), settings);
    const auto make = [&](uint32_t frame) {
        if (const uint32_t parts = moving.set_time(*sequence.time_of(frame), messages)) {
            session.update_scene(moving.prepared(), parts);
        }
        session.render_frame(FrameRange::sample_of(frame), {}, restir);
    };
    for (uint32_t k = 0; k < before; ++k) make(sequence.first + k);
    make(sequence.first);
    session.cut();
    std::vector<Hash128> hashes;
    for (uint32_t frame = sequence.first; frame <= sequence.last; ++frame) {
        make(frame);
        const RenderResult result = session.frame_result();
        CHECK(picture_hash(result.picture) == picture_hash(session.frame().picture()));
        CHECK(result.rays.camera == session.frames().rays().camera);
        CHECK(result.samples == 1);
        hashes.push_back(picture_hash(result.picture));
    }
    return hashes;
}

} // namespace

TEST_CASE("frames of a moving sequence have the same bytes in every schedule, on every device and after a cut") {
    Queue cpu = Queue::make_cpu();
    const FrameRange sequence = {.first = 3, .last = 7, .fps = 8.0};
    const RenderSettings settings = result_settings();
    RenderSettings wavefront = settings;
    wavefront.body = PathBody::Wavefront;
    wavefront.batch = 700; // paths begin in several rounds
    for (const RestirLight light : {RestirLight::Off, RestirLight::Indirect}) {
        const RestirSettings restir = {.light = light};
        const std::vector<Hash128> expected = hashes_of_sequence(cpu, sequence, settings, restir);
        CHECK(expected[3] != expected[4]);
        CHECK(hashes_of_sequence(cpu, sequence, wavefront, restir) == expected);
        CHECK(hashes_of_sequence(cpu, sequence, settings, restir, 4) == expected);
        // A shorter sequence has the same frames; a sequence that begins later does not.
        const FrameRange shorter = {.first = 3, .last = 5, .fps = 8.0}, later = {.first = 4, .last = 7, .fps = 8.0};
        const std::vector<Hash128> of_shorter = hashes_of_sequence(cpu, shorter, settings, restir);
        CHECK(std::vector<Hash128>(expected.begin(), expected.begin() + 3) == of_shorter);
        CHECK(hashes_of_sequence(cpu, later, settings, restir)[0] != expected[1]);
        if (cuda_requested()) {
            Queue cuda = make_cuda_queue();
            CHECK(hashes_of_sequence(cuda, sequence, settings, restir) == expected);
        }
    }
}

TEST_CASE("layers of a frame come from its own sample, in any order of samples") {
    Messages messages;
    const Scene scene = make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = requested_queue();
    RenderSettings settings = result_settings();
    settings.aovs = kAovAlbedo | kAovDepth | kAovIds;
    Session session(queue, prepared, mixed_scene_camera(), settings);
    constexpr uint32_t kNumber = 5;
    session.render_frame(kNumber, {});
    const RenderResult frame = session.frame_result();
    REQUIRE(frame.layers.size() == 2);
    REQUIRE(frame.ids.size() == std::size_t(60) * 40);
    // Computes the contribution of sample 5 from the films of five and six samples.
    RenderSettings plain = settings_of_frames(settings);
    const auto albedo_of = [&](uint32_t samples) {
        plain.samples = samples;
        return layer_named(session.render_separately(session.camera(), plain), "albedo");
    };
    plain.samples = 1;
    const std::vector<PixelIds> ids = session.render_separately(session.camera(), plain).ids;
    for (std::size_t i = 0; i < ids.size(); ++i) REQUIRE(frame.ids[i].primitive == ids[i].primitive);
    const Image five = albedo_of(kNumber), six = albedo_of(kNumber + 1), &seen = layer_named(frame, "albedo");
    for (std::size_t i = 0; i < seen.pixels.size(); ++i) {
        REQUIRE(seen.pixels[i] == doctest::Approx(6 * six.pixels[i] - 5 * five.pixels[i]).epsilon(1e-4));
    }
    session.render_frame(kNumber + 1, {});
    CHECK(picture_hash(layer_named(session.frame_result(), "albedo")) != picture_hash(seen));
}

TEST_CASE("memory of real-time frames with temporal gradients equals its prediction") {
    Messages messages;
    Scene scene = make_mixed_scene();
    scene.instances.resize(500, scene.instances.back()); // so that their previous positions take considerable memory
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = requested_queue();
    for (const PathBody body : {PathBody::Loop, PathBody::Wavefront}) {
        for (const RestirLight light : {RestirLight::Off, RestirLight::Direct, RestirLight::Indirect}) {
            for (const float scale : {1.0f, 0.5f}) {
                CAPTURE(static_cast<int>(light));
                CAPTURE(scale);
                RenderSettings settings = result_settings();
                settings.body = body;
                const ReconstructionSettings reconstruction = {.resolution_scale = scale};
                Session session(queue, prepared, mixed_scene_camera(), settings);
                for (uint32_t k = 0; k < 3; ++k) { // the third frame compares small pictures of the two previous ones
                    session.update_scene(prepared, kPartLights);
                    session.render_frame(k, reconstruction, {.light = light});
                }
                const std::size_t predicted =
                    predicted_frame_bytes(prepared, settings, reconstruction, {.light = light}, queue.is_cuda());
                CHECK(queue.allocated_bytes() >= predicted);
                CHECK(queue.allocated_bytes() <= predicted + 8192); // a pixel filter's table, the scene's view
            }
        }
    }
}
