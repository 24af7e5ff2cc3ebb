// Real-time frames have the same bytes on both devices and with both schedules of the path tracer, independent of
// anything before the last cut. The parts of a noisy frame add up to its radiance.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "image/picture_hash.h"
#include "render/update_scene.h"
#include "session/session.h"
#include "tests/support/layered_balls.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

constexpr uint32_t kFrames = 30;

RenderSettings settings_of_frames() {
    RenderSettings settings;
    settings.width = 72, settings.height = 48;
    settings.path.max_depth = 4;
    return settings;
}

Camera moved(Camera camera, uint32_t frame) {
    camera.world_from_camera.translation += (0.01f * static_cast<float>(frame)) * column(camera.world_from_camera, 0);
    return camera;
}

/// Returns the hash of the last of `frames` frames that begin with `first`.
Hash128 hash_of_frames(Session& session, const Camera& camera, uint32_t frames, const ReconstructionSettings& settings,
                       const RestirSettings& restir = {}) {
    for (uint32_t k = 0; k < frames; ++k) {
        session.set_camera(moved(camera, k));
        session.render_frame(k, settings, restir);
    }
    return picture_hash(session.frame().picture());
}

struct Scenes {
    Scene scene;
    Camera camera;
};

constexpr uint32_t kRestirFrames = 6;

Scenes diffuse_scene() {
    Scenes result = {make_mixed_scene(), mixed_scene_camera()};
    for (Material& material : result.scene.materials) material.kind = MaterialKind::Diffuse;
    return result;
}

/// A scene whose bounces the CPU's loop shades in lanes.
Scenes plain_scene() {
    Scenes result = diffuse_scene();
    for (Material& material : result.scene.materials) {
        material.alpha_mode = AlphaMode::Opaque;
        material.base_color_texture = material.normal_texture = material.emission_texture = {};
    }
    return result;
}

std::vector<Scenes> scenes() { return {{make_mixed_scene(), mixed_scene_camera()}, plain_scene()}; }

} // namespace

TEST_CASE("frame 30 has the same bytes on every device, in every schedule and batch size, and after a cut") {
    for (const Scenes& s : scenes()) {
        Messages messages;
        const PreparedScene prepared = prepare_scene(s.scene, {}, messages);
        const RenderSettings settings = settings_of_frames();
        Queue cpu = Queue::make_cpu();
        Session session(cpu, prepared, s.camera, settings);
        const Hash128 expected = hash_of_frames(session, s.camera, kFrames, {});
        session.cut();
        CHECK(hash_of_frames(session, s.camera, kFrames, {}) == expected);

        RenderSettings wavefront = settings;
        wavefront.body = PathBody::Wavefront;
        wavefront.batch = 600; // paths begin in several rounds
        Session other(cpu, prepared, s.camera, wavefront);
        other.render(1); // the film is separate
        CHECK(hash_of_frames(other, s.camera, kFrames, {}) == expected);

        ReconstructionSettings fewer;
        fewer.passes = 1;
        session.cut();
        const Hash128 of_two = hash_of_frames(session, s.camera, 2, {});
        session.cut();
        CHECK(hash_of_frames(session, s.camera, 2, fewer) != of_two);

        if (cuda_requested()) {
            Queue cuda = make_cuda_queue();
            Session there(cuda, prepared, s.camera, settings);
            CHECK(hash_of_frames(there, s.camera, kFrames, {}) == expected);
        }
    }
}

TEST_CASE("a change of size or scene restarts the history, and so does changing it back") {
    Messages messages;
    const Scene scene = make_mixed_scene();
    const Scenes other = diffuse_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages),
                        other_prepared = prepare_scene(other.scene, {}, messages);
    const Camera camera = mixed_scene_camera();
    RenderSettings smaller = settings_of_frames();
    smaller.width = 56, smaller.height = 40;
    constexpr uint32_t kFew = 5;
    Queue queue = requested_queue();
    const auto hash_of_new_session = [&](const PreparedScene& of, const RenderSettings& settings) {
        Session session(queue, of, camera, settings);
        return hash_of_frames(session, camera, kFew, {});
    };
    const Hash128 expected = hash_of_new_session(prepared, settings_of_frames()),
                  of_smaller = hash_of_new_session(prepared, smaller),
                  of_other = hash_of_new_session(other_prepared, settings_of_frames());
    CHECK(expected != of_other);
    Session session(queue, prepared, camera, settings_of_frames());
    CHECK(hash_of_frames(session, camera, kFew, {}) == expected);
    session.set_settings(smaller);
    CHECK(hash_of_frames(session, camera, kFew, {}) == of_smaller);
    session.set_settings(settings_of_frames());
    CHECK(hash_of_frames(session, camera, kFew, {}) == expected);
    session.set_scene(other_prepared);
    CHECK(hash_of_frames(session, camera, kFew, {}) == of_other);
    session.set_scene(prepared);
    CHECK(hash_of_frames(session, camera, kFew, {}) == expected);
}

namespace {

/// Renders ten frames in which the first instance that is not baked moves aside.
Hash128 hash_of_motion(Queue& queue, const RenderSettings& settings, bool moves, const RestirSettings& restir = {}) {
    Messages messages;
    Scene scene = make_mixed_scene();
    PreparedScene prepared = prepare_scene(scene, {}, messages);
    const auto free = std::ranges::find(prepared.is_baked, false);
    REQUIRE(free != prepared.is_baked.end());
    SceneUpdate update;
    update.moved_instances = {static_cast<uint32_t>(free - prepared.is_baked.begin())};
    Session session(queue, prepared, mixed_scene_camera(), settings);
    for (uint32_t k = 0; k < 10; ++k) {
        if (k > 0 && moves) {
            scene.instances[update.moved_instances[0]].world_from_local.translation.x += 0.03f;
            prepared = update_scene(prepared, scene, update, messages);
            session.update_scene(prepared, parts_of(update));
        }
        session.render_frame(k, {}, restir);
    }
    return picture_hash(session.frame().picture());
}

} // namespace

TEST_CASE("frames of moving scenes have the same bytes on every device and in every schedule") {
    Queue cpu = Queue::make_cpu();
    const RenderSettings settings = settings_of_frames();
    for (const RestirLight light : {RestirLight::Off, RestirLight::Indirect}) {
        const RestirSettings restir = {.light = light};
        const Hash128 expected = hash_of_motion(cpu, settings, true, restir);
        CHECK(expected != hash_of_motion(cpu, settings, false, restir));
        RenderSettings wavefront = settings;
        wavefront.body = PathBody::Wavefront;
        CHECK(hash_of_motion(cpu, wavefront, true, restir) == expected);
        if (cuda_requested()) {
            Queue cuda = make_cuda_queue();
            CHECK(hash_of_motion(cuda, settings, true, restir) == expected);
        }
    }
}

TEST_CASE("frames with ReSTIR have the same bytes on every device, in every schedule and batch size, and after a cut") {
    Messages messages;
    const Scene mixed = make_mixed_scene();
    LayeredBalls balls = layered_balls(); // nvcc shades threads of several lobes by calls in nested branches
    // In the second scene all surfaces are diffuse, so that frames do not split light.
    for (const Scenes& s :
         {Scenes{mixed, mixed_scene_camera()}, diffuse_scene(), Scenes{std::move(balls.scene), balls.camera}}) {
        const PreparedScene prepared = prepare_scene(s.scene, {}, messages);
        Queue cpu = Queue::make_cpu();
        Session session(cpu, prepared, s.camera, settings_of_frames());
        const Hash128 off = hash_of_frames(session, s.camera, kRestirFrames, {});
        for (const RestirLight light : {RestirLight::Direct, RestirLight::Indirect}) {
            const RestirSettings restir = {.light = light};
            session.cut();
            const Hash128 expected = hash_of_frames(session, s.camera, kRestirFrames, {}, restir);
            CHECK(expected != off);
            session.cut();
            CHECK(hash_of_frames(session, s.camera, kRestirFrames, {}, restir) == expected);
            RenderSettings wavefront = settings_of_frames();
            wavefront.body = PathBody::Wavefront;
            wavefront.batch = 600;
            Session other(cpu, prepared, s.camera, wavefront);
            CHECK(hash_of_frames(other, s.camera, kRestirFrames, {}, restir) == expected);
            RenderSettings hybrid = settings_of_frames();
            hybrid.integrator = IntegratorKind::Hybrid; // its samples are path's
            Session rasterised(cpu, prepared, s.camera, hybrid);
            CHECK(hash_of_frames(rasterised, s.camera, kRestirFrames, {}, restir) == expected);
            if (cuda_requested()) {
                Queue cuda = make_cuda_queue();
                Session there(cuda, prepared, s.camera, settings_of_frames());
                CHECK(hash_of_frames(there, s.camera, kRestirFrames, {}, restir) == expected);
            }
        }
        session.cut();
        CHECK(hash_of_frames(session, s.camera, kRestirFrames, {}) == off);
    }
}

TEST_CASE("a frame with ReSTIR counts its rays") {
    Messages messages;
    const Scene scene = make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = requested_queue();
    const RenderSettings settings = settings_of_frames();
    Session session(queue, prepared, mixed_scene_camera(), settings);
    session.render_frame(0, {});
    const uint64_t bounces = session.frames().rays().bounce;
    for (const RestirLight light : {RestirLight::Direct, RestirLight::Indirect}) {
        session.render_frame(0, {}, {.light = light});
        CHECK(session.frames().rays().bounce == bounces);
        CHECK(session.frames().rays().shadow > settings.width * settings.height / 2);
    }
}

TEST_CASE("a frame that is not reconstructed is the film's picture of the same sample") {
    for (const Scenes& s : scenes()) {
        Messages messages;
        const PreparedScene prepared = prepare_scene(s.scene, {}, messages);
        Queue queue = requested_queue();
        Session session(queue, prepared, s.camera, settings_of_frames(settings_of_frames()));
        session.render_frame(
            0, {.history = 1, .passes = 0, .clamp_fireflies = false, .clamp_history = false, .anti_alias = false});
        session.render(1);
        const Image frame = session.frame().picture(), film = session.picture();
        double difference = 0, light = 0;
        for (std::size_t i = 0; i < film.pixels.size(); ++i) {
            difference += static_cast<double>(std::abs(frame.pixels[i] - film.pixels[i]));
            light += static_cast<double>(film.pixels[i]);
        }
        CHECK(light > 0);
        CHECK(difference < 1e-5 * light); // divided by the surface's colour and multiplied again
    }
}

TEST_CASE("the mean of frames from a still camera is the picture, except for the losses of biased parts") {
    Messages messages;
    const Scene scene = make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = requested_queue();
    RenderSettings settings = settings_of_frames();
    settings.width = 96, settings.height = 64; // clamping has more effect in smaller pictures
    Session session(queue, prepared, mixed_scene_camera(), settings);
    session.render(256);
    const double expected = mean_of(session.picture());
    ReconstructionSettings unbounded;
    unbounded.clamp_fireflies = unbounded.clamp_history = false;
    double mean = 0, bounded = 0;
    constexpr uint32_t kMeasured = 64;
    for (const bool bounds : {false, true}) {
        session.cut();
        double& sum = bounds ? bounded : mean;
        for (uint32_t k = 0; k < 32 + kMeasured; ++k) {
            session.render_frame(k, bounds ? ReconstructionSettings{} : unbounded);
            if (k >= 32) sum += mean_of(session.frame().picture()) / kMeasured;
        }
    }
    CHECK(mean == doctest::Approx(expected).epsilon(0.02));
    CHECK(bounded == doctest::Approx(expected).epsilon(0.06));
}
