// The one-picture law for pictures of a radiosity solution: the bytes are the same for any number of threads, any
// split of the samples and either schedule. With --device cuda the GPU renders, too.

#include <doctest/doctest.h>

#include "integrators/radiosity/radiosity_display_settings.h"
#include "radiosity/solve_radiosity.h"
#include "session/session.h"
#include "tests/support/check_one_picture.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

RadiosityDisplay look_at_mixed_scene(float patch_size, uint32_t rays = 32) {
    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    RadiositySettings settings;
    settings.patch_size = patch_size;
    settings.rays = rays;
    settings.subdivisions = 1;
    return {std::make_shared<const RadiositySolution>(solve_radiosity(prepared, settings).solution), false};
}

RenderSettings shown(const RadiosityDisplay& display) {
    RenderSettings settings;
    settings.width = 37; // not a multiple of a tile
    settings.height = 21;
    settings.samples = 4;
    settings.aovs = kAovAlbedo | kAovNormal | kAovDepth | kAovPosition | kAovIds;
    settings.transparent = true;
    settings.integrator = IntegratorKind::Radiosity;
    settings.path.max_depth = 6;
    settings.radiosity = display;
    return settings;
}

} // namespace

TEST_CASE("pictures of a radiosity solution do not depend on threads, passes, schedules or rays in flight") {
    RenderSettings settings = shown(look_at_mixed_scene(1));
    for (const bool is_flat : {false, true}) {
        settings.radiosity.edit().is_flat = is_flat;
        const test::CheckedPicture reference = test::check_one_picture(test::make_mixed_scene(), settings);
        CHECK(reference.rays.bounce > 37 * 21 / 10); // mirrors and glass
        CHECK(reference.rays.shadow == 0);
    }
}

TEST_CASE("radiosity has path tracing's first-surface layers and visible emission") {
    Queue queue = test::requested_queue();
    RenderSettings settings = shown(look_at_mixed_scene(2));
    const auto layers_of = [&](IntegratorKind integrator) {
        settings.integrator = integrator;
        return test::hash_of_layers(queue, test::make_mixed_scene(), settings);
    };
    CHECK(layers_of(IntegratorKind::Radiosity) == layers_of(IntegratorKind::Path));
    settings.path.max_depth = 0;
    settings.integrator = IntegratorKind::Radiosity;
    const Hash128 seen = test::checked_picture(queue, test::make_mixed_scene(), settings).hash;
    settings.integrator = IntegratorKind::Path;
    CHECK(test::checked_picture(queue, test::make_mixed_scene(), settings).hash == seen);
}

TEST_CASE("a session that switches to radiosity, another solution and back renders complete pictures") {
    Queue queue = test::requested_queue();
    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    const RadiosityDisplay looks[] = {look_at_mixed_scene(2), look_at_mixed_scene(1)};
    RenderSettings settings = shown(looks[0]);
    settings.pass_samples = 1;
    for (const PathBody body : {PathBody::Loop, PathBody::Wavefront}) {
        settings.body = body;
        Session session(queue, prepared, test::camera_with_lens(), settings);
        for (const auto& [integrator, number] :
             {std::pair(IntegratorKind::Radiosity, 0), std::pair(IntegratorKind::Path, 0),
              std::pair(IntegratorKind::Radiosity, 1), std::pair(IntegratorKind::Radiosity, 0)}) {
            settings.integrator = integrator;
            settings.radiosity = looks[number];
            test::check_goes_on(session, queue, scene, settings);
        }
    }
    Session session(queue, prepared, test::camera_with_lens(), settings);
    settings.radiosity.edit().solution.reset();
    session.set_settings(settings);
    CHECK(
        test::is_about(test::thrown_error([&] { session.render(1); }), ErrorCode::BadInput, "integrator", "radiosity"));
    RadiositySolution other = *looks[0].solution;
    other.roots.pop_back();
    settings.radiosity.edit().solution = std::make_shared<const RadiositySolution>(std::move(other));
    session.set_settings(settings);
    CHECK(test::bad_input_message([&] { session.render(1); }) != "no error"); // a solution of another scene
}

TEST_CASE("memory of radiosity renders equals its prediction") {
    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings = shown(look_at_mixed_scene(2));
    for (const PathBody body : {PathBody::Loop, PathBody::Wavefront}) {
        settings.body = body;
        test::check_predicted_bytes(prepared, settings);
    }
}
