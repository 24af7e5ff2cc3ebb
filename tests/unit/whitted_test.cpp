// Whitted's ray trees against counts by hand, and their light against closed forms.

#include <doctest/doctest.h>

#include <cmath>

#include "tests/support/flat_scenes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

/// Traces a single ray straight down from `eye`.
RenderResult one_ray(const Scene& scene, Vec3 eye, uint32_t depth, IntegratorKind integrator = IntegratorKind::Whitted,
                     PathBody body = PathBody::Loop) {
    RenderSettings settings;
    settings.width = settings.height = 1;
    settings.samples = 1;
    settings.filter = PixelFilter::Box;
    settings.filter_radius = 0x1p-20f;
    settings.integrator = integrator;
    settings.ambient = Rgb{0, 0, 0};
    settings.path.max_depth = depth;
    settings.body = body;
    Queue queue = test::requested_queue();
    return test::render(queue, scene, test::camera_down(eye, 0.01f), settings);
}

float radiance_of(const RenderResult& result) { return result.picture.at(0, 0)[0]; }

/// A slab of glass between y = 0 and y = 1 of index 3, which reflects a quarter of the light at right angles, in an
/// environment of radiance 1.
Scene slab_scene() {
    Scene scene;
    const Material glass = {{.kind = MaterialKind::Dielectric, .base_color = {1, 1, 1}, .roughness = 0, .ior = 3},
                            "glass"};
    test::add(scene, test::floor_at(1, 50), glass);
    test::add(scene, test::sheet({0, 0, 0}, {50, 0, 0}, {0, 0, 50}), glass); // faces down
    scene.environment = Environment{};
    return scene;
}

} // namespace

TEST_CASE("a glass slab has the ray count computed by hand at each depth") {
    const Scene scene = slab_scene();
    // Each scattering inside the slab sends one ray out and one to the other face. Depth 1 adds 1/4, depth 2 adds 3/4
    // 3/4, and each further depth a quarter of the previous term.
    const float out[] = {0, 0.25f, 0.8125f, 0.953125f, 0.98828125f};
    for (const PathBody body : {PathBody::Loop, PathBody::Wavefront}) {
        for (uint32_t depth = 0; depth <= 4; ++depth) {
            CAPTURE(depth);
            const RenderResult result = one_ray(scene, {0.2f, 3, 0.3f}, depth, IntegratorKind::Whitted, body);
            CHECK(result.rays.camera == 1);
            CHECK(result.rays.bounce == 2 * depth);
            CHECK(result.rays.shadow == 0);
            CHECK(static_cast<double>(radiance_of(result)) ==
                  doctest::Approx(static_cast<double>(out[depth])).epsilon(1e-5));
        }
    }
}

TEST_CASE("rays that contribute less than a thousandth are not followed") {
    // Rays inside have the weight 3/4 4^-k, and rays that leave 3/4 of that. For both, k = 5 is the first below 2^-10.
    // One ray is reflected at once, five continue inside, and five leave.
    const RenderResult result = one_ray(slab_scene(), {0.2f, 3, 0.3f}, 16);
    CHECK(result.rays.bounce == 11);
    CHECK(radiance_of(result) > 0.998f);
    CHECK(radiance_of(result) < 1);
}

TEST_CASE("between two mirrors a ray is reflected up to the depth limit") {
    Scene scene;
    test::add(scene, test::floor_at(0, 50), test::mirror());
    test::add(scene, test::sheet({0, 2, 0}, {50, 0, 0}, {0, 0, 50}), test::mirror());
    scene.lights.push_back(test::point_light({5, 1, 0}, {1, 1, 1}));
    for (const uint32_t depth : {1u, 7u, 200u}) {
        const RenderResult result = one_ray(scene, {0, 1, 0}, depth);
        CHECK(result.rays.bounce == depth);
        CHECK(result.rays.shadow == 0); // mirrors need no shadow rays
        CHECK(radiance_of(result) == 0);
    }
}

TEST_CASE("a diffuse surface seen in a mirror samples each light once, however many there are") {
    Scene scene;
    test::add(scene, test::floor_at(0, 50), test::mirror());
    test::add(scene, test::sheet({0, 4, 0}, {50, 0, 0}, {0, 0, 50}),
              test::white(0.5f)); // the floor reflects the ceiling
    const Vec3 eye = {0.5f, 1, -0.3f};
    double expected = 0;
    for (int i = 0; i < 9; ++i) {
        const Vec3 at = {0.4f * static_cast<float>(i) - 1, 2.5f, 0.7f};
        scene.lights.push_back(test::point_light(at, {3, 3, 3}));
        const double up = 1.5, d2 = static_cast<double>(length_squared(at - Vec3{0.5f, 4, -0.3f}));
        expected += 0.5 / 3.141592653589793 * 3 * up / (d2 * std::sqrt(d2));
    }
    for (const PathBody body : {PathBody::Loop, PathBody::Wavefront}) {
        const RenderResult result = one_ray(scene, eye, 4, IntegratorKind::Whitted, body);
        CHECK(result.rays.bounce == 1);
        CHECK(result.rays.shadow == 9);
        CHECK(static_cast<double>(radiance_of(result)) == doctest::Approx(expected).epsilon(1e-4));
    }
    CHECK(one_ray(scene, eye, 1).rays.shadow == 0); // seen at a depth without direct light
    const RenderResult cast = one_ray(scene, eye, 4, IntegratorKind::Cast);
    CHECK(cast.rays.bounce == 0);
    CHECK(radiance_of(cast) == 0);
}

TEST_CASE("distributed equals whitted if there is only one light to choose") {
    Scene scene = slab_scene();
    scene.environment.reset();
    test::add(scene, test::floor_at(-1, 50), test::white(0.8f));
    test::add(scene, test::sheet({0, 9, 0}, {50, 0, 0}, {0, 0, 50}), test::white(0.5f));
    scene.lights.push_back(test::point_light({1, 4, 0}, {30, 20, 10}));
    const RenderResult whitted = one_ray(scene, {0, 3, 0}, 2);
    const RenderResult distributed = one_ray(scene, {0, 3, 0}, 2, IntegratorKind::Distributed);
    CHECK(radiance_of(whitted) > 0.01f); // the ceiling in the reflection
    CHECK(static_cast<double>(radiance_of(distributed)) ==
          doctest::Approx(static_cast<double>(radiance_of(whitted))).epsilon(1e-5));
    CHECK(distributed.rays.bounce == whitted.rays.bounce);
}
