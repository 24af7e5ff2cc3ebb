// Emitters that emit from their fronts, from both faces, or away from the receiver: next-event estimation, BSDF
// sampling and both together, with and without clamping, agree with the closed form.

#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "device_scene/scene_on_device.h"
#include "integrators/path/path_stages.h"
#include "tests/support/estimate.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

constexpr float kHalf = 0.44f, kRadiance = 78.9f, kAlbedo = 0.5f; // the emitter, 1 m above the floor

Mesh square_at(float half, float y) {
    Mesh mesh;
    mesh.positions = {{-half, y, -half}, {-half, y, half}, {half, y, half}, {half, y, -half}};
    mesh.indices = {0, 1, 2, 0, 2, 3}; // facing +y
    return mesh;
}

/// A floor, and above its centre a black emitter that faces down or up, either by its mesh or by a mirroring node with
/// an up-facing mesh.
Scene emitter_over_floor(bool faces_down, bool is_two_sided, bool by_mirror) {
    Scene scene;
    scene.meshes = {square_at(1, 0), square_at(kHalf, by_mirror ? -1.0f : 1.0f)};
    if (by_mirror != faces_down) std::ranges::reverse(scene.meshes[1].indices);
    scene.materials.push_back({{.base_color = grey(kAlbedo)}, "floor"});
    scene.materials.push_back(
        {{.two_sided_emission = is_two_sided, .base_color = {0, 0, 0}, .emission = grey(kRadiance)}, "lamp"});
    scene.instances.push_back({"floor", 0, 0, {}});
    scene.instances.push_back({"lamp", 1, 1, by_mirror ? make_scale({1, -1, 1}) : Transform{}});
    return scene;
}

/// Returns the radiance of the floor under the emitter's centre, from a parallel rectangle.
double floor_radiance() {
    const double x = static_cast<double>(kHalf), p = std::sqrt(1 + x * x);
    return static_cast<double>(kAlbedo * kRadiance) / 3.141592653589793 * 4 * (x / p * std::atan(x / p));
}

/// Renders a small part of the scene from between emitter and floor: the floor seen from above, or the emitter seen
/// from `y`.
test::Estimate render(const Scene& scene, PathSettings path, bool up = false, float y = 0.5f) {
    RenderSettings settings;
    settings.width = settings.height = 32;
    settings.samples = static_cast<uint32_t>(test::effort(64, 1024));
    settings.filter = PixelFilter::Box;
    settings.path = path;
    settings.path.sampler = SamplerKind::Independent;
    Camera camera;
    camera.world_from_camera = look_at({0.01f, y, 0}, {0.01f, up ? y + 1 : y - 1, 0}, {0, 0, 1});
    camera.projection = Projection::Orthographic;
    camera.ortho_height = 1e-3f;
    Queue queue = test::requested_queue();
    return test::mean_over_pixels(test::render(queue, scene, camera, settings).picture);
}

} // namespace

TEST_CASE("emitters emit from the front or both faces under every sampling strategy, mirrored or not") {
    for (const bool by_mirror : {false, true}) {
        for (const bool faces_down : {false, true}) {
            for (const bool is_two_sided : {false, true}) {
                CAPTURE(by_mirror);
                CAPTURE(faces_down);
                CAPTURE(is_two_sided);
                const Scene scene = emitter_over_floor(faces_down, is_two_sided, by_mirror);
                const bool is_lit = faces_down || is_two_sided;
                for (const LightStrategy strategy : test::kLightStrategies) {
                    CAPTURE(static_cast<int>(strategy));
                    const test::Estimate floor = render(scene, {.strategy = strategy});
                    CAPTURE(floor.mean);
                    CAPTURE(floor.error);
                    CHECK(std::abs(floor.mean - (is_lit ? floor_radiance() : 0)) <= 4 * floor.error + 1e-3);
                }
                const double shown = static_cast<double>(kRadiance);
                CHECK(render(scene, {}, true).mean == doctest::Approx(is_lit ? shown : 0));
                const bool shines_up = !faces_down || is_two_sided;
                CHECK(render(scene, {}, false, 2).mean == doctest::Approx(shines_up ? shown : 0));
            }
        }
    }
}

TEST_CASE("next-event estimation alone finds unlit surfaces, which are no lights, at the maximum depth") {
    Scene scene = emitter_over_floor(true, false, false);
    scene.materials[1] = {{.kind = MaterialKind::Unlit, .base_color = grey(0.8f)}, "sign"};
    scene.environment = Environment{{}, grey(0.1f), 0};
    const test::Estimate by_mis = render(scene, {.max_depth = 1});
    const test::Estimate by_nee = render(scene, {.max_depth = 1, .strategy = LightStrategy::NeeOnly});
    CAPTURE(by_mis.mean);
    CAPTURE(by_nee.mean);
    CHECK(by_mis.mean > 0.06); // the sky alone gives 0.05
    CHECK(std::abs(by_nee.mean - by_mis.mean) < 4 * std::hypot(by_mis.error, by_nee.error));
}

TEST_CASE("clamping leaves light scattered once unchanged under every sampling strategy") {
    CHECK(floor_radiance() == doctest::Approx(7.74).epsilon(1e-3));
    const Scene scene = emitter_over_floor(true, false, false);
    for (const LightStrategy strategy : test::kLightStrategies) {
        CAPTURE(static_cast<int>(strategy));
        const test::Estimate floor = render(scene, {.strategy = strategy, .clamp = 5});
        CAPTURE(floor.mean);
        CAPTURE(floor.error);
        CHECK(std::abs(floor.mean - floor_radiance()) <= 4 * floor.error + 1e-3);
        CHECK(floor.error < 0.1);
    }
}

TEST_CASE("clamping limits indirect light equally under every sampling strategy, before MIS weights") {
    PathState path;
    path.throughput = {2, 4, 1};
    path.bsdf_pdf = 3;
    const auto found = [&](uint32_t depth, LightStrategy strategy, float light_pdf, float clamp) {
        PathState here = path;
        here.depth = depth;
        return emitted_light({.strategy = strategy, .clamp = clamp}, here, grey(5), light_pdf);
    };
    const float weight = power_heuristic(3.0f, 1.0f);
    for (const uint32_t depth : {0u, 1u}) CHECK(found(depth, LightStrategy::Mis, 0, 10) == Rgb{10, 20, 5});
    for (const uint32_t depth : {2u, 7u}) {
        CHECK(found(depth, LightStrategy::Mis, 0, 0) == Rgb{10, 20, 5});
        CHECK(found(depth, LightStrategy::BsdfOnly, 1, 10) == Rgb{5, 10, 2.5f});
        CHECK(found(depth, LightStrategy::Mis, 0, 10) == Rgb{5, 10, 2.5f});
        CHECK(found(depth, LightStrategy::Mis, 1, 10).g == doctest::Approx(static_cast<double>(weight * 10)));
        CHECK(found(depth, LightStrategy::Mis, 1, 19).g == doctest::Approx(static_cast<double>(weight * 19)));
        CHECK(found(depth, LightStrategy::Mis, 1, 21).g == doctest::Approx(static_cast<double>(weight * 20)));
    }

    Scene scene = emitter_over_floor(true, false, false);
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = Queue::make_cpu();
    const SceneOnDevice device(queue, prepared);
    Hit hit{0.5f, 0.3f, 0.3f, 0, 0};
    const Surface surface = make_surface(device.view(), hit, {0, -1, 0});
    const auto requested = [&](uint32_t depth, LightStrategy strategy, float clamp) {
        PathState here = path;
        here.depth = depth;
        ShadowRay shadow;
        PathJob job = {};
        job.picture.scene = device.view();
        job.settings = {.strategy = strategy, .clamp = clamp, .sampler = SamplerKind::Independent};
        FilmListeners listener(job);
        const SurfaceVertex vertex = {surface, {0, 1, 0}};
        REQUIRE(sample_direct<kAllMaterials>(job, here, vertex, vertex.light_context(here.time), DrawOnDemand(), shadow,
                                             listener));
        return static_cast<double>(max_component(shadow.contribution));
    };
    CHECK(requested(0, LightStrategy::NeeOnly, 1) == requested(0, LightStrategy::NeeOnly, 0));
    for (const uint32_t depth : {1u, 6u}) {
        const double whole = requested(depth, LightStrategy::NeeOnly, 0);
        const double share = requested(depth, LightStrategy::Mis, 0) / whole;
        REQUIRE(share > 0.01);
        REQUIRE(share < 0.99);
        const float clamp = static_cast<float>(0.4 * whole), loose = static_cast<float>(1.01 * whole);
        CHECK(requested(depth, LightStrategy::NeeOnly, clamp) == doctest::Approx(0.4 * whole));
        CHECK(requested(depth, LightStrategy::Mis, clamp) == doctest::Approx(share * 0.4 * whole));
        CHECK(requested(depth, LightStrategy::Mis, loose) == doctest::Approx(share * whole));
    }
}
