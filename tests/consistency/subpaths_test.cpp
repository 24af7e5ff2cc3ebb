// The one-picture law for light subpaths: light and bidirectional give the same bytes for any number of threads, any
// split of the samples, either schedule, and any number of subpaths in flight. With --device cuda the GPU renders,
// too.

#include <doctest/doctest.h>

#include "session/session.h"
#include "tests/support/check_one_picture.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

constexpr IntegratorKind kSubpaths[] = {IntegratorKind::Light, IntegratorKind::Bidirectional};

RenderSettings subpath_settings(IntegratorKind integrator) {
    RenderSettings settings;
    settings.width = 37; // not a multiple of a tile
    settings.height = 21;
    settings.samples = 4;
    settings.aovs = kAovAlbedo | kAovNormal | kAovDepth | kAovPosition | kAovIds;
    settings.transparent = true;
    settings.integrator = integrator;
    settings.path.max_depth = 6;
    return settings;
}

} // namespace

TEST_CASE("pictures of light subpaths do not depend on threads, passes, schedules or subpaths in flight") {
    for (const IntegratorKind integrator : kSubpaths) {
        CAPTURE(static_cast<int>(integrator));
        const test::CheckedPicture reference =
            test::check_one_picture(test::make_mixed_scene(), subpath_settings(integrator));
        CHECK(reference.rays.bounce > 37 * 21);
        CHECK(reference.rays.shadow > 37 * 21);
    }
}

TEST_CASE("camera subpaths have path tracing's first-surface layers") {
    Queue queue = test::requested_queue();
    const auto layers_of = [&](IntegratorKind integrator) {
        RenderSettings settings = subpath_settings(integrator);
        settings.samples = 2;
        return test::hash_of_layers(queue, test::make_mixed_scene(), settings);
    };
    const Hash128 of_path = layers_of(IntegratorKind::Path);
    for (const IntegratorKind integrator : kSubpaths) CHECK(layers_of(integrator) == of_path);
}

TEST_CASE("at depth 0 every integrator shows only directly visible emission") {
    Queue queue = test::requested_queue();
    RenderSettings settings = subpath_settings(IntegratorKind::Path);
    settings.path.max_depth = 0;
    const Hash128 of_path = test::checked_picture(queue, test::make_mixed_scene(), settings).hash;
    for (const IntegratorKind integrator : kSubpaths) {
        settings.integrator = integrator;
        CHECK(test::checked_picture(queue, test::make_mixed_scene(), settings).hash == of_path);
    }
}

TEST_CASE("a session that switches to light subpaths and back, stops and resumes renders complete pictures") {
    Queue queue = test::requested_queue();
    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings = subpath_settings(IntegratorKind::Path);
    settings.samples = 2;
    settings.pass_samples = 1;
    Session session(queue, prepared, test::camera_with_lens(), settings);
    for (const IntegratorKind integrator :
         {IntegratorKind::Light, IntegratorKind::Bidirectional, IntegratorKind::Path, IntegratorKind::Bidirectional}) {
        settings.integrator = integrator;
        settings.path.max_depth = settings.path.max_depth == 6 ? 3 : 6; // with less memory, and with more
        test::check_goes_on(session, queue, scene, settings);
    }
}

TEST_CASE("memory of subpaths equals its prediction and is at most 1 GiB") {
    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    for (const IntegratorKind integrator : kSubpaths) {
        RenderSettings settings = subpath_settings(integrator);
        settings.body = PathBody::Wavefront;
        test::check_predicted_bytes(prepared, settings);
        for (const uint32_t depth : {0u, 8u, 255u}) {
            settings.path.max_depth = depth;
            CHECK(predicted_bytes(settings, {.width = 1 << 13, .height = 1 << 13, .samples = 64}, true) <=
                  std::size_t(1) << 30);
        }
    }
}

TEST_CASE("light subpaths refuse real-time frames and depths over their limit") {
    RenderSettings settings = subpath_settings(IntegratorKind::Bidirectional);
    settings.denoise = Denoise::Svgf;
    Queue queue = Queue::make_cpu();
    Messages messages;
    const Scene scene = test::make_furnace_scene(0.5f);
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    const auto denoised = test::thrown_error([&] { Session(queue, prepared, {}, settings); });
    CHECK(test::is_about(denoised, ErrorCode::BadInput, "denoise", "svgf"));
    settings.denoise = Denoise::None;
    Session session(queue, prepared, {}, settings);
    const auto as_frame = test::thrown_error([&] { session.render_frame(0, {}); });
    CHECK(test::is_about(as_frame, ErrorCode::BadInput, "integrator", "bidirectional"));
    settings.path.max_depth = 256;
    const auto error = test::thrown_error([&] { session.set_settings(settings); });
    CHECK(test::is_about(error, ErrorCode::OverLimit, "max_depth", "256"));
}
