// The one-picture law for irradiance caching: the bytes are the same for any number of threads, any split of the
// samples, either schedule, and any number of subpaths in flight. With --device cuda the GPU renders, too.

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <vector>

#include "integrators/irradiance_cache/irradiance_cache_settings.h"
#include "integrators/irradiance_cache/record_store.h"
#include "session/session.h"
#include "tests/support/check_one_picture.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/stop_after.h"

using namespace pertev;

namespace {

RenderSettings cache_settings() {
    RenderSettings settings;
    settings.width = 37; // not a multiple of a tile
    settings.height = 21;
    settings.samples = 4;
    settings.aovs = kAovAlbedo | kAovNormal | kAovDepth | kAovPosition | kAovIds;
    settings.transparent = true;
    settings.integrator = IntegratorKind::IrradianceCache;
    settings.path.max_depth = 6;
    settings.irradiance_cache = {.accuracy = 0.4f, .hemisphere_rays = 48};
    return settings;
}

/// The mixed scene, with a mirror beside it.
Scene scene_with_mirror() {
    Scene scene = test::make_mixed_scene();
    test::add(scene, test::sheet({-2.5f, 1, 0}, {0, 1, 0}, {0, 0, 2}), test::mirror());
    return scene;
}

} // namespace

TEST_CASE("pictures by irradiance caching do not depend on threads, passes, schedules or subpaths in flight") {
    for (const bool shows_records : {false, true}) {
        RenderSettings settings = cache_settings();
        settings.irradiance_cache.edit().show_records = shows_records;
        const test::CheckedPicture reference = test::check_one_picture(scene_with_mirror(), settings);
        CHECK(reference.rays.bounce > 100 * 48);
        CHECK(reference.rays.shadow > 37 * 21);
    }
}

TEST_CASE("irradiance caching has path tracing's first-surface layers and direct light") {
    Queue queue = test::requested_queue();
    const auto layers_of = [&](IntegratorKind integrator, bool shows_records = false) {
        RenderSettings settings = cache_settings();
        settings.irradiance_cache.edit().show_records = shows_records;
        settings.integrator = integrator;
        settings.samples = 2;
        return test::hash_of_layers(queue, scene_with_mirror(), settings);
    };
    CHECK(layers_of(IntegratorKind::IrradianceCache) == layers_of(IntegratorKind::Path));
    CHECK(layers_of(IntegratorKind::IrradianceCache, true) == layers_of(IntegratorKind::Path));
    RenderSettings settings = cache_settings();
    for (const uint32_t depth : {0u, 1u}) { // records contain no light
        settings.path.max_depth = depth;
        settings.integrator = IntegratorKind::IrradianceCache;
        const RenderResult cached = test::render(queue, scene_with_mirror(), test::camera_with_lens(), settings);
        settings.integrator = IntegratorKind::Path;
        const RenderResult path = test::render(queue, scene_with_mirror(), test::camera_with_lens(), settings);
        for (std::size_t i = 0; i < path.picture.pixels.size(); ++i) { // the sums are rounded differently
            CHECK(cached.picture.pixels[i] ==
                  doctest::Approx(static_cast<double>(path.picture.pixels[i])).epsilon(1e-4));
        }
    }
}

TEST_CASE("a session that switches to irradiance caching and back renders complete pictures") {
    Queue queue = test::requested_queue();
    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings = cache_settings();
    settings.samples = 3;
    settings.pass_samples = 1;
    for (const PathBody body : {PathBody::Loop, PathBody::Wavefront}) {
        settings.body = body;
        Session session(queue, prepared, test::camera_with_lens(), settings);
        for (const auto& [integrator, rays] :
             {std::pair(IntegratorKind::IrradianceCache, 48u), std::pair(IntegratorKind::Path, 48u),
              std::pair(IntegratorKind::IrradianceCache, 20u), std::pair(IntegratorKind::IrradianceCache, 100u)}) {
            settings.integrator = integrator;
            settings.irradiance_cache.edit().hemisphere_rays = rays; // with less memory, and with more
            test::check_goes_on(session, queue, scene, settings);
        }
    }
}

namespace {

/// Rays that the session traces for one more sample.
uint64_t rays_of_a_sample(Session& session) {
    uint64_t rays = 0;
    CHECK(session.render(1, ProgressSink([&](const Progress& now) {
                             rays = now.rays;
                             return true;
                         })) == 1);
    return rays;
}

} // namespace

TEST_CASE("records are made once per picture and again for another picture") {
    Queue queue = test::requested_queue();
    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings = cache_settings();
    constexpr uint64_t kOfRecords = 100 * 48, kOfSample = 37 * 21 * 6; // the lower bound and the approximate number
    for (const PathBody body : {PathBody::Loop, PathBody::Wavefront}) {
        settings.body = body;
        Session session(queue, prepared, test::camera_with_lens(), settings);
        const auto check_made = [&](bool is_made) {
            const uint64_t rays = rays_of_a_sample(session);
            CHECK((rays > kOfRecords + kOfSample) == is_made);
            CHECK(rays > kOfSample / 6);
        };
        const auto check_picture = [&](const RenderSettings& of_picture, const Camera& camera) {
            RenderSettings fresh = of_picture;
            fresh.samples = session.history().samples;
            CHECK(test::render_hash(session.result()) == test::render_hash(test::render(queue, scene, camera, fresh)));
        };
        check_made(true);
        check_made(false);
        session.set_camera(test::camera_with_lens()); // the camera does not change
        session.set_settings(settings);
        check_made(false);
        check_picture(settings, test::camera_with_lens());
        session.meter(ToneMap::Aces); // the session renders other pictures in between
        check_made(false);
        RenderSettings aside_settings = settings;
        aside_settings.width = 9;
        session.render_separately(test::mixed_scene_camera(), aside_settings); // this picture has its own records
        check_made(false);
        aside_settings.path.max_depth = 0;
        session.render_separately(test::camera_with_lens(), aside_settings);
        session.meter(ToneMap::Aces);
        check_made(false);
        check_picture(settings, test::camera_with_lens());
        session.cut();
        session.render_separately(test::camera_with_lens(), settings);
        check_made(true);
        session.update_scene(prepared, kPartInstances);
        check_made(true);
        check_made(false);
        Camera aside = test::camera_with_lens();
        aside.world_from_camera.translation.x += 0.1f;
        session.set_camera(aside);
        check_made(true);
        check_made(false);
        check_picture(settings, aside);
        RenderSettings other = settings;
        other.irradiance_cache.edit().accuracy = 0.5f;
        session.set_settings(other);
        check_made(true);
        check_made(false);
        check_picture(other, aside);
    }
}

TEST_CASE("metering and separate renders trace no ray of the picture in progress and do not change its bytes") {
    Queue queue = test::requested_queue();
    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings = cache_settings();
    for (const PathBody body : {PathBody::Loop, PathBody::Wavefront}) {
        settings.body = body;
        Session undisturbed(queue, prepared, test::camera_with_lens(), settings);
        Session session(queue, prepared, test::camera_with_lens(), settings);
        const float stops = session.meter(ToneMap::Aces); // before there are records
        for (int sample = 0; sample < 3; ++sample) {
            CHECK(undisturbed.render(1) == 1);
            CHECK(session.render(1) == 1);
            CHECK(session.meter(ToneMap::Aces) == stops);
            RenderSettings one_pixel = settings;
            one_pixel.width = one_pixel.height = one_pixel.samples = 1;
            one_pixel.path.max_depth = 0;
            session.render_separately(test::mixed_scene_camera(), one_pixel);
        }
        const RenderResult wanted = undisturbed.result(), result = session.result();
        CHECK(result.rays.total() == wanted.rays.total());
        CHECK(test::render_hash(result) == test::render_hash(wanted));
    }
}

TEST_CASE("an overture's progress rises monotonically from 0 to 1") {
    Queue queue = test::requested_queue();
    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings = cache_settings();
    settings.width = 160, settings.height = 90;
    for (const PathBody body : {PathBody::Loop, PathBody::Wavefront}) {
        settings.body = body;
        settings.batch = 2000; // many parts
        Session session(queue, prepared, test::camera_with_lens(), settings);
        std::vector<Progress> reported;
        session.render(2, ProgressSink([&](const Progress& now) {
                           reported.push_back(now);
                           return true;
                       }));
        const auto is_of_samples = [](const Progress& now) { return now.samples_done > 0; };
        const auto samples = std::ranges::find_if(reported, is_of_samples);
        REQUIRE(samples - reported.begin() > 12);
        const auto all_rays = static_cast<double>(samples[-1].rays);
        CHECK(reported.front().made_share == 0);
        CHECK(samples[-1].made_share > 0.9);
        for (auto now = reported.begin(); now < samples; ++now) {
            const double share = now->made_share, done = static_cast<double>(now->rays) / all_rays;
            if (now > reported.begin()) CHECK(share >= now[-1].made_share);
            CHECK(pertev::abs(static_cast<float>(share - done)) < 0.35f);
            CHECK(share < 1);
            CHECK(now->made_seconds == now->seconds);
        }
        for (auto now = samples; now < reported.end(); ++now) {
            CHECK(now->made_share == 1);
            CHECK(now->made_seconds >= samples[-1].seconds);
            CHECK(now->made_seconds <= now->seconds);
        }
        CHECK(session.render(1, ProgressSink([&](const Progress& now) { return now.made_share == 1; })) ==
              1); // all records are complete
    }
}

TEST_CASE("invalid values in records are reported with sample 0, independent of earlier renders") {
    Queue queue = test::requested_queue();
    Scene scene = test::make_mixed_scene();
    test::add(scene, test::sheet({0, 3, 0}, {1, 0, 0}, {0, 0, 1}),
              {{.two_sided_emission = true, .emission = {1e18f, 0, 0}}, "too bright"}); // the film's integrator
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings = cache_settings();
    Session at_once(queue, prepared, test::camera_with_lens(), settings);
    Session in_parts(queue, prepared, test::camera_with_lens(), settings);
    at_once.render(3);
    in_parts.render(1);
    in_parts.render(2);
    CHECK(in_parts.stats().invalid_samples == at_once.stats().invalid_samples);
    in_parts.render_separately(test::camera_with_lens(), settings, 1); // this one makes records, too
    in_parts.cut();
    in_parts.render(3);
    CHECK(in_parts.stats().invalid_samples == at_once.stats().invalid_samples);
    settings.path.max_depth = 1; // there are no records
    in_parts.set_settings(settings);
    in_parts.render(3);
    CHECK(in_parts.stats().invalid_samples + 100 < at_once.stats().invalid_samples);
}

TEST_CASE("an overture can be stopped by a sink or a time limit, without any effect") {
    Queue queue = test::requested_queue();
    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings = cache_settings();
    settings.samples = 2;
    const Hash128 wanted = test::render_hash(test::render(queue, scene, test::camera_with_lens(), settings));
    for (const PathBody body : {PathBody::Loop, PathBody::Wavefront}) {
        settings.body = body;
        settings.batch = 500; // many parts
        Session session(queue, prepared, test::camera_with_lens(), settings);
        for (int most = 0; most < 12; ++most) { // before the first part, between rounds, and within records
            int connections = 0;
            CHECK(session.render(2, ProgressSink([&](const Progress& now) {
                                     CHECK(now.samples_done == 0);
                                     return connections++ < most;
                                 })) == 0);
            CHECK(connections == most + 1);
            CHECK(session.history().samples == 0);
            CHECK(session.stats().invalid_samples == 0);
        }
        if (!queue.is_cuda()) { // this stops within a part
            CHECK(session.render(2, test::StopAfter(0)) == 0);
            CHECK(session.render(2, test::StopAfter(5)) == 0);
        }
        RenderSettings short_of_time = settings;
        short_of_time.time_limit_s = 1e-9;
        session.set_settings(short_of_time);
        CHECK(session.render(2) == 0);
        session.set_settings(settings);
        CHECK(session.render(2) == 2);
        CHECK(test::render_hash(session.result()) == wanted);
    }
}

TEST_CASE("memory of irradiance caching equals its prediction") {
    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    for (const uint32_t rays : {16u, 3000u}) {
        for (const PathBody body : {PathBody::Loop, PathBody::Wavefront}) {
            RenderSettings settings = cache_settings();
            settings.body = body;
            settings.irradiance_cache.edit().hemisphere_rays = rays;
            settings.samples = 1;
            settings.path.max_depth = 1; // memory for records is allocated, and none is made
            settings.batch = 1000;       // fewer rays than one record needs
            Queue dry = Queue::make_dry_run(false);
            RecordStore store(dry);
            store.allocate(uint64_t(settings.width) * settings.height);
            test::check_predicted_bytes(prepared, settings, false, store.host_bytes());
        }
    }
}
