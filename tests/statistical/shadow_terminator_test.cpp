// Interpolated normals: surfaces scatter by their BSDF, no light is lost or cut off at the triangles' horizons, none
// leaks through, and all sampling techniques agree (shading/shadow_terminator.h).

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "device_scene/surface.h"
#include "tests/statistical/bsdf_cases.h"
#include "tests/statistical/tilted_surface.h"
#include "tests/support/chi_square.h"
#include "tests/support/meshes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

constexpr float kTilts[] = {0.02f, 0.1f, 0.17f, 0.3f};

Mesh smooth_sphere(int subdivisions) {
    const TriangleMesh triangles = make_sphere(subdivisions, {0, 0, 0}, 1.0f);
    Mesh mesh;
    mesh.positions = triangles.positions;
    mesh.indices = triangles.indices;
    for (const Vec3 p : mesh.positions) mesh.normals.push_back(normalize(p));
    return mesh;
}

/// One subdivision has 80 triangles with vertex normals tilted by up to 20 degrees, two have 320 triangles and 10
/// degrees.
Scene sphere_scene(int subdivisions, const Material& material) {
    Scene scene;
    scene.meshes.push_back(smooth_sphere(subdivisions));
    scene.materials.push_back(material);
    scene.instances.push_back({"sphere", 0, 0, {}});
    return scene;
}

Light point_light(Vec3 position, float intensity) {
    return {.name = "lamp",
            .kind = LightKind::Point,
            .position = position,
            .direction = {0, -1, 0},
            .intensity = grey(intensity)};
}

Camera front_camera() {
    Camera camera;
    camera.projection = Projection::Orthographic;
    camera.world_from_camera = look_at({0, 0, 3}, {0, 0, 0}, {0, 1, 0});
    camera.ortho_height = 2.1f;
    return camera;
}

struct Brightness {
    double all, rim; // mean over the pixels within the silhouette, and over those near it
};

Brightness furnace(const Scene& scene, LightStrategy strategy, uint32_t samples) {
    constexpr uint32_t kSize = 32;
    RenderSettings settings;
    settings.width = settings.height = kSize;
    settings.samples = static_cast<uint32_t>(effort(samples, 10 * samples));
    settings.filter = PixelFilter::Box;
    settings.path.max_depth = 400;
    settings.path.strategy = strategy;
    Queue queue = requested_queue();
    const RenderResult result = test::render(queue, scene, front_camera(), settings);
    CHECK(result.invalid_samples == 0);
    double all = 0, rim = 0, all_count = 0, rim_count = 0;
    for (uint32_t y = 0; y < kSize; ++y) {
        for (uint32_t x = 0; x < kSize; ++x) {
            const double r = std::hypot(x + 0.5 - kSize / 2.0, y + 0.5 - kSize / 2.0) * 2.1 / kSize;
            if (r > 0.97)
                continue; // the polygon's outline lies between 0.93 and 1; the sky behind it has radiance 1, too
            const auto value = static_cast<double>(result.picture.at(x, y)[1]);
            all += value;
            all_count += 1;
            if (r < 0.85) continue;
            rim += value;
            rim_count += 1;
        }
    }
    return {all / all_count, rim / rim_count};
}

/// Returns the largest step between neighbouring pixels well within the outline, relative to the brightest pixel.
double largest_step(int subdivisions) {
    constexpr uint32_t kSize = 160;
    Scene scene = sphere_scene(subdivisions, {{.base_color = grey(0.8f)}, "chalk"});
    scene.lights.push_back(point_light({60, 30, 15}, 1e4f));
    RenderSettings settings;
    settings.width = settings.height = kSize;
    settings.samples = 16;
    settings.filter = PixelFilter::Box;
    settings.path.max_depth = 1;
    Queue queue = requested_queue();
    const RenderResult result = test::render(queue, scene, front_camera(), settings);
    double step = 0, brightest = 0;
    const auto inside = [](uint32_t x, uint32_t y) {
        return std::hypot(x + 0.5 - kSize / 2.0, y + 0.5 - kSize / 2.0) * 2.1 / kSize < 0.85;
    };
    const auto value = [&](uint32_t x, uint32_t y) { return static_cast<double>(result.picture.at(x, y)[1]); };
    for (uint32_t y = 0; y + 1 < kSize; ++y) {
        for (uint32_t x = 0; x + 1 < kSize; ++x) {
            if (!inside(x, y) || !inside(x + 1, y) || !inside(x, y + 1)) continue;
            brightest = std::max(brightest, value(x, y));
            step = std::max({step, std::abs(value(x + 1, y) - value(x, y)), std::abs(value(x, y + 1) - value(x, y))});
        }
    }
    return step / brightest;
}

} // namespace

TEST_CASE("raised directions clear the horizon, and lowering inverts raising") {
    for (const float tilt : {kMinTilt, 0.02f, 0.1f, 1.0f / 6, 0.2f, kLargestTilt}) {
        CAPTURE(tilt);
        float before = 0;
        for (int i = 0; i <= 1000; ++i) {
            const float height = static_cast<float>(i) / 1000;
            for (const float side : {1.0f, -1.0f}) {
                const Vec3 w = direction_at(side * height, 0.3f);
                const RaisedDirection up = raise_direction(w, tilt), down = lower_direction(up.direction, tilt);
                CHECK(length(up.direction) == doctest::Approx(1).epsilon(1e-6));
                CHECK(up.direction.z * side >= tilt * (1 - 1e-6f));
                CHECK(up.slope >= 0.333f);
                CHECK(up.slope <= 1);
                if (height >= kTerminatorReach * tilt) CHECK(up.direction == w);
                if (i == 0) continue;
                CHECK(length(down.direction - w) < 2e-4f);
                CHECK(down.slope == doctest::Approx(up.slope).epsilon(1e-3));
                CHECK(up.direction.z * side > before); // no direction is folded
                if (side < 0) before = -up.direction.z;
            }
        }
        CHECK(lower_direction(direction_at(0.99f * tilt), tilt).slope == 0);
    }
    CHECK(terminator_tilt(kLargestTilt, 0) == kLargestTilt);
    CHECK(terminator_tilt(0.4f, 0) == kLargestTilt);
    CHECK(terminator_tilt(0.65f, 0) == doctest::Approx(0.1));
    CHECK(terminator_tilt(0.8f, 0) == 0); // a cube's corner
    CHECK(terminator_tilt(0.1f, 0.2f) == 0.2f);
    CHECK(terminator_tilt(0.5f * kMinTilt, 0) == 0);
}

TEST_CASE("sampling a tilted surface follows its density for every BSDF") {
    const std::vector<BsdfCase> cases = rough_bsdf_cases();
    constexpr float tilts[] = {0.1f, 0.3f};
    const int tests = static_cast<int>(cases.size() * std::size(tilts));
    for (const BsdfCase& c : cases) {
        const float alpha = narrowest_alpha(c.bsdf);
        const bool fits = alpha > 0.05f && alpha < 1; // not too narrow for a uniform grid; 1 has no effect
        if (!fits && c.name != "diffuse") continue;
        for (const float tilt : tilts) {
            CAPTURE(c.name);
            CAPTURE(tilt);
            const Surface surface = tilted_surface(c.bsdf, tilt);
            const Vec3 wo = direction_at(0.6f);
            const auto [result, weight_error] =
                test_tilted_sampling([&](float lobe, Vec2 u) { return surface.sample(wo, lobe, u); },
                                     [&](Vec3 wi) { return surface.evaluate(wo, wi); });
            CHECK_MESSAGE(result.passes(tests), result.describe());
            CHECK(weight_error < 0.02);
        }
    }
}

TEST_CASE("raising loses no light: every BSDF sample leaves its triangle on the correct side") {
    std::vector<BsdfCase> cases = rough_bsdf_cases();
    cases.push_back({"smooth glass", make_dielectric(1.5f, 0, grey(1))});
    cases.push_back({"mirror", make_conductor(kGoldEta, kGoldK, 0)});
    constexpr uint32_t kPoints = 1000; // the loss is at most a thousandth of the light
    for (const BsdfCase& c : cases) {
        // From inside glass, light at a height of -0.755 is refracted to just above the shading horizon.
        for (const float height : {0.5f, 0.9f, -0.5f, -0.755f, -0.9f}) {
            const Vec3 wo = direction_at(height, height == -0.755f ? 0.0f : 0.45f);
            double bare = 0;
            for (uint32_t i = 0; i < kPoints; ++i) {
                const SamplePoint p = even_point(i, kPoints);
                const BsdfSample s = c.bsdf.sample(wo, p.lobe, p.u);
                if (s.pdf > 0) bare += static_cast<double>(s.weight.g);
            }
            for (const float tilt : kTilts) {
                CAPTURE(c.name);
                CAPTURE(tilt);
                CAPTURE(height);
                const Surface surface = tilted_surface(c.bsdf, tilt);
                double tilted = 0;
                bool right_side = true;
                for (uint32_t i = 0; i < kPoints; ++i) {
                    const SamplePoint p = even_point(i, kPoints);
                    const BsdfSample t = surface.sample(wo, p.lobe, p.u);
                    if (!(t.pdf > 0)) continue;
                    tilted += static_cast<double>(t.weight.g);
                    right_side = right_side && surface.same_side(wo, t.wi) == !t.is_transmission;
                }
                CHECK(right_side);
                CHECK(tilted == doctest::Approx(bare).epsilon(1e-3));
            }
        }
    }
}

// A bounded ratio bounds a particle's weight, value |wo . Ng| / |wi . Ng| (docs/conventions.md). Without the raise the
// ratio is unbounded.
TEST_CASE("the value over the geometric cosine stays bounded down to the horizon") {
    for (const float tilt : kTilts) {
        CAPTURE(tilt);
        const Surface surface = tilted_surface(make_diffuse(grey(1)), tilt);
        const Vec3 wo = direction_at(0.8f);
        double largest = 0;
        for (int i = 1; i < 2000; ++i) {
            for (int j = 0; j < 64; ++j) {
                const Vec3 wi = direction_at(static_cast<float>(i) / 2000, static_cast<float>(j) / 64);
                const BsdfValue value = surface.evaluate(wo, wi);
                if (!(value.pdf > 0)) continue;
                const double cosine = static_cast<double>(dot(wi, surface.geometric_normal));
                CHECK(cosine > 0);
                largest = std::max(largest, static_cast<double>(value.f.g) * 3.14159265 / cosine);
            }
        }
        CHECK(largest < 9);
        // For Lambert's law the function of (wo, wi) does not depend on wo.
        const Vec3 wi = direction_at(0.35f, 0.2f);
        CHECK(surface.evaluate(direction_at(0.9f, 0.7f), wi).f.g == surface.evaluate(wo, wi).f.g);
    }
}

TEST_CASE("coarse smooth spheres and their rims are invisible in a white furnace") {
    Material chalk{{.base_color = grey(1)}, "chalk"};
    Material glass{{.kind = MaterialKind::Dielectric, .base_color = grey(1), .roughness = 0}, "glass"};
    Material frosted = glass;
    frosted.roughness = 0.5f;
    Material metal{{.kind = MaterialKind::MetallicRoughness, .base_color = grey(1), .metallic = 1, .roughness = 0.4f},
                   "metal"};
    for (const Material& material : {chalk, glass, frosted, metal}) {
        for (const int subdivisions : {1, 2}) {
            CAPTURE(material.name);
            CAPTURE(material.roughness);
            CAPTURE(subdivisions);
            Scene scene = sphere_scene(subdivisions, material);
            scene.environment = Environment{};
            for (const LightStrategy strategy : {LightStrategy::BsdfOnly, LightStrategy::Mis}) {
                const Brightness seen = furnace(scene, strategy, material.roughness == 0.5f ? 64 : 16);
                // The surface does not lose this light. In the coarsest smooth glass total reflection keeps some light
                // inside for thousands of bounces, because with interpolated normals it does not leave through the
                // sides by which it entered.
                const bool traps = material.roughness == 0 && subdivisions == 1;
                CHECK(seen.all == doctest::Approx(1).epsilon(0.01));
                CHECK(seen.rim == doctest::Approx(1).epsilon(traps ? 0.03 : 0.01));
            }
        }
    }
}

TEST_CASE("a coarse smooth sphere next to an emitter has a soft terminator") {
    const double of_80 = largest_step(1), of_320 = largest_step(2);
    CHECK(of_80 < 0.12); // 0.21 and 0.10 if light is cut off at the triangles' horizons
    CHECK(of_320 < 0.06);
}

TEST_CASE("no light leaks into a coarse smooth room") {
    Material plastic{{.kind = MaterialKind::MetallicRoughness, .base_color = grey(0.8f)}, "plastic"};
    Material mirror = plastic;
    mirror.metallic = 1;
    mirror.roughness = 0;
    for (const Material& material : {Material{{.base_color = grey(0.8f)}, "chalk"}, plastic, mirror}) {
        for (const int subdivisions : {0, 1}) { // 0 is so coarse that some directions are not raised above the horizon
            CAPTURE(material.name);
            CAPTURE(subdivisions);
            Scene scene = sphere_scene(subdivisions, material);
            scene.environment = Environment{};
            for (const Vec3 at : {Vec3{2, 0, 0}, Vec3{-1, 1.5f, 0.3f}}) scene.lights.push_back(point_light(at, 1000));
            Camera camera;
            camera.world_from_camera = look_at({0.3f, 0.2f, -0.3f}, {1, 0.4f, 0.1f}, {0, 1, 0});
            camera.fov_y = 2.0f;
            RenderSettings settings;
            settings.width = settings.height = 48;
            settings.samples = 16;
            Queue queue = requested_queue();
            const RenderResult result = test::render(queue, scene, camera, settings);
            const auto& pixels = result.picture.pixels;
            CHECK(*std::max_element(pixels.begin(), pixels.end()) == 0);
        }
    }
}

TEST_CASE("light sampling strategies agree on coarse smooth meshes") {
    const Material metal{{.kind = MaterialKind::Conductor, .roughness = 0.6f}, "metal"};
    const Material plastic{{.kind = MaterialKind::MetallicRoughness, .base_color = grey(0.8f), .roughness = 0.5f},
                           "plastic"};
    for (const Material& material : {Material{{.base_color = grey(0.8f)}, "chalk"}, metal, plastic}) {
        CAPTURE(material.name);
        Scene scene = sphere_scene(1, material);
        Mesh quad; // the emitter is next to the sphere, so much of its light arrives at grazing angles
        quad.positions = {{1.5f, -2, -2}, {1.5f, 2, -2}, {1.5f, 2, 2}, {1.5f, -2, 2}};
        quad.indices = {0, 2, 1, 0, 3, 2};
        scene.meshes.push_back(quad);
        scene.materials.push_back({{.base_color = grey(0), .emission = {1, 1, 1}}, "lamp"});
        scene.instances.push_back({"lamp", 1, 1, {}});
        Messages messages;
        const PreparedScene prepared = prepare_scene(scene, {}, messages);
        Queue queue = requested_queue();
        RenderSettings settings;
        settings.width = settings.height = 16;
        settings.samples = static_cast<uint32_t>(effort(32, 256)); // stratified samples count as four times as many
        settings.path.max_depth = 1;
        constexpr int kRenders = 24;
        double mean[3], variance[3];
        for (const LightStrategy strategy : {LightStrategy::Mis, LightStrategy::NeeOnly, LightStrategy::BsdfOnly}) {
            double sum = 0, squares = 0;
            for (int k = 0; k < kRenders; ++k) {
                settings.path.strategy = strategy;
                settings.path.seed = static_cast<uint32_t>(1000 * static_cast<int>(strategy) + k);
                const RenderResult result = render_picture(queue, prepared, front_camera(), settings);
                double value = 0;
                for (const float x : result.picture.pixels) value += static_cast<double>(x);
                value /= static_cast<double>(result.picture.pixels.size());
                sum += value;
                squares += value * value;
            }
            const auto s = static_cast<std::size_t>(strategy);
            mean[s] = sum / kRenders;
            variance[s] = (squares / kRenders - mean[s] * mean[s]) / (kRenders - 1);
        }
        for (const std::size_t s : {std::size_t(1), std::size_t(2)}) {
            const double error = std::sqrt(variance[0] + variance[s]);
            CAPTURE(s);
            CHECK(std::abs(mean[s] - mean[0]) < 4 * error);
            CHECK(error < 0.008 * mean[0]);
        }
    }
}
