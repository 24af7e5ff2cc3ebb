// Several devices make real-time frames together, each a band of rows: whatever the bands, frames have the bytes of one
// device's, with all that the next frame reads. In CI all devices are CPUs; with --device cuda they are the machine's
// GPUs, and CPUs if there are too few.

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <thread>

#include "image/picture_hash.h"
#include "render/update_scene.h"
#include "scene/validate/validate.h"
#include "session/devices/frames_on_devices.h"
#include "session/moving_scene.h"
#include "session/session.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/stop_after.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

RenderSettings settings_of_bands() {
    RenderSettings settings;
    settings.width = 75, settings.height = 58; // neither fills tiles
    settings.path.max_depth = 3;
    return settings;
}

/// A scene with an emitter too bright for a sample, so that there are invalid ones.
Scene scene_of_bands() {
    Scene scene = test::make_mixed_scene();
    scene.materials[5].emission = grey(0x1p41f);
    return scene;
}

/// Spheres of which one moves aside while its vertices move.
Scene stretching_scene() {
    Scene scene = test::make_furnace_scene(0.6f);
    const Mesh ball = scene.meshes[0];
    scene.meshes.assign(2, ball);
    scene.instances.clear();
    scene.nodes.resize(1);
    for (uint32_t i = 0; i < 2; ++i) {
        Instance& instance = scene.instances.emplace_back();
        instance.mesh = i;
        instance.node = i == 0 ? 0 : kNoNode;
        instance.node_from_local = instance.world_from_local = make_translation({1.5f * static_cast<float>(i), 0, 0});
    }
    scene.shapes.push_back({.mesh = 0, .node = 0, .positions = ball.positions, .normals = ball.normals});
    scene.nodes[0].morph_weights = {0};
    MorphTarget& target = scene.shapes[0].targets.emplace_back();
    for (const Vec3 p : ball.positions) target.positions.push_back({0, p.y * p.y, 0.4f * p.x});
    std::vector<AnimationChannel>& channels = scene.animations.emplace_back().channels;
    channels.push_back({0, AnimatedPart::Weights, Interpolation::Linear, {0, 2}, {0, 0.7f}});
    channels.push_back({0, AnimatedPart::Translation, Interpolation::Linear, {0, 2}, {0, 0, 0, -1, 0.5f, 0}});
    Messages messages;
    validate(scene, "stretching", messages);
    return scene;
}

Camera camera_of_stretching() {
    Camera camera;
    camera.world_from_camera = look_at({0.7f, 1, 6}, {0.7f, 0, 0}, {0, 1, 0});
    return camera;
}

Camera turned(Camera camera, uint32_t frame) {
    camera.world_from_camera.translation += (0.04f * static_cast<float>(frame)) * column(camera.world_from_camera, 1);
    return camera;
}

Queue queue_of_band(std::size_t i) {
    if (test::cuda_requested() && static_cast<int>(i) < cuda_device_count())
        return Queue::make_cuda(static_cast<int>(i));
    return Queue::make_cpu(Threads(1));
}

/// Frames by one device or several.
class Bands {
public:
    Bands(std::size_t devices, const PreparedScene& prepared, const Camera& camera, const RenderSettings& settings,
          const FrameHooks& hooks = {}, AfterLoss after_loss = AfterLoss::Throw) {
        for (std::size_t i = 0; i < devices; ++i) queues.push_back(std::make_shared<Queue>(queue_of_band(i)));
        if (devices > 1) together.emplace(queues, prepared, after_loss, hooks);
        session.emplace(*queues.front(), prepared, camera, settings);
        if (together) session->pictures().share_frames(*together);
    }
    bool render(uint32_t number, const ReconstructionSettings& reconstruction = {}, const RestirSettings& restir = {}) {
        return session->render_frame(number, reconstruction, restir, messages);
    }
    std::size_t warnings() const {
        return static_cast<std::size_t>(std::ranges::count(messages.all(), true, &Message::is_warning));
    }

    std::vector<std::shared_ptr<Queue>> queues;
    std::optional<FramesOnDevices> together;
    std::optional<Session> session;
    Messages messages;
};

/// Checks that the last frames are equal, with all that is known of them.
void check_frame(Bands& bands, Bands& alone) {
    Session &a = *bands.session, &b = *alone.session;
    CHECK(picture_hash(a.frame().picture()) == picture_hash(b.frame().picture()));
    const FrameTones tones = a.frames().tones(), expected = b.frames().tones();
    CHECK(tones.scattered.pixels == expected.scattered.pixels);
    CHECK(tones.all.pixels == expected.all.pixels);
    CHECK(a.frames().rays().total() == b.frames().rays().total());
    CHECK(a.frame_result().invalid_samples == b.frame_result().invalid_samples);
}

struct BandsWorld {
    Scene scene = scene_of_bands();
    PreparedScene prepared;
    BandsWorld() {
        Messages messages;
        prepared = prepare_scene(scene, {}, messages);
    }
};

} // namespace

TEST_CASE("bands of rows by two and three devices make the frames of one, with and without ReSTIR") {
    const BandsWorld world;
    const Camera camera = test::mixed_scene_camera();
    const RenderSettings settings = settings_of_bands();
    for (const RestirLight light : {RestirLight::Off, RestirLight::Direct, RestirLight::Indirect}) {
        for (const std::size_t devices : {2u, 3u}) {
            CAPTURE(static_cast<int>(light));
            CAPTURE(devices);
            Bands alone(1, world.prepared, camera, settings), bands(devices, world.prepared, camera, settings);
            for (uint32_t k = 0; k < 5; ++k) {
                for (Bands* const each : {&alone, &bands}) {
                    each->session->set_camera(turned(camera, k));
                    REQUIRE(each->render(k, {}, {.light = light}));
                }
                check_frame(bands, alone);
            }
            CHECK(bands.session->frame_result().invalid_samples > 0);
            CHECK(bands.warnings() == 0);
        }
    }
}

TEST_CASE("bands make the frames of one device with every setting of the reconstruction, and plain diffuse light") {
    Scene plain = test::make_mixed_scene();
    for (Material& material : plain.materials) {
        material.kind = MaterialKind::Diffuse;
        material.alpha_mode = AlphaMode::Opaque;
        material.base_color_texture = material.normal_texture = material.emission_texture = {};
    }
    Messages messages;
    const PreparedScene prepared = prepare_scene(plain, {}, messages);
    const Camera camera = test::mixed_scene_camera();
    ReconstructionSettings half, layers, bare, wide;
    half.resolution_scale = 0.5f;
    layers.keep_layers = true;
    bare.passes = 0, bare.anti_alias = bare.clamp_history = bare.clamp_fireflies = false;
    wide.passes = 7;
    for (const ReconstructionSettings& reconstruction : {half, layers, bare, wide}) {
        CAPTURE(reconstruction.passes);
        CAPTURE(reconstruction.resolution_scale);
        Bands alone(1, prepared, camera, settings_of_bands()), bands(3, prepared, camera, settings_of_bands());
        for (uint32_t k = 0; k < 4; ++k) {
            for (Bands* const each : {&alone, &bands}) {
                each->session->set_camera(turned(camera, k));
                REQUIRE(each->render(k, reconstruction));
            }
            check_frame(bands, alone);
            if (!reconstruction.keep_layers) continue;
            CHECK(bands.session->frame().motion().pixels == alone.session->frame().motion().pixels);
            CHECK(bands.session->frame().deviation().pixels == alone.session->frame().deviation().pixels);
        }
    }
}

TEST_CASE("devices follow a scene that moves and deforms, and light that changes, from frame to frame") {
    const Camera camera = camera_of_stretching();
    Messages messages;
    MovingScene of_alone(stretching_scene(), 0.0, {}, messages), of_bands(stretching_scene(), 0.0, {}, messages);
    Bands alone(1, of_alone.prepared(), camera, settings_of_bands()),
        bands(3, of_bands.prepared(), camera, settings_of_bands());
    const auto check_frames = [&](uint32_t first) {
        for (uint32_t k = first; k < first + 4; ++k) {
            CAPTURE(k);
            const double time_s = 0.2 * k;
            alone.session->update_scene(of_alone.prepared(), of_alone.set_time(time_s, messages));
            bands.session->update_scene(of_bands.prepared(), of_bands.set_time(time_s, messages));
            REQUIRE(alone.render(k, {}, {.light = RestirLight::Direct}));
            REQUIRE(bands.render(k, {}, {.light = RestirLight::Direct}));
            check_frame(bands, alone);
        }
    };
    check_frames(0);
    alone.session->cut(), bands.session->cut();
    check_frames(4);
    alone.session->set_scene(of_alone.prepared()), bands.session->set_scene(of_bands.prepared());
    check_frames(8);

    Scene lit = scene_of_bands();
    PreparedScene prepared = prepare_scene(lit, {}, messages);
    Bands one(1, prepared, test::mixed_scene_camera(), settings_of_bands()),
        two(2, prepared, test::mixed_scene_camera(), settings_of_bands());
    SceneUpdate update;
    update.lights_changed = true;
    for (uint32_t k = 0; k < 5; ++k) {
        for (Light& light : lit.lights) light.intensity = 0.7f * light.intensity;
        prepared = update_scene(prepared, lit, update, messages);
        for (Bands* const each : {&one, &two}) {
            each->session->update_scene(prepared, parts_of(update));
            REQUIRE(each->render(k, {.temporal_gradients = true}));
        }
        check_frame(two, one);
    }
}

TEST_CASE("devices follow cuts and changes of size, depth and ReSTIR between frames, and rows fewer than devices") {
    const BandsWorld world;
    const Camera camera = test::mixed_scene_camera();
    Bands alone(1, world.prepared, camera, settings_of_bands()), bands(3, world.prepared, camera, settings_of_bands());
    uint32_t number = 0;
    const auto check_two_frames = [&](const RestirSettings& restir, const std::function<void(Session&)>& change) {
        change(*alone.session), change(*bands.session);
        for (int k = 0; k < 2; ++k) {
            REQUIRE(alone.render(number, {}, restir));
            REQUIRE(bands.render(number, {}, restir));
            ++number;
            check_frame(bands, alone);
        }
    };
    const auto resized = [](uint32_t width, uint32_t height) {
        return [=](Session& session) {
            RenderSettings settings = session.settings();
            settings.width = width, settings.height = height;
            session.set_settings(settings);
        };
    };
    const auto deeper = [](Session& session) {
        RenderSettings settings = session.settings();
        settings.frame_depth = 1;
        session.set_settings(settings);
    };
    check_two_frames({}, [](Session&) {});
    check_two_frames({.light = RestirLight::Direct}, [](Session& session) { session.cut(); });
    check_two_frames({.light = RestirLight::Direct}, resized(40, 90));
    check_two_frames({.light = RestirLight::Indirect}, resized(33, 9)); // two bands, and one without rows
    check_two_frames({}, deeper);
    check_two_frames({}, resized(64, 1));
    check_two_frames({}, [](Session& session) { session.store_previous(); });
}

namespace {

/// Lets a device fail in one frame.
struct FailingFrame {
    FailingFrame(std::size_t device, int frame, ErrorCode code) : left(frame) {
        hooks.before_frame = [=, this](std::size_t number) {
            if (number == device && left-- == 0) throw Error(code, "a test ends this device");
        };
    }
    FrameHooks hooks;
    std::atomic<int> left;
};

} // namespace

TEST_CASE("a frame in whose middle a device fails is an error, and the next one begins a sequence by the others") {
    const BandsWorld world;
    const Camera camera = test::mixed_scene_camera();
    for (const ErrorCode code : {ErrorCode::DeviceFault, ErrorCode::OutOfMemory}) {
        FailingFrame failing(1, 2, code);
        Bands bands(3, world.prepared, camera, settings_of_bands(), failing.hooks);
        for (uint32_t k = 0; k < 2; ++k) REQUIRE(bands.render(k));
        const auto error = test::thrown_error([&] { bands.render(2); });
        CHECK(test::is_about(error, ErrorCode::DeviceFault, "device"));
        CHECK(bands.warnings() == 1);
        CHECK(bands.together->devices() == 2);
        Bands alone(1, world.prepared, camera, settings_of_bands());
        for (uint32_t k = 3; k < 6; ++k) {
            REQUIRE(alone.render(k));
            REQUIRE(bands.render(k));
            check_frame(bands, alone);
        }
        CHECK(bands.warnings() == 1);
    }
}

TEST_CASE("where a history may be cut, the others make the frame again as the first one of a sequence") {
    const BandsWorld world;
    const Camera camera = test::mixed_scene_camera();
    FailingFrame failing(2, 2, ErrorCode::DeviceFault);
    Bands bands(3, world.prepared, camera, settings_of_bands(), failing.hooks, AfterLoss::Cut);
    Bands alone(1, world.prepared, camera, settings_of_bands());
    for (uint32_t k = 0; k < 5; ++k) {
        REQUIRE(bands.render(k, {}, {.light = RestirLight::Indirect}));
        if (k < 2) continue;
        REQUIRE(alone.render(k, {}, {.light = RestirLight::Indirect}));
        check_frame(bands, alone);
    }
    CHECK(bands.warnings() == 1);
    CHECK(bands.together->devices() == 2);
}

TEST_CASE("a device that fails in the first frame of a sequence costs a warning, and the last one left goes on alone") {
    const BandsWorld world;
    const Camera camera = test::mixed_scene_camera();
    FailingFrame failing(1, 0, ErrorCode::OutOfMemory);
    Bands bands(2, world.prepared, camera, settings_of_bands(), failing.hooks);
    Bands alone(1, world.prepared, camera, settings_of_bands());
    for (uint32_t k = 0; k < 3; ++k) {
        REQUIRE(alone.render(k));
        REQUIRE(bands.render(k));
        check_frame(bands, alone);
    }
    CHECK(bands.warnings() == 1);
    CHECK(bands.together->devices() == 1);
}

TEST_CASE("an error of the caller's device, or one that all devices would meet, is thrown as it is") {
    const BandsWorld world;
    const Camera camera = test::mixed_scene_camera();
    for (const auto& [device, code] : {std::pair(0u, ErrorCode::DeviceFault), std::pair(1u, ErrorCode::BadInput)}) {
        FailingFrame failing(device, 1, code);
        Bands bands(2, world.prepared, camera, settings_of_bands(), failing.hooks);
        REQUIRE(bands.render(0));
        const auto error = test::thrown_error([&] { bands.render(1); });
        REQUIRE(error.has_value());
        CHECK(error->code() == code);
        CHECK(bands.warnings() == 0);
        CHECK(bands.together->devices() == 2);
    }
}

TEST_CASE("a sink stops CPUs in the middle of a frame, and the next one begins a sequence on all of them") {
    if (test::cuda_requested()) return; // a GPU finishes its frame
    const BandsWorld world;
    const Camera camera = test::mixed_scene_camera();
    Bands bands(2, world.prepared, camera, settings_of_bands()), alone(1, world.prepared, camera, settings_of_bands());
    REQUIRE(bands.render(0));
    test::StopAfter stops(0);
    CHECK(!bands.session->render_frame(1, {}, {}, stops));
    for (uint32_t k = 2; k < 4; ++k) {
        REQUIRE(alone.render(k));
        REQUIRE(bands.render(k));
        check_frame(bands, alone);
    }
}

TEST_CASE("bands cover the picture, begin at tiles, and follow the devices' speeds") {
    Queue queues[] = {Queue::make_cpu(), Queue::make_cpu(), Queue::make_cpu()};
    Queue* const all[] = {&queues[0], &queues[1], &queues[2]};
    RowTeam team(all);
    for (int frame = 0; frame < 12; ++frame) {
        team.begin();
        for (const uint32_t height : {1u, 7u, 50u, 1080u, 2160u}) {
            uint32_t row = 0;
            for (std::size_t i = 0; i < 3; ++i) {
                const RowBand rows = team.rows_of(i, height);
                CHECK(rows.first == row);
                CHECK((rows.first % 8 == 0 || rows.first == height));
                row = rows.end;
            }
            CHECK(row == height);
        }
        double seconds[3];
        const double slowness[] = {1, 1, 2}; // the last one takes twice as long for a row
        for (std::size_t i = 0; i < 3; ++i) seconds[i] = slowness[i] * team.rows_of(i, 2160).count();
        if (frame == 0) CHECK(team.rows_of(2, 2160).count() == 720);
        team.end(seconds);
    }
    CHECK(team.rows_of(0, 2160).count() == doctest::Approx(864).epsilon(0.02));
    CHECK(team.rows_of(2, 2160).count() == doctest::Approx(432).epsilon(0.02));
}

TEST_CASE(
    "devices take rows beside their own from the present frame's bands, and all rows from those of the last one") {
    constexpr uint32_t kHeight = 64;
    Queue queues[] = {Queue::make_cpu(), Queue::make_cpu()};
    Queue* const all[] = {&queues[0], &queues[1]};
    RowTeam team(all);
    std::vector<uint32_t> numbers[2];
    const auto make_frame = [&](bool has_last) {
        team.begin();
        const auto make_part = [&](std::size_t device) {
            RowExchange& others = team.member(device);
            std::vector<uint32_t> own(kHeight);
            const RowBand rows = others.own_rows(kHeight);
            for (uint32_t row = rows.first; row < rows.end; ++row) own[row] = row + 1;
            const RowArray last = {numbers[device].data(), sizeof(uint32_t), kHeight};
            others.begin_taking_last(has_last ? std::vector{last} : std::vector<RowArray>());
            others.finish_taking_last();
            for (uint32_t row = 0; has_last && row < kHeight; ++row) CHECK(numbers[device][row] == row + 1);
            others.take({{own.data(), sizeof(uint32_t), kHeight}}, rows.grown(3, kHeight));
            CHECK(others.any(device == 1));
            for (uint32_t row = 0; row < kHeight; ++row) {
                const bool is_near = row + 3 >= rows.first && row < rows.end + 3;
                CHECK(own[row] == (is_near ? row + 1 : 0));
            }
            CHECK(!others.any(false)); // after this the other device has copied its rows
            for (uint32_t row = 0; row < kHeight; ++row) {
                if (row < rows.first || row >= rows.end) own[row] = 0;
            }
            return own;
        };
        std::vector<uint32_t> made[2];
        std::thread other([&] { made[1] = make_part(1); });
        made[0] = make_part(0);
        other.join();
        for (std::size_t i = 0; i < 2; ++i) numbers[i] = made[i];
        const double seconds[] = {1, 3};
        team.end(seconds);
    };
    make_frame(false);
    const RowBand first = team.rows_of(0, kHeight);
    make_frame(true);
    CHECK(team.rows_of(0, kHeight) != first);
}
