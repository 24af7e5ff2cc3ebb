// Light meters against closed forms: area and point lights, an environment, a glowing room. The standard error is
// tested, too.

#include <cmath>

#include <doctest/doctest.h>

#include "session/measure_irradiance.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/meshes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

constexpr double kPiExact = 3.14159265358979323846;
constexpr MeterPoint kUpwards = {{0, 0, 0}, {0, 1, 0}};

RenderSettings samples_of(uint32_t samples, uint32_t seed = 0) {
    RenderSettings settings;
    settings.samples = samples;
    settings.path.seed = seed;
    return settings;
}

struct Room {
    Scene scene;
    PreparedScene prepared;

    explicit Room(Scene made) : scene(std::move(made)) {
        Messages messages;
        prepared = prepare_scene(scene, {}, messages);
    }
    Room(const Room&) = delete;
    Room& operator=(const Room&) = delete;

    Irradiance measure(const MeterPoint& point, const RenderSettings& settings) const {
        Queue queue = test::requested_queue();
        return measure_irradiance(queue, prepared, point, settings);
    }
};

/// Allows five standard errors, and a 50000th for rounding.
void check_measured(const Measured& measured, double wanted, double error_share) {
    CAPTURE(measured.value);
    CAPTURE(measured.standard_error);
    CAPTURE(wanted);
    CHECK(std::abs(measured.value - wanted) <= 5 * measured.standard_error + 2e-5 * wanted);
    CHECK(measured.standard_error <= error_share * wanted);
}

Material black_emitter(float radiance) { return {{.base_color = {0, 0, 0}, .emission = grey(radiance)}, "lamp"}; }

/// Makes a disc that faces down, about (0, height, 0). Its corners lie slightly outside the circle, so that it has the
/// circle's area.
Mesh disc(float radius, float height) {
    constexpr uint32_t kCorners = 256;
    const double step = 2 * kPiExact / kCorners, out = static_cast<double>(radius) * std::sqrt(step / std::sin(step));
    Mesh mesh;
    mesh.positions.push_back({0, height, 0});
    for (uint32_t i = 0; i < kCorners; ++i) {
        mesh.positions.push_back(
            {static_cast<float>(out * std::cos(i * step)), height, static_cast<float>(out * std::sin(i * step))});
        mesh.indices.insert(mesh.indices.end(), {0, 1 + i, 1 + (i + 1) % kCorners});
    }
    return mesh;
}

/// A disc light over a floor on which the meter lies.
Scene disc_over_floor() {
    Scene scene;
    test::add(scene, disc(0.5f, 2), black_emitter(10));
    test::add(scene, test::floor_at(0, 5), test::white(0.8f));
    return scene;
}
constexpr double kUnderDisc = kPiExact * 10 * 0.25 / (0.25 + 4); // pi L R^2 / (R^2 + h^2)

} // namespace

TEST_CASE("under a disc a meter reads pi L R^2 / (R^2 + h^2), unshadowed by the floor below it") {
    const Room room(disc_over_floor());
    const Irradiance irradiance = room.measure(kUpwards, samples_of(4));
    check_measured(irradiance.luminance, kUnderDisc, 2e-3);
    CHECK(irradiance.invalid_paths == 0);
    CHECK(irradiance.paths == 4 * kMeterRepeats * kMeterSide * kMeterSide);
    CHECK(room.measure({{0, 0, 0}, {0, -2, 0}}, samples_of(1)).luminance.value == 0); // the meter faces away
}

TEST_CASE("under a rectangle a meter matches the closed form in each channel") {
    Scene scene;
    Material emitter = black_emitter(1);
    emitter.emission = {1, 2, 3};
    test::add(scene, test::sheet({0, 2, 0}, {0.5f, 0, 0}, {0, 0, 1}), emitter);
    const Room room(std::move(scene));
    const auto part = [](double a, double b) {
        const double c = std::sqrt(a * a + 4);
        return a / c * std::atan(b / c);
    };
    const double wanted = 2 * (part(0.5, 1) + part(1, 0.5));
    const Irradiance irradiance = room.measure(kUpwards, samples_of(4));
    for (int k = 0; k < 3; ++k) check_measured(irradiance.rgb[k], (k + 1) * wanted, 2e-3);
    check_measured(irradiance.luminance, (0.2126 + 2 * 0.7152 + 3 * 0.0722) * wanted, 2e-3);
}

TEST_CASE("a point light gives I cos / r^2 without an error, a directional one its irradiance times the cosine") {
    Scene point;
    point.lights.push_back(test::point_light({1, 2, 0.5f}, {5, 5, 5}));
    const Room under_point(std::move(point));
    check_measured(under_point.measure(kUpwards, samples_of(1)).luminance, 5 * 2 / std::pow(5.25, 1.5), 1e-7);

    Scene sun;
    Light light;
    light.kind = LightKind::Directional;
    light.direction = normalize(Vec3{0, -4, 3});
    light.intensity = {100, 100, 100};
    sun.lights.push_back(light);
    const Room under_sun(std::move(sun));
    check_measured(under_sun.measure(kUpwards, samples_of(1)).luminance, 80, 1e-7);
}

TEST_CASE("under an environment of radiance 1 a meter reads pi in every direction") {
    Scene scene;
    scene.environment.emplace();
    const Room room(std::move(scene));
    for (const Vec3 normal : {Vec3{0, 1, 0}, Vec3{0, 0, -1}, Vec3{3, -2, 1}}) {
        check_measured(room.measure({{1, 2, 3}, normal}, samples_of(1)).luminance, kPiExact, 4e-3);
    }
}

TEST_CASE("in a glowing room a meter reads all scattered light up to the max depth") {
    const test::TriangleMesh sphere = test::make_sphere(2, {0, 0, 0}, 2.0f);
    Mesh mesh;
    mesh.positions = sphere.positions;
    mesh.indices = sphere.indices;
    Scene scene;
    test::add(scene, mesh, {{.two_sided_emission = true, .base_color = grey(0.5f), .emission = {1, 1, 1}}, "wall"});
    const Room room(std::move(scene));
    const MeterPoint point = {{0.3f, 0.2f, -0.5f}, {1, 0.4f, 0.1f}};
    RenderSettings settings = samples_of(2);
    for (const auto& [depth, wanted] : {std::pair(0u, 1.0), {1u, 1.5}, {60u, 2.0}}) {
        settings.path.max_depth = depth;
        check_measured(room.measure(point, settings).luminance, wanted * kPiExact, 5e-3);
    }
}

TEST_CASE("a meter refuses a normal without direction and a seed that repeats another seed's estimates") {
    const auto refusal = [](Vec3 normal, uint32_t seed) {
        return test::thrown_error([&] { check_meter({{0, 0, 0}, normal}, seed); });
    };
    CHECK(!refusal({0, 2, 0}, kMaxMeterSeed));
    CHECK(test::is_about(refusal({0, 0, 0}, 0), ErrorCode::BadInput, "normal", "0,0,0"));
    CHECK(test::is_about(refusal({0, 1e-30f, 0}, 0), ErrorCode::BadInput, "normal", "0,1e-30,0"));
    CHECK(test::is_about(refusal({0, 1, 0}, kMaxMeterSeed + 1), ErrorCode::BadInput, "seed"));
}

TEST_CASE("the error of a measurement matches the deviation of measurements with other seeds") {
    const Room room(disc_over_floor());
    constexpr uint32_t kSeeds = 24;
    double squares = 0;
    for (uint32_t seed = 0; seed < kSeeds; ++seed) {
        const Measured measured = room.measure(kUpwards, samples_of(1, seed)).luminance;
        squares += std::pow((measured.value - kUnderDisc) / measured.standard_error, 2);
    }
    // This mean of kSeeds squares has the expectation 31 / 29 and the standard error 0.33.
    CHECK(squares / kSeeds > 0.3);
    CHECK(squares / kSeeds < 2.4);
}

TEST_CASE("a meter reads the same bits in both schedules of the path tracer and on both devices") {
    const Room room(test::make_mixed_scene());
    const MeterPoint point = {{0.1f, 0.02f, 0.2f}, {0.2f, 1, 0}};
    RenderSettings settings = samples_of(1);
    settings.body = PathBody::Loop;
    Queue cpu = Queue::make_cpu();
    const Irradiance one = measure_irradiance(cpu, room.prepared, point, settings);
    settings.body = PathBody::Wavefront;
    const Irradiance other = room.measure(point, settings);
    CHECK(one.luminance.value > 0);
    CHECK(one.rays.shadow == other.rays.shadow);
    for (int k = 0; k < 3; ++k) {
        CHECK(one.rgb[k].value == other.rgb[k].value);
        CHECK(one.rgb[k].standard_error == other.rgb[k].standard_error);
    }
}
