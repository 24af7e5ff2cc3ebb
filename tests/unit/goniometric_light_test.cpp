// Lights whose intensity follows a table: values, sampling, and the frame of the table.

#include <algorithm>
#include <array>
#include <cmath>

#include <doctest/doctest.h>

#include "math/sampling.h"
#include "session/set_emitters.h"
#include "tests/support/lit_scenes.h"
#include "tests/support/random.h"

using namespace pertev;

namespace {

/// A table with values that differ in all cells and channels.
IntensityTable varied_table(TableLayout layout, TableFilter filter, uint32_t width, uint32_t height) {
    IntensityTable table;
    table.layout = layout;
    table.filter = filter;
    table.half_width = 0.8f, table.half_height = 0.5f;
    table.values = {.width = width, .height = height, .channels = 3, .pixels = {}};
    for (uint32_t i = 0; i < 3 * width * height; ++i)
        table.values.pixels.push_back(i % 7 == 3 ? 0.0f : static_cast<float>((i * 37) % 11 + 1));
    return table;
}

Light goniometric_light(IntensityTable table) {
    Light light;
    float greatest = 0;
    light.kind = LightKind::Goniometric;
    light.table = make_intensity_table(std::move(table), greatest);
    light.intensity = grey(greatest);
    light.direction = normalize(Vec3{1, -2, 0.5f});
    light.up = normalize(Vec3{0.2f, 1, 1});
    return light;
}

/// Returns what arrives at a point from the scene's only light; black if nothing does.
Rgb arriving_from_table(const test::Lights& lights, Vec3 at) {
    LightSample sample;
    return sample_light(lights.view, at, {0x12345678u, 0x9abcdef0u}, sample) ? sample.radiance : Rgb{};
}

double total(Rgb light) {
    return static_cast<double>(light.r) + static_cast<double>(light.g) + static_cast<double>(light.b);
}

Rgb arriving_from_table(const Light& light, Vec3 at) {
    Scene scene;
    scene.lights = {light};
    return arriving_from_table(test::Lights(scene), at);
}

} // namespace

TEST_CASE("goniometric: a constant table is a point light, to the bit") {
    Light point;
    point.position = {1, 2, 3};
    point.intensity = {0.3f, 7, 1.1f};
    for (const TableLayout layout : {TableLayout::Angles, TableLayout::Octahedron}) {
        for (const TableFilter filter : {TableFilter::Nearest, TableFilter::Linear, TableFilter::Knots}) {
            if (filter == TableFilter::Knots && layout != TableLayout::Angles) continue;
            IntensityTable table;
            table.layout = layout, table.filter = filter;
            table.values = {.width = 8, .height = 8, .channels = 1, .pixels = std::vector<float>(64, 2.0f)};
            Light light = goniometric_light(table);
            CHECK(light.intensity == grey(2));
            light.position = point.position, light.intensity = point.intensity;
            test::Random random(3);
            for (int i = 0; i < 50; ++i) {
                const Vec3 at = random.point(-9, 9);
                CHECK(arriving_from_table(light, at) == arriving_from_table(point, at));
            }
            CHECK(punctual_power(light, 3, 0) == doctest::Approx(punctual_power(point, 3, 0)).epsilon(1e-6));
        }
    }
}

TEST_CASE("goniometric: sampling is of the stated density, and its mean is the integral of the table") {
    struct Case {
        TableLayout layout;
        TableFilter filter;
    };
    for (const Case& of : {Case{TableLayout::Angles, TableFilter::Linear},
                           {TableLayout::Angles, TableFilter::Knots},
                           {TableLayout::Angles, TableFilter::Nearest},
                           {TableLayout::Octahedron, TableFilter::Nearest},
                           {TableLayout::Perspective, TableFilter::Linear},
                           {TableLayout::PictureIrradiance, TableFilter::Nearest}}) {
        CAPTURE(static_cast<int>(of.layout));
        CAPTURE(static_cast<int>(of.filter));
        Light light = goniometric_light(varied_table(of.layout, of.filter, 6, 5));
        light.is_mirrored = true;
        Scene scene;
        scene.lights = {light};
        const test::Lights lights(scene);
        const PunctualLight& punctual = lights.view.punctual[0];
        const GoniometricTablesView& tables = lights.view.goniometric;
        constexpr int kSide = 128;
        const auto middle = [](int cell) { return (static_cast<float>(cell) + 0.5f) / kSide; };
        // Sums of all green light and of what goes to one side, by sampling the table and by sampling the sphere.
        std::array<double, 2> sampled = {}, wanted = {};
        int different = 0;
        double least = 1e30, most = 0; // power of a sample; directions are selected by that of their cell
        for (int i = 0; i < kSide * kSide; ++i) {
            const Vec2 u = {middle(i % kSide), middle(i / kSide)};
            const PunctualEmission emission = emit_from(punctual, {{}, 1}, u, tables);
            REQUIRE(emission.pdf > 0);
            REQUIRE(1 - dot(emission.direction, light.direction) <= depth_of_beam(punctual) + 1e-5f);
            const float pdf = pdf_emission(punctual, {{}, 1}, emission.direction, tables);
            different += std::abs(pdf / emission.pdf - 1) < 1e-3f ? 0 : 1; // rounding may enter the next cell
            const auto power = total(emitted_power(punctual, emission, 1, tables));
            least = std::min(least, power), most = std::max(most, power);
            const auto green = static_cast<double>(emitted_power(punctual, emission, 1, tables).g);
            sampled[0] += green, sampled[1] += emission.direction.x > 0.3f ? green : 0;
            const Vec3 direction = sample_uniform_sphere(u);
            const double value = 4 * 3.14159265358979 * static_cast<double>(light.intensity.g) *
                                 static_cast<double>(goniometric_value(tables, punctual.table, direction).g);
            wanted[0] += value, wanted[1] += direction.x > 0.3f ? value : 0;
        }
        CHECK(different <= 8);
        if (of.filter == TableFilter::Nearest) CHECK(most < 1.001 * least);
        CHECK(sampled[0] == doctest::Approx(wanted[0]).epsilon(0.02));
        CHECK(sampled[1] == doctest::Approx(wanted[1]).epsilon(0.03));
        const double integral = static_cast<double>(light.table->integral.g * light.intensity.g) * kSide * kSide;
        CHECK(wanted[0] == doctest::Approx(integral).epsilon(0.03));
    }
}

TEST_CASE("goniometric: a picture is upright and not mirrored for whoever looks along the light") {
    IntensityTable table;
    table.layout = TableLayout::Perspective, table.filter = TableFilter::Nearest;
    table.half_width = 1, table.half_height = 0.5f;
    table.values = {.width = 2, .height = 2, .channels = 3, .pixels = {1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1}};
    Light light = goniometric_light(table);
    light.direction = {0, 0, -1}, light.up = {0, 1, 0};
    const test::Lights lights = [&] {
        Scene scene;
        scene.lights = {light};
        return test::Lights(scene);
    }();
    const auto near = [](Rgb got, Rgb wanted) {
        return max_component(abs(Vec3{got.r - wanted.r, got.g - wanted.g, got.b - wanted.b})) < 1e-6f;
    };
    const float square = 1 / (1 + 0.5f * 0.5f + 0.25f * 0.25f); // over the squared distance
    CHECK(near(arriving_from_table(lights, {-0.5f, 0.25f, -1}), square * Rgb{1, 0, 0}));
    CHECK(near(arriving_from_table(lights, {0.5f, 0.25f, -1}), square * Rgb{0, 1, 0}));
    CHECK(near(arriving_from_table(lights, {-0.5f, -0.25f, -1}), square * Rgb{0, 0, 1}));
    CHECK(near(arriving_from_table(lights, {0.5f, -0.25f, -1}), square * Rgb{1, 1, 1}));
    CHECK(is_black(arriving_from_table(lights, {1.01f, 0, -1})));
    CHECK(is_black(arriving_from_table(lights, {0, 0.51f, -1})));
    CHECK(is_black(arriving_from_table(lights, {-0.5f, 0.25f, 1}))); // behind it
    light.is_mirrored = true;
    CHECK(near(arriving_from_table(light, {-0.5f, 0.25f, -1}), square * Rgb{0, 1, 0}));
    light.is_mirrored = false, light.up = {1, 0, 0};
    CHECK(near(arriving_from_table(light, {0.25f, 0.5f, -1}), square * Rgb{1, 0, 0}));
}

TEST_CASE("goniometric: the irradiance of a picture plane is that of the picture") {
    IntensityTable table;
    table.layout = TableLayout::PictureIrradiance;
    table.values = {.width = 1, .height = 1, .channels = 1, .pixels = {5.0f}};
    Light light = goniometric_light(table);
    light.direction = {0, 0, -1}, light.up = {0, 1, 0};
    for (const float x : {0.0f, 0.5f, 0.9f}) {
        const float cosine = 1 / std::sqrt(1 + x * x);
        CHECK(arriving_from_table(light, {x, 0, -1}).g * cosine == doctest::Approx(5));
    }
    CHECK(punctual_power(light, 1, 0) == doctest::Approx(4)); // an area of 2 x 2
}

TEST_CASE("goniometric: a light tree bounds a table by the cone of its light") {
    Light light = goniometric_light(make_round_table(0.4f, [](float) { return 1.0f; }));
    light.direction = {0, -1, 0}, light.up = {1, 0, 0};
    Scene scene;
    scene.lights = {light, light};
    scene.lights[1].position = {50, 0, 0};
    const test::Lights lights(scene);
    CHECK(lights.view.punctual[0].cos_outer == doctest::Approx(std::cos(0.4)).epsilon(1e-4));
    CHECK(lights.data.goniometric.values.size() == 1025); // both share the values
    CHECK(lights.data.source_powers[0] == doctest::Approx(2 * 3.14159265 * (1 - std::cos(0.4))).epsilon(1e-4));
}

TEST_CASE("goniometric: lumens are those of the colours of the table and of the light") {
    IntensityTable green;
    green.values = {.width = 1, .height = 1, .channels = 3, .pixels = {0, 1, 0}};
    Scene scene;
    scene.lights = {goniometric_light(green)};
    scene.lights[0].name = "beam";
    scene.lights[0].intensity = {1, 3, 1};
    const EmitterStrength emitters[] = {parse_emitter("beam=800lm")};
    set_emitters(scene, emitters, 683);
    const Rgb watts = scene.lights[0].table->integral * scene.lights[0].intensity;
    CHECK(683 * luminance(watts) == doctest::Approx(800).epsilon(1e-4));
}
