// The one-picture law for ray trees: cast, whitted and distributed give the same bytes for any number of threads, any
// split of the samples, either schedule, and any number of trees in flight. With --device cuda the GPU renders, too.

#include <doctest/doctest.h>

#include "session/session.h"
#include "tests/support/check_one_picture.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

constexpr IntegratorKind kTrees[] = {IntegratorKind::Cast, IntegratorKind::Whitted, IntegratorKind::Distributed};

RenderSettings tree_settings(IntegratorKind integrator) {
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

/// The mixed scene with more lights than a vertex samples at once.
Scene tree_scene() {
    Scene scene = test::make_mixed_scene();
    for (int i = 0; i < 3; ++i) scene.lights.push_back(scene.lights[static_cast<std::size_t>(i)]);
    scene.lights[3].position = {2, 1.5f, 3};
    return scene;
}

} // namespace

TEST_CASE("pictures of ray trees do not depend on threads, passes, schedules or trees in flight") {
    for (const IntegratorKind integrator : kTrees) {
        CAPTURE(static_cast<int>(integrator));
        const test::CheckedPicture reference = test::check_one_picture(tree_scene(), tree_settings(integrator));
        CHECK((reference.rays.bounce > 0) == (integrator != IntegratorKind::Cast));
        CHECK(reference.rays.shadow > 37 * 21);
    }
}

TEST_CASE("every integrator has the same first-surface layers") {
    Queue queue = test::requested_queue();
    const auto layers_of = [&](IntegratorKind integrator) {
        RenderSettings settings = tree_settings(integrator);
        settings.samples = 2;
        return test::hash_of_layers(queue, tree_scene(), settings, test::mixed_scene_camera());
    };
    const Hash128 of_path = layers_of(IntegratorKind::Path);
    for (const IntegratorKind integrator : kTrees) CHECK(layers_of(integrator) == of_path);
}

TEST_CASE("a session that changes its integrator renders the pictures of new sessions") {
    Queue queue = test::requested_queue();
    Messages messages;
    const Scene scene = tree_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings = tree_settings(IntegratorKind::Path);
    settings.samples = 1;
    Session session(queue, prepared, test::mixed_scene_camera(), settings);
    for (const IntegratorKind integrator : {IntegratorKind::Whitted, IntegratorKind::Distributed, IntegratorKind::Path,
                                            IntegratorKind::Cast, IntegratorKind::Whitted}) {
        settings.integrator = integrator;
        settings.path.max_depth = settings.path.max_depth == 6 ? 3 : 6; // with less memory, and with more
        session.set_settings(settings);
        session.render(1);
        CHECK(test::render_hash(session.result()) ==
              test::render_hash(test::render(queue, scene, test::mixed_scene_camera(), settings)));
    }
}

TEST_CASE("an abandoned picture of ray trees leaves no sample, and the next picture is complete") {
    Queue queue = test::requested_queue();
    Messages messages;
    const Scene scene = tree_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings = tree_settings(IntegratorKind::Distributed);
    settings.pass_samples = 1;
    Session session(queue, prepared, test::mixed_scene_camera(), settings);
    for (const IntegratorKind integrator : kTrees) {
        settings.integrator = integrator;
        test::check_goes_on(session, queue, scene, settings, test::mixed_scene_camera());
    }
}

TEST_CASE("memory of ray trees equals its prediction") {
    Messages messages;
    const Scene scene = tree_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    for (const IntegratorKind integrator : kTrees) {
        RenderSettings settings = tree_settings(integrator);
        settings.body = PathBody::Wavefront;
        test::check_predicted_bytes(prepared, settings);
    }
}

TEST_CASE("ray trees refuse real-time frames and depths over their limit") {
    RenderSettings settings = tree_settings(IntegratorKind::Whitted);
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
    CHECK(test::is_about(as_frame, ErrorCode::BadInput, "integrator", "whitted"));
    settings.path.max_depth = 256;
    const auto error = test::thrown_error([&] { session.set_settings(settings); });
    CHECK(test::is_about(error, ErrorCode::OverLimit, "max_depth", "256"));
}
