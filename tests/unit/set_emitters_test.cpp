// Emitters set to watts, lumens, candela, lux and nits: their emission against sums over all directions.

#include <doctest/doctest.h>

#include "image/srgb_table.h"
#include "math/sampling.h"
#include "session/photometry.h"
#include "session/set_emitters.h"
#include "shading/light_set.h"
#include "shading/texture_lookup.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/random.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

constexpr double kEmitterPi = 3.14159265358979;

void set_emitter(Scene& scene, const std::string& text, double efficacy = kLumensPerWatt) {
    const EmitterStrength emitters[] = {parse_emitter(text)};
    set_emitters(scene, emitters, efficacy);
}

Scene emitter_scene() {
    Scene scene;
    Material glow = test::white();
    glow.name = "glow";
    glow.emission = {2, 1, 0.5f};
    test::add(scene, test::floor_at(0, 0.5f), glow);            // 1 m2
    test::add(scene, test::floor_at(1, 1), scene.materials[0]); // 4 m2
    scene.instances[1].material = 0;                            // shared
    scene.instances[0].name = "small";
    scene.instances[1].name = "large";
    scene.lights.push_back(test::point_light({0, 1, 0}, {1, 2, 3}));
    scene.lights.back().name = "bulb";
    scene.lights.push_back({.name = "spot",
                            .kind = LightKind::Spot,
                            .direction = {0, -1, 0},
                            .intensity = {1, 1, 1},
                            .cos_inner = 0.95f,
                            .cos_outer = 0.7f});
    scene.lights.push_back({.name = "sun", .kind = LightKind::Directional, .intensity = {0, 0, 0}});
    return scene;
}

double luminance_in(Rgb c) { return static_cast<double>(luminance(c)); }

/// Returns the lumens that a light emits, summed over 100000 rings of equal solid angle.
double flux_of(const Light& light, double efficacy) {
    const PunctualLight view = {light.kind, {}, light.direction, light.intensity, light.cos_inner, light.cos_outer, 0};
    constexpr int kRings = 100'000;
    double sum = 0;
    for (int i = 0; i < kRings; ++i) {
        const auto cosine = static_cast<float>(1 - 2 * (i + 0.5) / kRings);
        const Vec3 way = {sqrt(1 - cosine * cosine), -cosine, 0}; // about the direction down
        sum += static_cast<double>(punctual_falloff(view, -way, 1)) * luminance_in(light.intensity);
    }
    return 4 * kEmitterPi * sum / kRings * efficacy;
}

bool refuses_emitter(Scene& scene, const std::string& text) {
    return test::is_about(test::thrown_error([&] { set_emitter(scene, text); }), ErrorCode::BadInput, "lamp", text);
}

} // namespace

TEST_CASE("a light of 800 lm emits 800 lm, and one of 10 W emits 6830 lm") {
    for (const char* name : {"bulb", "spot"}) {
        for (const double efficacy : {1.0, kLumensPerWatt}) {
            CAPTURE(name);
            Scene scene = emitter_scene();
            const Light& light = scene.lights[name[0] == 'b' ? 0 : 1];
            set_emitter(scene, std::string(name) + "=800lm", efficacy);
            CHECK(flux_of(light, efficacy) == doctest::Approx(800).epsilon(1e-4));
            set_emitter(scene, std::string(name) + "=10 W", efficacy);
            CHECK(flux_of(light, efficacy) == doctest::Approx(6830).epsilon(1e-4));
        }
    }
}

TEST_CASE("lights keep their colour, and black ones become white") {
    Scene scene = emitter_scene();
    set_emitter(scene, "bulb=50cd", 1);
    const Rgb bulb = scene.lights[0].intensity;
    CHECK(luminance_in(bulb) == doctest::Approx(50));
    CHECK(bulb.g / bulb.r == doctest::Approx(2.0));
    CHECK(bulb.b / bulb.r == doctest::Approx(3.0));
    set_emitter(scene, "sun=100000lx");
    CHECK(luminance_in(scene.lights[2].intensity) == doctest::Approx(100000 / kLumensPerWatt));
    CHECK(scene.lights[2].intensity.r == scene.lights[2].intensity.b);
    set_emitter(scene, "sun=0lx");
    CHECK(is_black(scene.lights[2].intensity));
}

TEST_CASE("each surface gets the full amount, whatever its size, and a shared material is copied") {
    Scene scene = emitter_scene();
    set_emitter(scene, "glow=628.3185307lm", 1); // 200 pi
    REQUIRE(scene.instances[0].material != scene.instances[1].material);
    const auto emission = [&](int i) {
        return luminance_in(scene.materials[scene.instances[static_cast<std::size_t>(i)].material].emission);
    };
    CHECK(emission(0) == doctest::Approx(200)); // pi L A
    CHECK(emission(1) == doctest::Approx(50));
    set_emitter(scene, "large=8cd", 1);
    CHECK(emission(0) == doctest::Approx(200));
    CHECK(emission(1) == doctest::Approx(2));
    set_emitter(scene, "*a*=300nits");
    CHECK(emission(0) == doctest::Approx(300 / kLumensPerWatt));
    CHECK(emission(1) == doctest::Approx(300 / kLumensPerWatt));
    scene.materials[scene.instances[0].material].two_sided_emission = true;
    set_emitter(scene, "small=100lm", 1);
    CHECK(emission(0) == doctest::Approx(50 / kEmitterPi)); // each face emits half of it
    scene.environment = Environment{};
    set_emitter(scene, "environment=2000nits", 1);
    CHECK(luminance_in(scene.environment->scale) == doctest::Approx(2000));
}

TEST_CASE("invalid settings of an emitter are refused") {
    Scene scene = emitter_scene();
    for (const char* text : {"sun=800lm", "bulb=800lx", "small=8lx", "blub=800lm", "bulb", "=8lm", "bulb=8", "bulb=lm",
                             "bulb=-8lm", "bulb=8lmx", "bulb=nanlm", "bulb=1e300W"}) {
        CAPTURE(text);
        CHECK(refuses_emitter(scene, text));
    }
    Scene fine = scene;
    set_emitter(fine, "small=8cd");
    scene.meshes[0].positions[0].y = 1; // the surface is not flat
    CHECK(refuses_emitter(scene, "small=8cd"));
    fine = scene;
    set_emitter(fine, "small=8lm");
    scene.materials[0].alpha_mode = AlphaMode::Mask;
    CHECK(refuses_emitter(scene, "small=8lm"));
    const Rgb before = scene.materials[0].emission;
    scene.instances[0].is_hidden = scene.instances[1].is_hidden = true; // an environment has no area
    set_emitter(scene, "glow=8lm");
    CHECK(scene.materials[0].emission == before);
    scene.instances[0].is_hidden = scene.instances[1].is_hidden = false;
    scene.materials[0].alpha_mode = AlphaMode::Opaque;
    scene.images.resize(1);
    scene.images[0].rgba8 = {.width = 1, .height = 1, .pixels = {0, 0, 0, 255}};
    scene.materials[0].emission_texture.image = 0;
    CHECK(refuses_emitter(scene, "small=8lm"));
}

TEST_CASE("the flux of a textured emitter equals the path tracer's") {
    // A chessboard of red and grey with a blue cell, rotated, repeated and filtered.
    Scene scene = emitter_scene();
    scene.images.resize(1);
    Rgba8Image& image = scene.images[0].rgba8;
    image.width = 3, image.height = 2;
    for (int i = 0; i < 6; ++i) {
        for (const int c : {i % 2 == 0 ? 255 : 90, i % 2 == 0 ? 0 : 90, i == 5 ? 255 : 90, 255}) {
            image.pixels.push_back(static_cast<uint8_t>(c));
        }
    }
    Material& material = scene.materials[scene.instances[0].material];
    material.emission_texture.image = 0;
    material.emission_texture.is_srgb = true;
    material.emission_texture.m00 = 1.7f, material.emission_texture.m02 = 0.2f;
    Mesh& mesh = scene.meshes[scene.instances[0].mesh];
    mesh.uv[0].resize(mesh.positions.size());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        mesh.uv[0][i] = {mesh.positions[i].x + 0.3f * mesh.positions[i].z, mesh.positions[i].z};
    }
    set_emitter(scene, "small=500lm", 1);
    const Material& lit = scene.materials[scene.instances[0].material];
    // The mean over points that are distributed evenly on the surface.
    const TextureImageView view = view_of(scene.images[0]);
    test::Random random(5);
    double sum = 0, area = 0;
    constexpr int kDraws = 200'000;
    for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
        const uint32_t* at = mesh.indices.data() + t;
        const auto world = [&](uint32_t v) {
            return transform_point(scene.instances[0].world_from_local, mesh.positions[v]);
        };
        const double size =
            0.5 * static_cast<double>(length(cross(world(at[1]) - world(at[0]), world(at[2]) - world(at[0]))));
        double mean = 0;
        for (int i = 0; i < kDraws; ++i) {
            const Vec2 b = sample_uniform_triangle(Vec2{random.unit(), random.unit()});
            const Vec2 uv = (1 - b.x - b.y) * mesh.uv[0][at[0]] + b.x * mesh.uv[0][at[1]] + b.y * mesh.uv[0][at[2]];
            const Vec4 c = lookup_texture(&view, lit.emission_texture, uv, srgb_decode_table().data());
            mean += luminance_in({c.x * lit.emission.r, c.y * lit.emission.g, c.z * lit.emission.b}) / kDraws;
        }
        sum += size * mean;
        area += size;
    }
    CHECK(kEmitterPi * sum == doctest::Approx(500).epsilon(5e-3));
    CHECK(luminance_in(lit.emission) > 1.3 * 500 / (kEmitterPi * area)); // the texture absorbs a part of the light
}

TEST_CASE("a camera's exposure follows the standard") {
    const PhysicalExposure sunny = {.iso = 100, .f_number = 16, .shutter_s = 0.01};
    CHECK(exposure_value(sunny) == doctest::Approx(14.6439).epsilon(1e-5)); // log2 25600
    CHECK(exposure_value({.iso = 400, .f_number = 16, .shutter_s = 0.01}) == doctest::Approx(12.6439).epsilon(1e-5));
    CHECK(exposure_value({.iso = 100, .f_number = 1, .shutter_s = 1}) == doctest::Approx(0));
    // The film's white is at 1.2 times 2^EV cd/m2.
    const double white = 1.2 * 25600;
    for (const double efficacy : {1.0, kLumensPerWatt}) {
        const double stops = static_cast<double>(exposure_stops(sunny, efficacy));
        CHECK(white / efficacy * std::exp2(stops) == doctest::Approx(1).epsilon(1e-5));
    }
    CHECK(lumens_per_watt("x.GLB") == 1);
    CHECK(lumens_per_watt("x.obj") == 683);
    CHECK(lumens_per_watt("cornell-box") == 683);
    CHECK(lumens_per_watt("x.gltf", 90) == 90);
}
