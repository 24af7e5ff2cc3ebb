// Denoised frames with a history have the same bytes in every schedule, on every device, after a cut and after a
// checkpoint. Their films are those of their own samples.

#include <doctest/doctest.h>

#include "image/picture_hash.h"
#include "scene/validate/validate.h"
#include "session/devices/session_on_devices.h"
#include "session/moving_scene.h"
#include "session/session_bytes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

constexpr uint32_t kDenoisedSamples = 2;

RenderSettings settings_of_history() {
    RenderSettings settings;
    settings.width = 60, settings.height = 40;
    settings.path.max_depth = 3;
    settings.samples = kDenoisedSamples;
    settings.denoise = Denoise::Svgf;
    settings.history = 8;
    return settings;
}

Scene scene_of_history() {
    Scene scene = make_mixed_scene();
    scene.nodes.resize(1);
    scene.instances[0].node = 0;
    scene.instances[0].node_from_local = scene.instances[0].world_from_local;
    scene.animations.emplace_back().channels.push_back(
        {0, AnimatedPart::Translation, Interpolation::Linear, {0, 1}, {0, 0, 0, 0.5f, 0.25f, 0}});
    Messages messages;
    validate(scene, "sliding", messages);
    return scene;
}

/// A sequence on devices of these kinds, whose camera moves too.
class DenoisedSequence {
public:
    DenoisedSequence(std::vector<std::shared_ptr<Queue>> queues, const RenderSettings& settings)
        : queues_(std::move(queues)), settings_(settings),
          opened_(std::in_place, queues_, moving_.prepared(), mixed_scene_camera(), settings,
                  SharedWork{.pictures = true, .frames = false}) {}

    Session& session() { return opened_->session(); }
    void seek(uint32_t frame) {
        if (const uint32_t parts = moving_.set_time(0.125 * frame, messages_))
            session().update_scene(moving_.prepared(), parts);
        Camera camera = mixed_scene_camera();
        camera.world_from_camera.translation.x += 0.03f * static_cast<float>(frame);
        session().set_camera(camera);
    }
    /// Renders a frame by calls with so many samples.
    Hash128 render(uint32_t frame, std::initializer_list<uint32_t> parts = {kDenoisedSamples}) {
        seek(frame);
        uint32_t next = frame * kDenoisedSamples;
        for (const uint32_t count : parts) {
            REQUIRE(session().render(SampleRange{next, next + count}) == count);
            next += count;
        }
        const RenderResult result = session().result();
        film = picture_hash(result.picture);
        return picture_hash(result.denoised.value());
    }
    std::vector<Hash128> render_all(uint32_t first, uint32_t last) {
        std::vector<Hash128> hashes;
        for (uint32_t frame = first; frame <= last; ++frame) hashes.push_back(render(frame));
        return hashes;
    }

    Hash128 film = {}; // that of the last frame

private:
    Messages messages_;
    MovingScene moving_{scene_of_history(), 0.0, {}, messages_};
    std::vector<std::shared_ptr<Queue>> queues_;
    RenderSettings settings_;
    std::optional<SessionOnDevices> opened_;
};

std::vector<std::shared_ptr<Queue>> cpus(std::size_t count) {
    std::vector<std::shared_ptr<Queue>> queues;
    for (std::size_t i = 0; i < count; ++i) queues.push_back(std::make_shared<Queue>(Queue::make_cpu(Threads(1))));
    return queues;
}

} // namespace

TEST_CASE("denoised frames with a history have the same bytes in every schedule, in parts and on every device") {
    const RenderSettings settings = settings_of_history();
    const std::vector<Hash128> expected = DenoisedSequence(cpus(1), settings).render_all(0, 3);
    RenderSettings wavefront = settings;
    wavefront.body = PathBody::Wavefront;
    wavefront.batch = 700; // paths begin in several rounds
    CHECK(DenoisedSequence(cpus(1), wavefront).render_all(0, 3) == expected);
    CHECK(DenoisedSequence(cpus(2), settings).render_all(0, 3) == expected);
    DenoisedSequence in_parts(cpus(1), settings);
    for (uint32_t frame = 0; frame <= 3; ++frame) CHECK(in_parts.render(frame, {1, 1}) == expected[frame]);
    in_parts.session().cut();
    CHECK(in_parts.render_all(0, 1) == std::vector(expected.begin(), expected.begin() + 2));
    if (cuda_requested()) {
        const auto cuda = std::make_shared<Queue>(make_cuda_queue());
        CHECK(DenoisedSequence({cuda}, settings).render_all(0, 3) == expected);
        CHECK(DenoisedSequence({cpus(1).front(), cuda}, settings).render_all(0, 3) == expected);
    }
}

TEST_CASE("a history changes denoised frames but the first, and no film") {
    const RenderSettings settings = settings_of_history();
    RenderSettings alone = settings;
    alone.history = 0;
    DenoisedSequence frames(cpus(1), settings), single(cpus(1), alone);
    for (uint32_t frame = 0; frame <= 2; ++frame) {
        const bool is_same = frames.render(frame) == single.render(frame);
        CHECK(is_same == (frame == 0));
        CHECK(frames.film == single.film);
    }
    frames.session().cut();
    CHECK(frames.render(3) == single.render(3)); // it is the first again
    RenderSettings of_one = settings;
    of_one.history = 1; // the frame's own light
    CHECK(DenoisedSequence(cpus(1), of_one).render_all(0, 2) == DenoisedSequence(cpus(1), alone).render_all(0, 2));
}

TEST_CASE("denoised frames go on from a history that was kept, on one device or several") {
    const RenderSettings settings = settings_of_history();
    DenoisedSequence whole(cpus(1), settings);
    const std::vector<Hash128> expected = whole.render_all(0, 4);
    for (const std::size_t devices : {std::size_t(1), std::size_t(2)}) {
        DenoisedSequence first(cpus(1), settings), second(cpus(devices), settings);
        CHECK(!first.session().film_render().has_history());
        first.render_all(0, 2);
        REQUIRE(first.session().film_render().has_history());
        FrameHistory history = first.session().film_render().history();
        second.seek(2);
        history.camera = second.session().camera();
        second.session().film_render().restore(history);
        CHECK(second.render_all(3, 4) == std::vector(expected.begin() + 3, expected.end()));
        history.arrays.front().pop_back();
        CHECK_THROWS_WITH(second.session().film_render().restore(history),
                          doctest::Contains("does not fit these settings"));
    }
}

TEST_CASE("memory of denoised frames with a history equals its prediction") {
    Messages messages;
    const Scene scene = scene_of_history();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = requested_queue();
    const auto bytes_of = [&](const RenderSettings& settings) {
        Session session(queue, prepared, mixed_scene_camera(), settings);
        session.render(kDenoisedSamples);
        return queue.allocated_bytes();
    };
    const RenderSettings settings = settings_of_history();
    RenderSettings alone = settings;
    alone.history = 0;
    const std::size_t places = prepared.scene->instances.size() * sizeof(InstanceView); // where they were before
    CHECK(bytes_of(settings) - bytes_of(alone) + places ==
          predicted_bytes(prepared, settings, queue.is_cuda()) - predicted_bytes(prepared, alone, queue.is_cuda()));
    CHECK(bytes_of(settings) - bytes_of(alone) == std::size_t(104) * settings.width * settings.height);
}
