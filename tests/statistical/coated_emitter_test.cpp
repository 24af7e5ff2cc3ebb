// A coat dims and tints what glows beneath it by the angle, however the light is found: seen, by either sampling of
// path tracing, by particles, by pairs of subpaths and by photons, against an integral.

#include <doctest/doctest.h>

#include <cmath>

#include "shading/bsdf.h"
#include "tests/support/estimate.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

constexpr float kGlowHalf = 2, kGlowAlbedo = 0.5f, kCoatWeight = 0.9f, kCoatRoughness = 0.5f, kCoatIor = 2.2f;

/// Transmittance of the coat at a cosine; `tint` is what its colour leaves of both ways at normal incidence.
double let_out(double cosine, double tint = 1) {
    const SchlickLobe coat = {grey(0), 0, alpha_from_roughness(kCoatRoughness), f0_from_ior(kCoatIor)};
    const float albedo = coat.albedo_at(static_cast<float>(cosine), coat.make_average()).coat;
    const double sine = std::sqrt(1 - cosine * cosine) / static_cast<double>(kCoatIor);
    const double absorbed = std::pow(tint, 0.5 / std::sqrt(1 - sine * sine)); // by the refracted way out
    return 1 + static_cast<double>(kCoatWeight) * (absorbed * (1 - static_cast<double>(albedo)) - 1);
}

/// A floor and 1 m above it a wide black emitter that faces down, with a coat.
Scene coated_emitter(bool has_map, float tint = 1) {
    Scene scene;
    test::add(scene, test::sheet({0, 0, 0}, {0, 0, 1}, {1, 0, 0}), test::white(kGlowAlbedo));
    Material lamp = {{.base_color = grey(0), .emission = grey(1)}, "lamp"};
    lamp.coat_weight = kCoatWeight;
    lamp.coat_roughness = kCoatRoughness;
    lamp.coat_ior = kCoatIor;
    lamp.coat_color = grey(tint);
    if (has_map) { // the coat is on the half of the emitter with x > 0
        scene.images.emplace_back().rgba8 = {2, 1, {0, 0, 0, 255, 255, 255, 255, 255}};
        lamp.coat_texture.image = 0;
        lamp.coat_texture.filter = TextureFilter::Nearest;
    }
    Mesh sheet = test::sheet({0, 1, 0}, {kGlowHalf, 0, 0}, {0, 0, kGlowHalf});
    for (const Vec3& p : sheet.positions) {
        sheet.uv[0].push_back({0.5f + 0.5f * p.x / kGlowHalf, 0.5f + 0.5f * p.z / kGlowHalf});
    }
    test::add(scene, sheet, lamp);
    return scene;
}

/// Radiance of the floor below the emitter's centre, with the coat on all of it, on a half, or on none.
double radiance_under_coat(bool has_map, bool has_coat = true, double tint = 1) {
    constexpr int kCells = 400;
    double sum = 0;
    for (int i = 0; i < kCells; ++i)
        for (int j = 0; j < kCells; ++j) {
            const double x = (2 * (i + 0.5) / kCells - 1) * 2, z = (2 * (j + 0.5) / kCells - 1) * 2;
            const double d2 = 1 + x * x + z * z, cosine = 1 / std::sqrt(d2);
            sum += (!has_coat || (has_map && x < 0) ? 1 : let_out(cosine, tint)) * cosine * cosine / d2;
        }
    return sum * 16 / kCells / kCells * static_cast<double>(kGlowAlbedo) / 3.141592653589793;
}

/// The mean of a picture of `size` metres of the floor from beneath the emitter, or of the emitter from `from`.
test::Estimate glow_seen(const Scene& scene, IntegratorKind integrator, LightStrategy strategy, float size,
                         const Vec3* from = nullptr) {
    RenderSettings settings;
    settings.width = settings.height = 16;
    settings.samples = static_cast<uint32_t>(test::effort(256, 4096));
    settings.filter = PixelFilter::Box;
    settings.integrator = integrator;
    settings.path.strategy = strategy;
    settings.path.max_depth = 1;
    settings.path.sampler = SamplerKind::Independent;
    Camera camera;
    camera.world_from_camera =
        from != nullptr ? look_at(*from, {0.02f, 1, 0}, {0, 0, 1}) : look_at({0, 0.5f, 0}, {0, 0, 0}, {0, 0, 1});
    camera.projection = Projection::Orthographic;
    camera.ortho_height = size;
    Queue queue = test::requested_queue();
    return test::mean_over_pixels(test::render(queue, scene, camera, settings).picture);
}

} // namespace

TEST_CASE("a coat dims the light of what glows beneath it by the angle, for every way to find the light") {
    const struct {
        bool has_map;
        float tint;
    } coats[] = {{false, 1}, {true, 1}, {true, 0.5f}};
    for (const auto& [has_map, tint] : coats) {
        const Scene scene = coated_emitter(has_map, tint);
        const double expected = radiance_under_coat(has_map, true, static_cast<double>(tint));
        CHECK(expected < 0.95 * radiance_under_coat(has_map, false));
        CAPTURE(has_map);
        for (const LightStrategy strategy : test::kLightStrategies) {
            const test::Estimate floor = glow_seen(scene, IntegratorKind::Path, strategy, 0.02f);
            INFO("strategy " << static_cast<int>(strategy) << ": " << floor.mean << " +- " << floor.error
                             << ", expected " << expected);
            CHECK(std::abs(floor.mean - expected) <= 4.5 * floor.error + 1e-3 * expected);
            CHECK(floor.error < 0.005 * expected);
        }
        const test::Estimate floor = glow_seen(scene, IntegratorKind::Path, LightStrategy::NeeOnly, 1.5f);
        for (const IntegratorKind kind :
             {IntegratorKind::Light, IntegratorKind::Bidirectional, IntegratorKind::PhotonMap}) {
            const test::Estimate other = glow_seen(scene, kind, LightStrategy::Mis, 1.5f);
            INFO("integrator " << static_cast<int>(kind) << ": " << other.mean << " +- " << other.error << ", expected "
                               << floor.mean);
            CHECK(std::abs(other.mean - floor.mean) <= 4.5 * std::hypot(other.error, floor.error) + 2e-3 * expected);
            CHECK(other.error < 0.02 * expected);
        }
    }
}

TEST_CASE("an emitter seen through its coat is dimmed by the coat's reflection at that angle") {
    for (const float tint : {1.0f, 0.25f}) {
        const Scene scene = coated_emitter(false, tint);
        for (const Vec3 from : {Vec3{0.02f, 0.5f, 0}, Vec3{1.02f, 0.5f, 0}, Vec3{2.02f, 0.8f, 0}}) {
            const Vec3 to = Vec3{0.02f, 1, 0} - from;
            const double cosine = static_cast<double>(to.y / length(to));
            CAPTURE(cosine);
            for (const IntegratorKind kind :
                 {IntegratorKind::Path, IntegratorKind::Bidirectional, IntegratorKind::Light}) {
                CHECK(glow_seen(scene, kind, LightStrategy::Mis, 0.02f, &from).mean ==
                      doctest::Approx(let_out(cosine, static_cast<double>(tint))).epsilon(2e-3));
            }
        }
    }
}
