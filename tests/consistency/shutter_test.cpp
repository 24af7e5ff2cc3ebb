// Open shutters. Pictures with motion have the same bytes for any number of threads, schedule and tracer. Each
// ray has the hit that it has in the still scene of its time. Static parts do not change, to the bit. With --device
// cuda the GPU renders, too.

#include "session/shutter.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "base/parallel_for.h"
#include "device_scene/find_hits.h"
#include "render/camera_rays.h"
#include "render/light_paths/light_path_expression.h"
#include "render/light_paths/light_path_layers.h"
#include "scene/validate/validate.h"
#include "session/moving_scene.h"
#include "session/session.h"
#include "tests/support/options.h"
#include "tests/support/random.h"
#include "tests/support/render_scenes.h"
#include "tests/support/rushing_scene.h"
#include "tests/support/thrown_error.h"
#include "tracer/traversal_kernels.h"

using namespace pertev;

using test::kHalfASecond, test::make_rushing_scene, test::rushing_camera;

namespace {

RenderSettings blurred_settings(IntegratorKind integrator) {
    RenderSettings settings = test::layered_settings();
    settings.width = 37; // not a multiple of a tile
    settings.height = 21;
    settings.samples = 4;
    settings.integrator = integrator;
    settings.path.max_depth = 5;
    return settings;
}

Hash128 picture_of(Queue& queue, const PreparedScene& prepared, const Camera& camera, const RenderSettings& settings) {
    Session session(queue, prepared, camera, settings);
    session.render(settings.samples);
    const RenderResult result = session.result();
    CHECK(result.invalid_samples == 0);
    return test::render_hash(result);
}

constexpr IntegratorKind kWithShutter[] = {IntegratorKind::Path, IntegratorKind::Distributed, IntegratorKind::Whitted,
                                           IntegratorKind::Cast};

} // namespace

TEST_CASE("pictures with motion blur do not depend on threads, schedules, paths in flight or the device") {
    Messages messages;
    MovingScene moving(make_rushing_scene(), 0.3, {}, messages, kHalfASecond);
    REQUIRE(moving.prepared().motions != nullptr);
    CHECK(moving.prepared().motions->pivots.size() == 4);
    for (const IntegratorKind integrator : kWithShutter) {
        CAPTURE(static_cast<int>(integrator));
        Queue queue = Queue::make_cpu();
        RenderSettings settings = blurred_settings(integrator);
        const Camera camera = rushing_camera();
        const Hash128 reference = picture_of(queue, moving.prepared(), camera, settings);
        CHECK(picture_of(queue, moving.prepared(), test::mixed_scene_camera(), settings) != reference);

        for (const int threads : {1, 5}) {
            Queue few = Queue::make_cpu(Threads(threads));
            CHECK(picture_of(few, moving.prepared(), camera, settings) == reference);
            settings.pass_samples = 3;
        }
        settings.body = PathBody::Wavefront;
        for (const uint32_t batch : {333u, 1u << 20}) { // less than a picture, and all samples
            settings.batch = batch;
            CHECK(picture_of(queue, moving.prepared(), camera, settings) == reference);
            if (!test::cuda_requested()) continue;
            Queue gpu = test::make_cuda_queue();
            CHECK(picture_of(gpu, moving.prepared(), camera, settings) == reference);
        }
    }
}

TEST_CASE("blur from camera motion is the same in the wavefront and in the loop, including depth") {
    Messages messages;
    MovingScene still(make_rushing_scene(false), 0.3, {}, messages, kHalfASecond);
    REQUIRE(still.prepared().motions == nullptr);
    Queue cpu = Queue::make_cpu(), queue = test::requested_queue();
    for (const IntegratorKind integrator : kWithShutter) {
        CAPTURE(static_cast<int>(integrator));
        RenderSettings settings = blurred_settings(integrator);
        const Hash128 loop = picture_of(cpu, still.prepared(), rushing_camera(), settings);
        settings.body = PathBody::Wavefront;
        CHECK(picture_of(cpu, still.prepared(), rushing_camera(), settings) == loop);
        CHECK(picture_of(queue, still.prepared(), rushing_camera(), settings) == loop);
        CHECK(picture_of(cpu, still.prepared(), test::mixed_scene_camera(), settings) != loop);
    }
}

TEST_CASE("every tracer finds the same hits in a moving scene") {
    Messages messages;
    MovingScene moving(make_rushing_scene(), 0.3, {}, messages, kHalfASecond);
    RenderSettings settings = blurred_settings(IntegratorKind::Path);
    settings.width = 24, settings.height = 16, settings.samples = 2;
    Queue cpu = Queue::make_cpu();
    const Hash128 wanted = picture_of(cpu, moving.prepared(), rushing_camera(), settings);
    Queue queue = test::requested_queue();
    Session session(queue, moving.prepared(), rushing_camera(), settings);
    int pictures = 0, wrong = 0;
    for (const StructureKind structure : kValuesOf<StructureKind>) {
        for (const TraversalKind traversal : kValuesOf<TraversalKind>) {
            for (const Distribution distribution :
                 {Distribution::OneAThread, Distribution::Persistent, Distribution::DynamicFetch}) {
                const Combination c = {structure, traversal, {}, distribution};
                if (why_no_tracer(c, queue.is_cuda())) continue;
                settings.tracers = same_for_all(c);
                session.set_settings(settings);
                session.cut();
                session.render(settings.samples);
                ++pictures;
                wrong += test::render_hash(session.result()) == wanted ? 0 : 1;
            }
        }
    }
    CHECK(pictures > 40);
    CHECK(wrong == 0);
}

TEST_CASE("a ray in a moving scene hits what it hits in the still scene at its time") {
    Messages messages;
    const Scene rest = make_rushing_scene();
    MovingScene moving(rest, 0.3, {}, messages, kHalfASecond);
    Queue queue = Queue::make_cpu();
    const auto hits_of = [&](const PreparedScene& prepared, const std::vector<Ray>& rays, float time) {
        const SceneOnDevice scene(queue, prepared);
        const SceneTracer tracer(queue, *prepared.structures, default_tracers(false));
        std::vector<Hit> hits(rays.size());
        const auto accept_of = [&](uint32_t) { return AcceptHit{scene.view(), {}, {}, 0, time}; };
        find_hits(
            *tracer.host_trees(), static_cast<uint32_t>(rays.size()), RayOrder::Scattered,
            [&](uint32_t i) { return rays[i]; }, accept_of, hits.data());
        return hits;
    };
    test::Random random(11);
    int on_moving = 0, others = 0, wrong = 0;
    std::vector<float> worst; // metres
    for (const float time : {0.0f, 0.17f, 0.5f, 0.81f, 1.0f}) {
        CAPTURE(time);
        std::vector<Ray> rays;
        for (int i = 0; i < 4000; ++i) {
            Ray ray;
            ray.origin = random.point(-4, 4);
            ray.direction = random.direction();
            rays.push_back(ray);
        }
        MovingScene still(rest, kHalfASecond.time_at(0.3, static_cast<double>(time)), {}, messages);
        const std::vector<Hit> now = hits_of(moving.prepared(), rays, time);
        const std::vector<Hit> then = hits_of(still.prepared(), rays, kAtRest);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const bool moves =
                moving.prepared().motions->of_instance[std::min<uint32_t>(now[i].instance, 8)] != kNoMotion;
            if (now[i].instance != then[i].instance) {
                ++wrong; // the ray grazes an edge
            } else if (now[i].instance != kNoHit && moves) {
                ++on_moving;
                // Corners are off by at most 1/2048 of the size (math/motion_keys.h), here 2 m. On a slope the
                // distance differs more.
                worst.push_back(std::fabs(now[i].t - then[i].t));
            } else if (now[i].instance != kNoHit) {
                ++others;
                CHECK(now[i] == then[i]);
            }
        }
    }
    CHECK(on_moving > 600);
    CHECK(others > 3000);
    CHECK(wrong < on_moving / 200);
    std::ranges::sort(worst);
    CHECK(worst[worst.size() / 2] < 0.0002f);
    CHECK(worst[worst.size() * 99 / 100] < 0.002f);
}

TEST_CASE("each sample of a blurred picture equals the still scene at the sampled time") {
    Messages messages;
    RenderSettings settings =
        blurred_settings(IntegratorKind::Cast); // this integrator samples only pixel position, lens and time
    settings.width = 16, settings.height = 12, settings.samples = 1;
    settings.aovs = kAovDepth;
    Camera camera = test::mixed_scene_camera();
    camera.aperture_radius = 0.05f;
    camera.focus_distance = 6;
    Queue queue = test::requested_queue();
    const auto show = [](Session& session) {
        session.cut();
        session.render(1);
        return session.result();
    };
    CameraRays rays = {};
    rays.is_open = true;
    for (const bool has_far_lights : {false, true}) {
        CAPTURE(has_far_lights);
        uint32_t moved = 0, wrong = 0;
        Scene rest = make_rushing_scene();
        if (!has_far_lights) {
            rest.environment.reset();
            std::erase_if(rest.lights, [](const Light& light) { return !parts_of(light.kind).position; });
        }
        MovingScene moving(rest, 0.3, {}, messages, kHalfASecond), still(rest, 0.3, {}, messages);
        Session of_moving(queue, moving.prepared(), camera, settings);
        Session of_still(queue, still.prepared(), camera, settings);
        const RenderResult blurred = show(of_moving), at_rest = show(of_still);
        // Balancing near and far lights takes most of the time, so fewer pixels are compared with both.
        const uint32_t step = has_far_lights ? 6 : 1;
        for (uint32_t pixel = 0; pixel < settings.width * settings.height; pixel += step) {
            const SampleKey key = sample_key(settings.path, pixel, 0);
            const double time = static_cast<double>(rays.time(settings.path.sampler, key));
            REQUIRE((time >= 0 && time < 1));
            of_still.update_scene(still.prepared(), still.set_time(kHalfASecond.time_at(0.3, time), messages));
            const RenderResult now = show(of_still);
            const auto depth_of = [&](const RenderResult& result) { return result.layers.front().image.pixels[pixel]; };
            const auto light_of = [&](const RenderResult& result) { return result.picture.pixels[3 * pixel + 1]; };
            moved += depth_of(blurred) != depth_of(at_rest) || light_of(blurred) != light_of(at_rest) ? 1 : 0;
            const bool same_depth = std::fabs(depth_of(blurred) - depth_of(now)) < 0.003f;
            const bool same_light = std::fabs(light_of(blurred) - light_of(now)) <= 0.01f * light_of(now);
            wrong += same_depth && same_light ? 0 : 1;
        }
        CHECK(moved > (has_far_lights ? 3 : 20));
        CHECK(wrong <= (has_far_lights ? 0 : 3)); // only at edges of objects and shadows
    }
}

TEST_CASE("an open shutter changes nothing if nothing moves") {
    Messages messages;
    Queue queue = test::requested_queue();
    const Scene scene = make_rushing_scene(false);
    for (const IntegratorKind integrator : kWithShutter) {
        const RenderSettings settings = blurred_settings(integrator);
        MovingScene with(scene, 0.3, {}, messages, kHalfASecond), without(scene, 0.3, {}, messages);
        CHECK(with.prepared().motions == nullptr);
        CHECK(picture_of(queue, with.prepared(), test::mixed_scene_camera(), settings) ==
              picture_of(queue, without.prepared(), test::mixed_scene_camera(), settings));
    }
}

TEST_CASE("frames with an open shutter do not depend on earlier frames") {
    Messages messages;
    Queue queue = test::requested_queue();
    const RenderSettings settings = blurred_settings(IntegratorKind::Path);
    MovingScene moving(make_rushing_scene(), 0, {}, messages, kHalfASecond);
    Session session(queue, moving.prepared(), rushing_camera(), settings);
    for (const double time_s : {0.2, 0.9, 5.0, 0.3}) { // at 5 s all objects are still
        CAPTURE(time_s);
        session.update_scene(moving.prepared(), moving.set_time(time_s, messages));
        CHECK((moving.prepared().motions == nullptr) == (time_s > 2));
        session.render(settings.samples);
        MovingScene fresh(make_rushing_scene(), time_s, {}, messages, kHalfASecond);
        CHECK(test::render_hash(session.result()) == picture_of(queue, fresh.prepared(), rushing_camera(), settings));
    }
}

TEST_CASE("integrators whose rays have no time refuse an open shutter and name the setting") {
    Messages messages;
    MovingScene moving(make_rushing_scene(), 0.3, {}, messages, kHalfASecond);
    Queue queue = Queue::make_cpu();
    for (const IntegratorKind integrator :
         {IntegratorKind::Hybrid, IntegratorKind::Raster, IntegratorKind::Reyes, IntegratorKind::Light,
          IntegratorKind::Bidirectional, IntegratorKind::PhotonMap, IntegratorKind::IrradianceCache}) {
        const RenderSettings settings = blurred_settings(integrator);
        Session session(queue, moving.prepared(), test::mixed_scene_camera(), settings);
        CHECK(test::is_about(test::thrown_error([&] { session.render(1); }), ErrorCode::BadInput, "shutter"));
    }
}

TEST_CASE(
    "layers of light paths with motion blur are the same in the loop and the wavefront and do not change the picture") {
    Messages messages;
    MovingScene moving(make_rushing_scene(), 0.3, {}, messages, kHalfASecond);
    RenderSettings settings = blurred_settings(IntegratorKind::Path);
    const Hash128 without = [&] {
        Queue queue = Queue::make_cpu();
        Session session(queue, moving.prepared(), rushing_camera(), settings);
        session.render(settings.samples);
        return test::render_hash({.picture = session.picture()});
    }();
    std::vector<LightPathExpression> expressions;
    for (const char* text : {"direct=L[DG]E", "all=L.*E"}) expressions.push_back(parse_light_path(text));
    settings.light_paths =
        std::make_shared<const LightPathLayers>(bind_to_scene(std::move(expressions), moving.scene()));
    Queue cpu = Queue::make_cpu();
    const Hash128 loop = picture_of(cpu, moving.prepared(), rushing_camera(), settings);
    settings.body = PathBody::Wavefront;
    Queue queue = test::requested_queue();
    CHECK(picture_of(queue, moving.prepared(), rushing_camera(), settings) == loop);
    Session session(queue, moving.prepared(), rushing_camera(), settings);
    session.render(settings.samples);
    CHECK(test::render_hash({.picture = session.picture()}) == without);
}
