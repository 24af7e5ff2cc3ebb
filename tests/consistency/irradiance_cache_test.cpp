// The one-picture law for irradiance caching: the same bytes for any number of threads, any split of the samples, all
// stages over all walks or a few walks a thread, any number of them in flight. With --device cuda the GPU joins in.

#include <doctest/doctest.h>

#include "session/session.h"
#include "tests/support/check_one_picture.h"
#include "tests/support/flat_scenes.h"

using namespace pertev;

namespace {

RenderSettings cache_settings() {
    RenderSettings settings;
    settings.width = 37; // odd on purpose: tiles do not fit
    settings.height = 21;
    settings.samples = 4;
    settings.aovs = kAovAlbedo | kAovNormal | kAovDepth | kAovPosition | kAovIds;
    settings.transparent = true;
    settings.integrator = IntegratorKind::IrradianceCache;
    settings.path.max_depth = 6;
    settings.irradiance_cache = {.accuracy = 0.4f, .hemisphere_rays = 48};
    return settings;
}

/// The mixed scene, with a mirror on its side that shows it.
Scene scene_with_mirror() {
    Scene scene = test::make_mixed_scene();
    test::add(scene, test::sheet({-2.5f, 1, 0}, {0, 1, 0}, {0, 0, 2}), test::mirror());
    return scene;
}

} // namespace

TEST_CASE("pictures by irradiance caching do not depend on threads, passes, bodies, or how many walks are in flight") {
    for (const bool shows_records : {false, true}) {
        RenderSettings settings = cache_settings();
        settings.irradiance_cache.show_records = shows_records;
        const test::CheckedPicture reference = test::check_one_picture(scene_with_mirror(), settings);
        CHECK(reference.rays.bounce > 100 * 48);
        CHECK(reference.rays.shadow > 37 * 21);
    }
}

TEST_CASE("irradiance caching tells the same of the first surface as path tracing, and of light scattered once") {
    Queue queue = test::queue_asked_for();
    const auto layers_of = [&](IntegratorKind integrator, bool shows_records = false) {
        RenderSettings settings = cache_settings();
        settings.irradiance_cache.show_records = shows_records;
        settings.integrator = integrator;
        settings.samples = 2;
        return test::hash_of_layers(queue, scene_with_mirror(), settings);
    };
    CHECK(layers_of(IntegratorKind::IrradianceCache) == layers_of(IntegratorKind::Path));
    CHECK(layers_of(IntegratorKind::IrradianceCache, true) == layers_of(IntegratorKind::Path));
    RenderSettings settings = cache_settings();
    for (const uint32_t depth : {0u, 1u}) { // nothing is in records
        settings.path.max_depth = depth;
        settings.integrator = IntegratorKind::IrradianceCache;
        const RenderResult cached = test::render(queue, scene_with_mirror(), test::camera_with_lens(), settings);
        settings.integrator = IntegratorKind::Path;
        const RenderResult path = test::render(queue, scene_with_mirror(), test::camera_with_lens(), settings);
        for (std::size_t i = 0; i < path.picture.pixels.size(); ++i) { // sums of other roundings
            CHECK(cached.picture.pixels[i] ==
                  doctest::Approx(static_cast<double>(path.picture.pixels[i])).epsilon(1e-4));
        }
    }
}

TEST_CASE("a session goes to irradiance caching and back, ends early and goes on, and each picture is whole") {
    Queue queue = Queue::make_cpu();
    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings = cache_settings();
    settings.samples = 2;
    settings.pass_samples = 1;
    for (const PathBody body : {PathBody::Loop, PathBody::Wavefront}) {
        settings.body = body;
        Session session(queue, prepared, test::camera_with_lens(), settings);
        for (const auto& [integrator, rays] :
             {std::pair(IntegratorKind::IrradianceCache, 48u), std::pair(IntegratorKind::Path, 48u),
              std::pair(IntegratorKind::IrradianceCache, 20u), std::pair(IntegratorKind::IrradianceCache, 100u)}) {
            settings.integrator = integrator;
            settings.irradiance_cache.hemisphere_rays = rays; // less memory, and more
            test::check_goes_on(session, queue, scene, settings);
        }
    }
}

TEST_CASE("memory of irradiance caching is said beforehand") {
    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    for (const uint32_t rays : {16u, 3000u}) {
        for (const PathBody body : {PathBody::Loop, PathBody::Wavefront}) {
            RenderSettings settings = cache_settings();
            settings.body = body;
            settings.irradiance_cache.hemisphere_rays = rays;
            settings.samples = 1;
            settings.path.max_depth = 1; // room for records is taken, and none is made
            settings.batch = 1000;       // less than the rays of one record
            test::check_predicted_bytes(prepared, settings);
        }
    }
}
