// Pictures of the viewer (session_frames.h) against those of a plain session, and their exposure.

#include <algorithm>
#include <atomic>
#include <vector>

#include <doctest/doctest.h>

#include "apps/viewer/session_frames.h"
#include "image/picture_hash.h"
#include "integrators/irradiance_cache/irradiance_cache_settings.h"
#include "session/devices/frames_on_devices.h"
#include "session/devices/render_on_devices.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

struct Watched {
    Queue queue = test::requested_queue();
    Messages messages;
    MovingScene scene{test::make_mixed_scene(), std::nullopt, {}, messages};
    FrameRequest request;

    Watched() {
        request.camera = test::mixed_scene_camera();
        RenderSettings& picture = request.view.options.render;
        picture.width = 24, picture.height = 16;
        picture.samples = 2;
        picture.path.max_depth = 3;
        request.view.lens = request.camera;
        request.view.moving_scale = 1;
    }
    Session session() { return {queue, scene.prepared(), request.camera, request.view.options.render}; }
};

} // namespace

TEST_CASE("frames in motion share light at the set resolution, and the picture at rest does not") {
    Watched watched;
    FrameRequest& request = watched.request;
    Session plain = watched.session();
    plain.render(2);
    const std::string at_rest = picture_hash(plain.picture()).hex();
    struct Case {
        RestirLight light;
        float scale;
        bool filters;
    };
    for (const Case& set :
         {Case{RestirLight::Off, 1, true}, Case{RestirLight::Direct, 1, true}, Case{RestirLight::Indirect, 0.5f, true},
          Case{RestirLight::Off, 0.5f, false}, Case{RestirLight::Indirect, 1, false}}) {
        CAPTURE(static_cast<int>(set.light));
        CAPTURE(set.scale);
        CAPTURE(set.filters);
        Session session = watched.session(), alone = watched.session();
        SessionFrames frames(session, watched.scene, 0.1);
        ReconstructionOptions& options = request.view.options.reconstruction;
        options.sharing.light = set.light;
        options.none = !set.filters;
        options.settings.resolution_scale = set.scale;
        request.is_moving = true;
        for (uint32_t k = 0; k < 3; ++k) {
            const std::optional<ShownFrame> shown = frames.next(request);
            alone.render_frame(k, set.filters ? options.settings : of_samples_alone(options.settings), options.sharing);
            alone.frame().display(request.view.display.tone_map, 0);
            REQUIRE(shown.has_value());
            CHECK(shown->image.pixels == alone.frame().displayed().pixels);
            CHECK(shown->samples == k + 1); // both have one camera
        }
        request.is_moving = false;
        request.budget_s = 100;
        std::optional<ShownFrame> rests;
        while (!rests || !rests->is_final) rests = frames.next(request);
        CHECK(rests->hash == at_rest);
    }
}

TEST_CASE("several devices accumulate the picture at rest to the bytes of one, after motion, an edit and a stop") {
    Watched watched;
    FrameRequest& request = watched.request;
    request.view.options.render.samples = 9;
    request.budget_s = 1e-9; // few samples at a time
    std::vector<std::shared_ptr<Queue>> queues;
    for (int i = 0; i < 2; ++i) queues.push_back(std::make_shared<Queue>(test::requested_queue()));
    FramesOnDevices in_motion(queues, watched.scene.prepared(), AfterLoss::Cut);
    std::atomic<uint32_t> slices[2] = {};
    const DeviceHooks hooks = {.before_samples = {},
                               .after_slice = [&](std::size_t device, SampleRange) { ++slices[device]; }};
    RenderOnDevices at_rest(queues, watched.scene.prepared(), hooks);
    Session session(*queues.front(), watched.scene.prepared(), request.camera, request.view.options.render);
    session.pictures().share_frames(in_motion);
    session.pictures().share(at_rest);
    SessionFrames frames(session, watched.scene, 0.1);
    for (const float step : {0.0f, 0.1f}) {
        request.camera.world_from_camera.translation.x += step;
        request.is_moving = true;
        for (int k = 0; k < 2; ++k) REQUIRE(frames.next(request).has_value());
        request.is_moving = false;
        frames.abandon() = frames.hurry() = true;
        frames.next(request);
        frames.abandon() = frames.hurry() = false;
        std::optional<ShownFrame> rests;
        while (!rests || !rests->is_final) rests = frames.next(request);
        Session plain = watched.session();
        plain.set_camera(request.camera);
        plain.render(9);
        CHECK(rests->samples == 9);
        CHECK(rests->hash == picture_hash(plain.picture()).hex());
        plain.display(request.view.display.tone_map, rests->exposure_stops);
        CHECK(rests->image.pixels == plain.displayed().pixels);
    }
    CHECK(slices[0] + slices[1] > 0);
}

TEST_CASE("metering and picking in a picture at rest keep its irradiance records") {
    Watched watched;
    FrameRequest& request = watched.request;
    RenderSettings& picture = request.view.options.render;
    picture.integrator = IntegratorKind::IrradianceCache;
    picture.irradiance_cache = {.accuracy = 0.4f, .hemisphere_rays = 48};
    picture.samples = 4;
    Session plain = watched.session();
    plain.render(picture.samples);
    request.view.finds_exposure = true;
    request.budget_s = 1e-9;    // a pass at a time
    std::vector<double> shares; // progress of the records
    request.on_progress = [&](double share) { shares.push_back(share); };
    Session session = watched.session();
    SessionFrames frames(session, watched.scene, 0.1);
    std::optional<ShownFrame> rests;
    while (!rests || !rests->is_final) {
        rests = frames.next(request);
        CHECK(frames.pick(request.camera, 0.5f, 0.5f).has_value());
        frames.meter(request);
    }
    CHECK(rests->hash == picture_hash(plain.picture()).hex());
    CHECK(session.stats().rays.total() == plain.stats().rays.total());
    CHECK(!shares.empty());
    CHECK(std::ranges::is_sorted(shares));
    CHECK((shares.front() >= 0 && shares.back() < 1));
}

TEST_CASE("a change of ReSTIR or of the light's resolution restarts accumulation") {
    Watched watched;
    FrameRequest& request = watched.request;
    Session session = watched.session();
    SessionFrames frames(session, watched.scene, 0.1);
    request.is_moving = true;
    const auto gathered = [&] { return frames.next(request).value().samples; };
    CHECK(gathered() == 1);
    CHECK(gathered() == 2);
    request.view.options.reconstruction.sharing.light = RestirLight::Direct;
    CHECK(gathered() == 1);
    request.view.options.reconstruction.settings.resolution_scale = 0.5f;
    CHECK(gathered() == 1);
    CHECK(gathered() == 2);
    request.view.options.reconstruction.none = true; // unfiltered samples, which still share light
    CHECK(gathered() == 1);
}

TEST_CASE(
    "frames in motion have their own depth and continue after a rest, and the picture at rest has the full depth") {
    Watched watched;
    FrameRequest& request = watched.request;
    RenderSettings& picture = request.view.options.render;
    picture.path.max_depth = 8;
    picture.samples = 32;
    request.view.options.render.frame_depth = 2;
    Session plain = watched.session();
    plain.render(picture.samples);
    RenderSettings shallow = picture;
    shallow.path.max_depth = 2;
    for (const RestirLight light : {RestirLight::Off, RestirLight::Direct}) {
        CAPTURE(static_cast<int>(light));
        request.view.options.reconstruction.sharing.light = light;
        Session session = watched.session(), alone = watched.session();
        alone.set_settings(shallow);
        SessionFrames frames(session, watched.scene, 0.1);
        const auto check_frame = [&](uint32_t number) {
            request.is_moving = true;
            const std::optional<ShownFrame> shown = frames.next(request);
            const ReconstructionOptions& options = request.view.options.reconstruction;
            alone.render_frame(number, options.settings, options.sharing);
            alone.frame().display(request.view.display.tone_map, 0);
            REQUIRE(shown.has_value());
            CHECK(shown->image.pixels == alone.frame().displayed().pixels);
        };
        for (uint32_t k = 0; k < 3; ++k) check_frame(k);
        request.is_moving = false;
        request.budget_s = 1e-9;
        CHECK_FALSE(
            frames.next(request).has_value()); // the reconstruction is still shown, because one sample is not better
        request.budget_s = 100;
        std::optional<ShownFrame> rests;
        while (!rests || !rests->is_final) rests = frames.next(request);
        CHECK(rests->hash == picture_hash(plain.picture()).hex());
        check_frame(3); // with the history from before the rest
    }
}

TEST_CASE("a change of the depth in motion restarts frames but keeps the picture at rest") {
    Watched watched;
    FrameRequest& request = watched.request;
    Session session = watched.session();
    SessionFrames frames(session, watched.scene, 0.1);
    const auto gathered = [&] { return frames.next(request).value().samples; };
    request.is_moving = true;
    CHECK(gathered() == 1);
    CHECK(gathered() == 2);
    request.view.options.render.frame_depth = 1;
    CHECK(gathered() == 1);
    CHECK(gathered() == 2);
    request.is_moving = false;
    request.budget_s = 100;
    std::optional<ShownFrame> rests;
    while (!rests || !rests->is_final) rests = frames.next(request);
    CHECK(session.history().samples == 2);
    request.view.options.render.frame_depth = 2;
    CHECK(frames.next(request).value().hash == rests->hash);
    CHECK(session.history().samples == 2);
}

TEST_CASE("single pictures have the depth in motion, and the metered exposure at rest in real time") {
    Watched watched;
    FrameRequest& request = watched.request;
    request.view.options.render.integrator = IntegratorKind::Distributed;
    request.view.is_real_time = request.view.finds_exposure = true;
    request.view.options.render.frame_depth = 2;
    Session session = watched.session(), alone = watched.session();
    SessionFrames frames(session, watched.scene, 0.1);
    RenderSettings shallow = request.view.options.render;
    shallow.path.max_depth = 2;
    alone.set_settings(shallow);
    const auto check_metered = [&] {
        const ShownFrame shown = frames.next(request).value();
        CHECK(shown.found_stops == alone.meter(request.view.display.tone_map));
        return shown;
    };
    const ShownFrame first = check_metered();
    CHECK(first.found_stops != 0);
    alone.render(1);
    alone.display(request.view.display.tone_map, first.exposure_stops);
    CHECK(first.image.pixels == alone.displayed().pixels);
    request.camera.world_from_camera.translation = request.camera.world_from_camera.translation + Vec3{0, 0.5f, 0};
    alone.set_camera(request.camera);
    request.is_moving = true;
    CHECK(frames.next(request).value().found_stops == first.found_stops); // in motion the previous exposure is kept
    request.is_moving = false;
    CHECK(check_metered().found_stops != first.found_stops);
    request.view.is_real_time = false; // the picture at rest has its own exposure
    alone.set_settings(request.view.options.render);
    request.budget_s = 100;
    check_metered();
}

TEST_CASE("on a GPU the size keeps the screen's frame rate within limits, on a CPU its own") {
    Watched watched;
    FrameRequest& request = watched.request;
    request.view.moving_scale = 0;
    request.is_moving = true;
    Session session = watched.session();
    SessionFrames frames(session, watched.scene, 0.1);
    const auto kept = [&](bool on_cuda, float rate) {
        request.view.on_cuda = on_cuda;
        request.view.screen_rate = rate;
        return frames.next(request).value().kept_rate;
    };
    CHECK(kept(false, 144) == doctest::Approx(10));
    CHECK(kept(true, 0) == doctest::Approx(10));
    CHECK(kept(true, 144) == doctest::Approx(144));
    CHECK(kept(true, 1) == doctest::Approx(30));
    CHECK(kept(true, 1000) == doctest::Approx(240));
}

TEST_CASE("the exposure is metered on the displayed frame, whatever the light's resolution") {
    Watched watched;
    RenderSettings& picture = watched.request.view.options.render;
    for (const uint32_t width : {24u, 100u}) { // blocks of one pixel and of two
        picture.width = width;
        picture.height = width * 2 / 3;
        for (const float scale : {1.0f, 0.5f, 0.3f}) {
            CAPTURE(width);
            CAPTURE(scale);
            Session session = watched.session();
            ReconstructionSettings settings;
            settings.resolution_scale = scale;
            session.render_frame(0, settings);
            const FrameTones tones = session.frames().tones();
            const Image shown = session.frame().picture();
            CHECK(shown.width == width);
            double of_blocks = 0, of_pixels = 0, weights = 0;
            const uint32_t columns = tones.all.width, side = (width + columns - 1) / columns;
            for (uint32_t i = 0; i < columns * tones.all.height; ++i) {
                const uint32_t x = i % columns * side, y = i / columns * side;
                const double pixels = std::min(side, width - x) * std::min(side, picture.height - y);
                for (int c = 0; c < 3; ++c) of_blocks += pixels * static_cast<double>(tones.all.pixels[3 * i + c]);
                weights += pixels;
            }
            for (const float value : shown.pixels) of_pixels += static_cast<double>(value);
            CHECK(weights == width * picture.height);
            CHECK(of_blocks == doctest::Approx(of_pixels).epsilon(1e-4));
        }
    }
}

TEST_CASE("timing each kind of ray and shading does not change the picture") {
    Watched watched;
    FrameRequest& request = watched.request;
    request.budget_s = 100;
    Session session = watched.session(), together = watched.session();
    SessionFrames frames(session, watched.scene, 0.1), others(together, watched.scene, 0.1);
    const auto stages_of = [](const ShownFrame& frame) {
        std::string names;
        for (const auto& [name, milliseconds] : frame.stages) names += name + ' ';
        return names;
    };
    const std::string apart = "camera rays bounce rays shadow rays shading ";
    for (const bool is_moving : {true, false}) {
        CAPTURE(is_moving);
        request.is_moving = is_moving;
        const auto shown = [&](SessionFrames& source, bool is_timed) {
            request.view.options.render.time_kinds = is_timed;
            std::optional<ShownFrame> frame;
            do frame = source.next(request);
            while (!frame || (!is_moving && !frame->is_final));
            return *frame;
        };
        const ShownFrame timed = shown(frames, true), plain = shown(others, false);
        CHECK(timed.image.pixels == plain.image.pixels);
        CHECK(timed.hash == plain.hash);
        CHECK(stages_of(timed).starts_with(apart));
        CHECK(stages_of(plain).starts_with("render "));
        const SceneTracer::Seconds& rays = timed.kind_seconds;
        CHECK(std::min({rays.camera, rays.bounce, rays.shadow}) > 0);
        CHECK(rays.total() < timed.render_s);
        CHECK(plain.kind_seconds.total() == 0);
    }
    request.view.options.render.integrator = IntegratorKind::Raster; // this kind has no rays
    request.view.options.render.time_kinds = true;
    CHECK(stages_of(frames.next(request).value()).starts_with("render "));
}
