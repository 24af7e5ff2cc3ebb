// The light set against closed forms: irradiance at a point from every kind of light, alone and together, and the
// densities for multiple importance sampling. Occlusion is not tested here; it belongs to the integrator.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "math/random.h"
#include "math/sampler.h"
#include "tests/support/chi_square.h"
#include "tests/support/estimate.h"
#include "tests/support/lit_scenes.h"
#include "tests/support/options.h"
#include "tests/support/random.h"

using namespace pertev;
using namespace pertev::test;

namespace {

/// Gives the scene's last material an emission texture of n x n checkered squares, starting with black.
void add_checkers(Scene& scene, uint32_t n, TextureFilter filter) {
    TextureImage image;
    image.rgba8 = {n, n, {}};
    for (uint32_t i = 0; i < n * n; ++i) {
        const uint8_t value = (i % n + i / n) % 2 == 0 ? 0 : 255;
        image.rgba8.pixels.insert(image.rgba8.pixels.end(), {value, value, value, 255});
    }
    scene.images.push_back(image);
    TextureRef& ref = scene.materials.back().emission_texture;
    ref.image = static_cast<int32_t>(scene.images.size() - 1);
    ref.filter = filter;
}

/// The probability that sample_light draws a light, in the order of triangles, punctual lights and the environment.
float light_pmf(const LightSetView& view, uint32_t light) {
    if (view.choice.starts == nullptr) return 0;
    if (light < view.triangle_count) return view.triangles[light].pmf;
    return cdf_pmf(view.choice, view.emitter_count + light - view.triangle_count);
}

/// Estimates the irradiance (red) at the origin on a surface that faces `normal`, by sample_light.
Estimate irradiance(const LightSetView& view, Vec3 point, Vec3 normal, uint64_t draws, uint32_t seed) {
    Random random(seed);
    double sum = 0, squares = 0;
    for (uint64_t i = 0; i < draws; ++i) {
        LightSample sample;
        if (!sample_light(view, point, random_bits(random), sample)) continue;
        REQUIRE(sample.pdf > 0);
        const double value = as_double(max(dot(sample.wi, normal), 0.0f)) * as_double(sample.radiance.r / sample.pdf);
        sum += value;
        squares += value * value;
    }
    const double n = static_cast<double>(draws), mean = sum / n;
    return {mean, std::sqrt(std::max(0.0, squares / n - mean * mean) / n)};
}

void check_irradiance(const LightSetView& view, double exact, uint64_t draws = 100'000) {
    const Estimate got = irradiance(view, {0, 0, 0}, {0, 1, 0}, draws, 1);
    CAPTURE(got.mean);
    CAPTURE(got.error);
    CHECK(std::abs(got.mean - exact) <= 4 * got.error + 1e-5 * exact);
}

/// Returns the irradiance from a rectangle with half sides a and b, parallel to the surface and centred at height h
/// above it.
double rectangle_irradiance(double a, double b, double h, double radiance) {
    const double x = a / h, y = b / h, p = std::sqrt(1 + x * x), q = std::sqrt(1 + y * y);
    return 2 * radiance * (x / p * std::atan(y / p) + y / q * std::atan(x / q));
}

/// Returns the number of the quarter that contains a point. The midpoints of a triangle's edges divide it into four.
uint32_t quarter(float b1, float b2) { return b1 > 0.5f ? 1 : b2 > 0.5f ? 2 : b1 + b2 < 0.5f ? 3 : 0; }

uint32_t octant(Vec3 w) { return (w.x > 0 ? 1u : 0u) + (w.y > 0 ? 2u : 0u) + (w.z > 0 ? 4u : 0u); }

Light make_light(LightKind kind, Vec3 position, Vec3 direction) {
    Light light;
    light.kind = kind;
    light.position = position;
    light.direction = direction;
    return light;
}

} // namespace

TEST_CASE("lights: a square of few or many triangles, moved and scaled, gives its closed-form irradiance") {
    for (const uint32_t n : {1u, 64u}) { // 64: 8192 triangles
        Scene scene;
        const Transform place = compose(make_translation({0, 2, 0}), make_scale({1.5f, 7, 0.5f}));
        add_emitter(scene, make_square(n), {3, 1, 0}, place);
        const Lights lights(scene);
        CHECK(lights.view.triangle_count == 2 * n * n);
        CAPTURE(n);
        check_irradiance(lights.view, rectangle_irradiance(1.5, 0.5, 2, 3));
    }
}

TEST_CASE("lights: a triangle emits from its front, even under a mirroring node, or from both faces") {
    const double full = rectangle_irradiance(1, 1, 1, 1);
    for (const uint32_t bits : {0u, 1u, 2u, 3u, 4u, 5u, 6u, 7u}) {
        const bool is_turned = (bits & 1) != 0, is_mirrored = (bits & 2) != 0, is_two_sided = (bits & 4) != 0;
        Scene scene;
        Mesh square = make_square(2);
        if (is_turned) std::ranges::reverse(square.indices);
        const Transform mirror = make_scale({is_mirrored ? -1.0f : 1.0f, 1, 1});
        add_emitter(scene, square, {1, 1, 1}, compose(make_translation({0, 1, 0}), mirror));
        scene.materials[0].two_sided_emission = is_two_sided;
        const Lights lights(scene);
        const bool shines_down = is_two_sided || !is_turned, shines_up = is_two_sided || is_turned;
        check_irradiance(lights.view, shines_down ? full : 0);
        const Estimate above = irradiance(lights.view, {0, 2, 0}, {0, -1, 0}, 20'000, 2);
        CHECK(std::abs(above.mean - (shines_up ? full : 0)) <= 4 * above.error);
        CHECK((pdf_light_hit(lights.view, 0, Vec3{0, 0, 0}, {-0.5f, 1, -0.5f}) > 0) == shines_down);
        CHECK((pdf_light_hit(lights.view, 0, Vec3{0, 2, 0}, {-0.5f, 1, -0.5f}) > 0) == shines_up);
    }
}

TEST_CASE("lights: a one-sided triangle is sampled half as often as a two-sided one") {
    Scene scene;
    for (const float height : {1.0f, 3.0f})
        add_emitter(scene, make_square(1), {1, 1, 1}, make_translation({0, height, 0}));
    scene.materials[1].two_sided_emission = true;
    const Lights lights(scene);
    CHECK(light_pmf(lights.view, 2) == doctest::Approx(2 * as_double(light_pmf(lights.view, 0))));
}

TEST_CASE("lights: emission follows its texture") {
    for (const TextureFilter filter : {TextureFilter::Nearest, TextureFilter::Linear}) {
        Scene scene;
        add_emitter(scene, make_square(1), {2, 2, 2}, make_translation({0, 1, 0}));
        add_checkers(scene, 4, filter);
        const Lights lights(scene);
        // Sums cos^2 / d^2 over points of the square.
        double exact = 0;
        constexpr int steps = 400;
        for (int i = 0; i < steps; ++i) {
            for (int j = 0; j < steps; ++j) {
                const double u = (i + 0.5) / steps, v = (j + 0.5) / steps, x = 2 * u - 1, z = 2 * v - 1;
                const Rgb radiance = surface_emission(lights.view, 0, {static_cast<float>(u), static_cast<float>(v)});
                exact += as_double(radiance.r) * 4 / (steps * steps) / std::pow(x * x + z * z + 1, 2);
            }
        }
        check_irradiance(lights.view, exact);
    }
}

TEST_CASE("lights: a triangle with one bright texel is sampled, and a black one is not") {
    Random random(8);
    int drawn = 0, dark = 0;
    for (int i = 0; i < 400; ++i) {
        constexpr uint32_t width = 300, height = 200;
        Scene scene;
        Mesh mesh = make_square(1);
        const auto coordinate = [&] { return static_cast<float>(random.below(2000)) / 500.0f - 2.0f; };
        const Vec2 corner = {coordinate(), coordinate()};
        const float side = i % 2 == 0 ? 0.1f : 0.7f;
        for (Vec2& uv : mesh.uv[0]) uv = corner + side * uv;
        add_emitter(scene, mesh, {1, 1, 1}, make_translation({0, 1, 0}));
        TextureImage image;
        image.rgba8 = {width, height, std::vector<uint8_t>(std::size_t(4) * width * height)};
        image.rgba8.pixels[4 * random.below(width * height)] = 255;
        scene.images.push_back(image);
        TextureRef& ref = scene.materials[0].emission_texture;
        ref.image = 0;
        ref.wrap_s = ref.wrap_t = static_cast<Wrap>(i % 3);
        ref.filter = i % 5 == 0 ? TextureFilter::Nearest : TextureFilter::Linear;
        const Lights lights(scene);

        std::array<bool, 2> is_lit{};             // all parts of each triangle
        const int steps = i % 2 == 0 ? 100 : 300; // shorter than a texel
        for (int a = 0; a <= steps; ++a) {
            for (int b = 0; a + b <= steps; ++b) {
                const float b1 = static_cast<float>(a) / static_cast<float>(steps),
                            b2 = static_cast<float>(b) / static_cast<float>(steps);
                for (std::size_t k = 0; k < 2; ++k) {
                    if (is_lit[k]) continue;
                    const EmissiveTriangle& t = lights.view.triangles[k];
                    const Vec2 uv = (1 - b1 - b2) * t.uv0 + b1 * t.uv1 + b2 * t.uv2;
                    if (!is_black(surface_emission(lights.view, 0, uv))) is_lit[k] = true;
                }
            }
        }
        for (uint32_t k = 0; k < 2; ++k) {
            const bool is_drawn = light_pmf(lights.view, k) > 0;
            CAPTURE(i);
            if (is_lit[k]) CHECK(is_drawn);
            drawn += is_drawn ? 1 : 0;
            dark += is_drawn ? 0 : 1;
        }
    }
    CHECK(drawn > 40);
    CHECK(dark > 100);
}

TEST_CASE("lights: triangles of a textured mesh are sampled by their emission") {
    Scene scene;
    add_emitter(scene, make_square(16), {1, 1, 1}, make_translation({0, 1, 0}));
    add_checkers(scene, 4, TextureFilter::Nearest);
    const Lights lights(scene);
    double on_bright = 0;
    for (uint32_t i = 0; i < lights.view.triangle_count; ++i) {
        const EmissiveTriangle& t = lights.view.triangles[i];
        const Vec2 centre = 0.25f * (t.uv0 + t.uv1) + 0.5f * t.uv2;
        if (!is_black(surface_emission(lights.view, 0, centre))) on_bright += as_double(light_pmf(lights.view, i));
    }
    CHECK(on_bright > 0.8); // some dark triangles touch a bright square
}

TEST_CASE("lights: point, spot and directional lights match their definitions") {
    const Vec3 above = {0, 2, 0}, down = {0, -1, 0};
    LightSample sample;
    Scene scene;
    const auto only = [&](const Light& light) {
        scene.lights = {light};
        const Lights lights(scene);
        const bool is_lit = sample_light(lights.view, Vec3{0, 0, 0}, {0x80000000u, 0x80000000u}, sample);
        if (is_lit) {
            CHECK(sample.pdf == 1);
            CHECK(sample.is_delta);
            CHECK(sample.instance == kNoLight);
        }
        return is_lit ? as_double(sample.radiance.r) : 0.0;
    };
    Light point = make_light(LightKind::Point, above, down);
    point.intensity = {8, 1, 1};
    CHECK(only(point) == doctest::Approx(2));
    CHECK(sample.wi == Vec3{0, 1, 0});
    CHECK(sample.distance == 2);
    CHECK(sample.light_point == above);
    point.range = 4;
    CHECK(only(point) == doctest::Approx(2 * (1 - 1.0 / 16)));
    point.range = 1.9f;
    CHECK(only(point) == 0);

    Light directional = make_light(LightKind::Directional, {}, {0, -0.6f, 0.8f});
    directional.intensity = {5, 1, 1};
    CHECK(only(directional) == doctest::Approx(5));
    CHECK(sample.wi == Vec3{0, 0.6f, -0.8f});
    CHECK(sample.distance == kInfinity);

    Light spot = make_light(LightKind::Spot, above, down);
    spot.intensity = {8, 1, 1};
    spot.cos_inner = 0.9f, spot.cos_outer = 0.5f;
    CHECK(only(spot) == doctest::Approx(2));
    spot.direction = {0.8f, -0.6f, 0}; // the origin is off the axis by a cosine of 0.6: a quarter of the way in
    CHECK(only(spot) == doctest::Approx(2.0 / 16));
    spot.direction = {1, 0, 0};
    CHECK(only(spot) == 0);
    spot.direction = down;
    spot.cos_inner = spot.cos_outer = 1; // the cone has no width
    CHECK(std::isfinite(only(spot)));
}

TEST_CASE("lights: rays that a punctual light emits carry its power") {
    const WorldSphere world = {{1, 2, 3}, 5};
    Light like;
    PunctualLight light;
    light.position = {1, 0, 2}, light.direction = {0.6f, 0, -0.8f}, light.intensity = {3, 2, 1};
    like.cos_inner = light.cos_inner = 0.9f, like.cos_outer = light.cos_outer = 0.5f;
    constexpr int kSide = 300;
    for (const LightKind kind : {LightKind::Point, LightKind::Spot, LightKind::Directional}) {
        like.kind = light.kind = kind;
        double watts = 0;
        for (int i = 0; i < kSide * kSide; ++i) {
            const auto middle = [](int cell) { return (static_cast<float>(cell) + 0.5f) / kSide; };
            const PunctualEmission emission = emit_from(light, world, {middle(i % kSide), middle(i / kSide)}, {});
            REQUIRE(1 - dot(emission.direction, light.direction) <= depth_of_beam(light) + 1e-6f);
            if (kind == LightKind::Directional) REQUIRE(length(emission.from - world.centre) >= 4.999f);
            watts += static_cast<double>(emitted_power(light, emission, 0.5f, {}).r) / (2.0 * kSide * kSide);
        }
        CHECK(watts == doctest::Approx(punctual_power(like, 3, 5)).epsilon(1e-3));
    }
    CHECK(punctual_power(like, 3, 5) == doctest::Approx(25 * 3 * 3.14159265358979)); // the power through the disc in W
    like.kind = LightKind::Point;
    CHECK(punctual_power(like, 3, 5) == doctest::Approx(4 * 3 * 3.14159265358979));
}

TEST_CASE("lights: all kinds add up, near and far") {
    Scene scene;
    add_emitter(scene, make_square(1), {3, 1, 0}, make_translation({0, 1, 0}));
    add_emitter(scene, make_square(40), {1, 1, 1}, make_translation({0, 3, 0}));
    scene.lights = {make_light(LightKind::Point, {0, 2, 0}, {}), make_light(LightKind::Spot, {0, 4, 0}, {0, -1, 0}),
                    make_light(LightKind::Directional, {}, {0, -1, 0})};
    for (const float sky : {1e-5f, 0.25f, 1e4f}) {
        scene.environment = Environment{};
        scene.environment->scale = {sky, sky, sky};
        Lights lights(scene);
        double exact = rectangle_irradiance(1, 1, 1, 3) + rectangle_irradiance(1, 1, 3, 1);
        exact += 1.0 / 4 + 1.0 / 16 + 1 + std::numbers::pi * as_double(sky);
        CAPTURE(sky);
        for (const double share : {0.5, 0.1, 31.0 / 32}) {
            share_draws(lights.data, share);
            lights.view = view_of(lights.data, lights.images.data(), kTable.data());
            CAPTURE(share);
            check_irradiance(lights.view, exact, 400'000);
            double sum = 0, far_sum = 0;
            const uint32_t first_punctual = lights.view.triangle_count;
            for (uint32_t i = 0; i < lights.data.count(); ++i) {
                const double pmf = as_double(light_pmf(lights.view, i));
                CHECK(pmf > 0);
                sum += pmf;
                if (i >= first_punctual + 2) far_sum += pmf;
            }
            CHECK(sum == doctest::Approx(1).epsilon(1e-6));
            CHECK(far_sum == doctest::Approx(share).epsilon(1e-6));
        }
    }
}

TEST_CASE("lights: samples follow the density over eight decades of power, for each triangle and the sky") {
    const auto draws = static_cast<uint32_t>(effort(1'000'000, 10'000'000));
    for (const uint32_t count : {100u, 3000u}) {
        Random random(count);
        Scene scene;
        for (uint32_t i = 0; i < count; ++i) {
            Mesh mesh;
            for (int k = 0; k < 3; ++k) mesh.positions.push_back(random.point(1, 2));
            mesh.indices = {0, 1, 2};
            add_emitter(scene, mesh, grey(std::pow(10.0f, random.within(-8, 0))), {});
            scene.materials.back().two_sided_emission = true; // half of them face away from the origin
        }
        scene.environment = Environment{};
        const Lights lights(scene);
        REQUIRE(lights.view.triangle_count == count);
        // Each triangle has four cells of equal area, and the sky eight octants.
        std::vector<double> observed(4 * std::size_t(count) + 8), expected;
        for (uint32_t light = 0; light <= count; ++light) {
            const uint32_t cells = light < count ? 4 : 8;
            expected.insert(expected.end(), cells, draws * as_double(light_pmf(lights.view, light)) / cells);
        }
        for (uint32_t i = 0; i < draws; ++i) {
            const Hash4 h = hash_words(i, count, 1, 2);
            LightSample sample;
            if (!sample_light(lights.view, Vec3{0, 0, 0}, {h.x, h.y}, sample)) continue;
            const bool from_sky = sample.instance == kNoLight;
            const uint32_t light = from_sky ? count : light_of(lights.view, sample.instance, sample.primitive);
            observed[4 * std::size_t(light) + (from_sky ? octant(sample.wi) : quarter(sample.b1, sample.b2))] += 1;
        }
        double drawn = 0;
        for (const double n : observed) drawn += n;
        CHECK(drawn == draws);
        // Lights that are too dim to be counted singly are compared by the decade of their probability.
        std::vector<double> observed_decades(40), expected_decades(40);
        for (std::size_t i = 0; i < expected.size(); ++i) {
            const auto decade = static_cast<std::size_t>(std::max(0.0, -std::log10(expected[i] / draws)));
            observed_decades[std::min<std::size_t>(decade, 39)] += observed[i];
            expected_decades[std::min<std::size_t>(decade, 39)] += expected[i];
        }
        CAPTURE(count);
        const ChiSquareResult cells = test::chi_square(observed, expected);
        const ChiSquareResult decades = test::chi_square(observed_decades, expected_decades);
        CHECK_MESSAGE(cells.passes(4), cells.describe());
        CHECK_MESSAGE(decades.passes(4), "by decades: ", decades.describe());
    }
}

TEST_CASE("lights: density at a point or direction equals that of its sample") {
    Scene scene;
    add_emitter(scene, make_square(50), {3, 1, 0}, compose(make_translation({0, 1, 0}), make_scale({2, 1, 1})));
    scene.environment = Environment{};
    scene.environment->image = {8, 4, 3, std::vector<float>(96, 1.0f)};
    for (std::size_t i = 0; i < 48; ++i) scene.environment->image.pixels[i] = 4;
    const Lights lights(scene);
    Random random(6);
    uint64_t on_triangles = 0, from_sky = 0, sky_differs = 0;
    for (int i = 0; i < 50'000; ++i) {
        const Vec3 from = {random.unit() - 0.5f, -random.unit(), random.unit()};
        LightSample sample;
        if (!sample_light(lights.view, from, random_bits(random), sample)) continue;
        CHECK_FALSE(sample.is_delta);
        if (sample.instance == kNoLight) {
            ++from_sky;
            const float pdf = pdf_environment(lights.view, Vec3{0, 0, 0}, sample.wi);
            if (std::abs(pdf - sample.pdf) > 1e-5f * sample.pdf) ++sky_differs;
            continue;
        }
        ++on_triangles;
        const uint32_t light = light_of(lights.view, sample.instance, sample.primitive);
        REQUIRE(light < lights.view.triangle_count);
        CHECK(pdf_light_hit(lights.view, light, from, sample.light_point) == sample.pdf);
        CHECK(as_double(length(sample.light_point - from)) == doctest::Approx(as_double(sample.distance)));
        const EmissiveTriangle& triangle = lights.view.triangles[light];
        const Vec3 again = triangle.a + sample.b1 * triangle.ab + sample.b2 * triangle.ac;
        CHECK(length(again - sample.light_point) < 1e-6f);
        CHECK(std::abs(sample.light_normal.y) > 0.99999f);
    }
    CHECK(on_triangles > 5000);
    CHECK(from_sky > 5000);
    CHECK(sky_differs < from_sky / 500);
}

TEST_CASE("lights: the density of directions to a triangle integrates to its probability") {
    Scene scene;
    add_emitter(scene, make_square(1), {1, 1, 1}, make_translation({0, 1, 0}));
    scene.lights = {make_light(LightKind::Point, {0, 2, 0}, {})};
    const Lights lights(scene);
    // Directions are points in the square's plane, where the solid angle is cos^3 times the area at height 1.
    double integral = 0;
    constexpr int steps = 500;
    for (int i = 0; i < steps; ++i) {
        for (int j = 0; j < steps; ++j) {
            const double x = 2 * (i + 0.5) / steps - 1, z = 2 * (j + 0.5) / steps - 1;
            const Vec3 hit = {static_cast<float>(x), 1, static_cast<float>(z)};
            const uint32_t light = i + j < steps ? 0 : 1;
            integral += 4.0 / (steps * steps) / std::pow(x * x + z * z + 1, 1.5) *
                        as_double(pdf_light_hit(lights.view, light, Vec3{0, 0, 0}, hit));
        }
    }
    CHECK(integral == doctest::Approx(1 - as_double(light_pmf(lights.view, 2))).epsilon(1e-4));
}

TEST_CASE("lights: a hit finds its light by instance and primitive, and unlit or dark instances have none") {
    Scene scene;
    add_emitter(scene, make_square(2), {0, 0, 0}, {});
    add_emitter(scene, make_square(3), {1, 0, 0}, {});
    add_emitter(scene, make_square(1), {1, 1, 1}, {});
    scene.materials[2].kind = MaterialKind::Unlit;
    add_emitter(scene, make_square(2), {0, 0, 1}, make_translation({5, 0, 0}));
    const Lights lights(scene);
    REQUIRE(lights.view.triangle_count == 18 + 8);
    CHECK(light_of(lights.view, 0, 3) == kNoLight);
    CHECK(light_of(lights.view, 2, 0) == kNoLight);
    for (uint32_t primitive = 0; primitive < 8; ++primitive) {
        const uint32_t light = light_of(lights.view, 3, primitive);
        CHECK(light == 18 + primitive);
        CHECK(lights.view.triangles[light].instance == 3);
        CHECK(lights.view.triangles[light].primitive == primitive);
        CHECK(lights.view.triangles[light].material == 3);
    }
    CHECK(surface_emission(lights.view, 2, {}) == Rgb{});
    CHECK(light_of(lights.view, 1, 17) == 17);

    Scene dark;
    add_emitter(dark, make_square(2), {0, 0, 0}, {});
    CHECK(light_of(Lights(dark).view, 0, 0) == kNoLight);
}

TEST_CASE("lights: unlit points yield no sample, and no value is infinite or NaN") {
    LightSample sample;
    Scene empty;
    const Lights none(empty);
    CHECK_FALSE(sample_light(none.view, Vec3{0, 0, 0}, {0x80000000u, 0x80000000u}, sample));
    CHECK(pdf_environment(none.view, Vec3{0, 0, 0}, {0, 1, 0}) == 0);

    Scene scene;
    Mesh mesh = make_square(1);
    mesh.positions.push_back(mesh.positions[0]);
    mesh.uv[0].push_back({});
    mesh.indices.insert(mesh.indices.end(), {0, 4, 1}); // the square has no area
    add_emitter(scene, mesh, {1, 1, 1}, {});
    scene.lights = {make_light(LightKind::Point, {0, 1, 0}, {})};
    const Lights lights(scene);
    CHECK(light_pmf(lights.view, 2) == 0);
    Random random(7);
    for (int i = 0; i < 20'000; ++i) {
        // Points are in the plane of the square, on it, at the point light, and next to them.
        const float tiny = i % 2 == 0 ? 0.0f : 1e-38f;
        const Vec3 from = i % 3 == 0 ? Vec3{0, 1 + tiny, 0} : Vec3{3 * random.unit(), tiny, random.unit() - 0.5f};
        if (!sample_light(lights.view, from, random_bits(random), sample)) continue;
        CHECK(sample.primitive != 2);
        CHECK(is_finite(sample.wi));
        CHECK(is_finite(sample.radiance));
        CHECK(is_finite(sample.pdf));
        CHECK(sample.pdf > 0);
    }
    CHECK(pdf_light_hit(lights.view, 0, Vec3{0, 0, 0}, {0, 0, 0}) == 0);
    CHECK(pdf_light_hit(lights.view, 2, Vec3{0, 1, 0}, mesh.positions[0]) == 0);
}
