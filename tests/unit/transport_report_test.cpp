// Results derived from measured errors: means and bands, equal time, efficiency; and the report's
// texts.

#include <array>
#include <cmath>
#include <set>

#include <doctest/doctest.h>

#include "lab/record_scenes.h"
#include "lab/run_transport.h"
#include "lab/transport_light.h"
#include "lab/transport_tables.h"
#include "tests/support/small_lab_report.h"

using namespace pertev;

namespace {

/// The relMSE is c / n after n = 1, 2, 4, 8 samples of `each_s` seconds, and HDR-FLIP is half of that.
Repetition falling(double c, double each_s) {
    Repetition repetition;
    for (uint32_t n = 1; n <= 8; n *= 2) repetition.push_back({n, n * each_s, c / n, c / n / 2});
    return repetition;
}

TransportRow transport_row(const char* name, std::vector<Repetition> repetitions) {
    return {.name = name, .light = "all", .finds_all = true, .bytes = 3 << 20, .repetitions = std::move(repetitions)};
}

/// A report of path, of an integrator with half its error that takes three times as long, and of a refused one.
TransportScene small_transport_scene() {
    TransportScene scene = {.name = "a <b>"};
    scene.reference = {.integrator = "path", .samples = 64, .seconds = 2, .rel_mse = 0.001, .flip = 0.01};
    scene.rows = {transport_row("path", {falling(1, 0.1), falling(3, 0.1)}),
                  transport_row("bidirectional", {falling(0.5, 0.3), falling(1.5, 0.3)}),
                  {.name = "cast", .light = "L(D|G)E", .refused = "lamps alone, and \"more\""}};
    return scene;
}

} // namespace

TEST_CASE("a confidence interval uses Student's t with n - 1 degrees of freedom") {
    const std::array<double, 4> values = {1, 2, 3, 6};
    const Estimate e = estimate_of(values);
    CHECK(e.mean == doctest::Approx(3));
    // s^2 = (4 + 1 + 0 + 9) / 3; t of 3 degrees, 0.975, is 3.18245.
    REQUIRE(e.half_width);
    CHECK(*e.half_width == doctest::Approx(3.18245 * std::sqrt(14.0 / 3 / 4)).epsilon(1e-4));
    CHECK_FALSE(estimate_of(std::span(values).first(1)).half_width);
}

TEST_CASE("Student's t matches tables and approaches the normal distribution") {
    CHECK(student_t(1) == doctest::Approx(12.7062).epsilon(1e-5));
    CHECK(student_t(9) == doctest::Approx(2.26216).epsilon(1e-4));
    CHECK(student_t(30) == doctest::Approx(2.04227).epsilon(1e-4));
    CHECK(student_t(31) == doctest::Approx(2.03951).epsilon(1e-4));
    CHECK(student_t(100) == doctest::Approx(1.98397).epsilon(1e-5));
    CHECK(student_t(1u << 30) == doctest::Approx(1.959964).epsilon(1e-6));
}

TEST_CASE("equal-time figures interpolate each repetition logarithmically") {
    const TransportScene scene = small_transport_scene();
    CHECK(equal_seconds(scene) == doctest::Approx(0.8));
    // c / n is linear in the logarithm. 0.8 s are 8 / 3 samples of the second integrator, whose errors are 0.5 and 1.5
    // divided by that.
    const auto point = at_time(scene.rows[1], 0.8);
    REQUIRE(point);
    CHECK(point->rel_mse.mean == doctest::Approx(1 / (8.0 / 3)).epsilon(1e-5));
    CHECK(point->flip.mean == doctest::Approx(0.5 / (8.0 / 3)).epsilon(1e-5));
    CHECK(point->samples == doctest::Approx(8.0 / 3));
    CHECK(*point->rel_mse.half_width == doctest::Approx(12.7062 * 0.5 / (8.0 / 3)).epsilon(1e-4));
    CHECK_FALSE(at_time(scene.rows[1], 0.29)); // the time is before its first sample
    CHECK_FALSE(at_time(scene.rows[1], 2.5));
    CHECK_FALSE(at_time(scene.rows[2], 0.8));
    const auto first = at_time(scene.rows[0], 0.1);
    REQUIRE(first);
    CHECK(first->rel_mse.mean == doctest::Approx(2));
}

TEST_CASE("samples at equal time exclude a picture's preparation") {
    const TransportRow row = transport_row("irradiance_cache", {{{1, 10.1, 1, 1}, {64, 16.4, 0.5, 0.5}}});
    const auto point = at_time(row, 10.2);
    REQUIRE(point);
    CHECK(point->samples == doctest::Approx(2));
}

TEST_CASE("preparation time counts once") {
    // Records take 10 s and each sample 0.1 s. The error is 1 / n, which is linear in the logarithm of the samples'
    // time.
    Repetition repetition;
    for (uint32_t n = 1; n <= 64; n *= 8) repetition.push_back({n, 10 + 0.1 * n, 1.0 / n, 0.5 / n, 0, 10});
    const auto point = at_time(transport_row("irradiance_cache", {repetition}), 10 + 0.1 * 24);
    REQUIRE(point);
    CHECK(point->rel_mse.mean == doctest::Approx(1.0 / 24).epsilon(1e-5));
    CHECK(point->flip.mean == doctest::Approx(0.5 / 24).epsilon(1e-5));
    CHECK(point->seconds.mean == doctest::Approx(12.4));
}

TEST_CASE("the next samples fit into the remaining time, without preparing records again") {
    const TransportFigures begun = {.samples = 1, .seconds = 3, .made_seconds = 2.9};
    CHECK(next_samples(begun, 5, 1u << 16) == 2);
    CHECK(next_samples({.samples = 8, .seconds = 3.7, .made_seconds = 2.9}, 5, 1u << 16) == 16);
    CHECK(next_samples({.samples = 16, .seconds = 4.5, .made_seconds = 2.9}, 5, 1u << 16) ==
          21); // each sample takes 0.1 s
    CHECK(next_samples({.samples = 20, .seconds = 4.9, .made_seconds = 2.9}, 5, 1u << 16) == 0); // one more sample fits
    CHECK(next_samples(begun, 3, 1u << 16) == 0);
    CHECK(next_samples(begun, 1e-9, 1u << 16) == 0);
    CHECK(next_samples({.samples = 1, .seconds = 1}, 5, 1u << 16) == 2);
    CHECK(next_samples({.samples = 2, .seconds = 2}, 5, 1u << 16) == 4);
    CHECK(next_samples({.samples = 4, .seconds = 4}, 5, 1u << 16) == 5);
    CHECK(next_samples({.samples = 64, .seconds = 1}, 1000, 64) == 0);
    CHECK(next_samples({.samples = 64, .seconds = 1}, 1000, 100) == 100);
    CHECK(next_samples({.samples = 1, .seconds = 0}, 1, 8) == 2);
}

TEST_CASE("an error of 0 is interpolated linearly") {
    TransportRow row = transport_row("raster", {{{1, 1, 0, 0.5}, {2, 2, 0, 0.5}}});
    const auto point = at_time(row, 1.5);
    REQUIRE(point);
    CHECK(point->rel_mse.mean == 0);
    CHECK(point->flip.mean == doctest::Approx(0.5));
    CHECK_FALSE(efficiency(*point));
}

TEST_CASE("at equal time the last finished solution counts, and at equal samples none") {
    TransportScene scene = small_transport_scene();
    TransportRow solved = transport_row("radiosity", {{{16, 0.2, 0.1, 0.05, 100}, {16, 5, 0.01, 0.02, 400}},
                                                      {{16, 0.4, 0.3, 0.05, 100}, {16, 6, 0.03, 0.02, 400}}});
    solved.is_solved = true, solved.host_bytes = 2 << 20;
    scene.rows.push_back(solved);
    CHECK(equal_seconds(scene) == doctest::Approx(0.8)); // the figures of path are the same as without the solution
    const auto point = at_time(scene.rows.back(), 0.8);
    REQUIRE(point);
    CHECK(point->rel_mse.mean == doctest::Approx(0.2));
    CHECK(point->seconds.mean == doctest::Approx(0.3));
    CHECK(point->samples == 16);
    CHECK(point->patches == doctest::Approx(100));
    CHECK(at_time(scene.rows.back(), 100)->rel_mse.mean == doctest::Approx(0.02));
    CHECK_FALSE(at_time(scene.rows.back(), 0.3)); // the first solution of the second repetition takes longer
    const ResultTable by_time = equal_time_table(scene);
    CHECK(by_time.at(0, "integrator") == "radiosity");
    CHECK(by_time.at(0, "samples") == 16.0);
    CHECK(by_time.at(0, "patches") == 100.0);
    CHECK(by_time.at(0, "device_mebibytes") == 3.0);
    CHECK(by_time.at(0, "host_mebibytes") == 2.0);
    CHECK(!by_time.at(1, "host_mebibytes").is_there());
    TransportScene quick = scene; // the others do not wait for it
    quick.rows.back().repetitions = {{{4, 0.1, 0.1, 0.05, 100}}, {{4, 0.1, 0.1, 0.05, 100}}};
    CHECK(equal_seconds(quick) == doctest::Approx(0.8));
    CHECK(at_time(quick.rows.back(), 0.8));
    TransportScene late = scene;
    for (Repetition& repetition : late.rows.back().repetitions) repetition.erase(repetition.begin());
    CHECK(equal_time_table(late).at(2, "first_seconds") == 5.5);
    CHECK(!equal_time_table(late).at(2, "rel_mse").is_there());
    scene.rows.erase(scene.rows.begin(), scene.rows.end() - 1);
    CHECK(equal_seconds(scene) == doctest::Approx(5)); // there is no other integrator
    TransportReport report = {.device = "CPU"};
    report.scenes.push_back(scene);
    CHECK(test::has(csv_of(measurement_of(report), "repetitions"), ",400,0\n"));
    const ResultTable repetitions = measurement_of(report).table("repetitions");
    CHECK(repetitions.at(0, "is_solved") == true);
    CHECK(repetitions.at(0, "device_bytes") == 3145728);
    CHECK(repetitions.at(0, "host_bytes") == 2097152);
}

TEST_CASE("efficiency is one over error times time, and its ratio to path's stands in the table") {
    const TransportScene scene = small_transport_scene();
    const auto path = at_time(scene.rows[0], 0.8);
    REQUIRE(path);
    CHECK(*efficiency(*path) == doctest::Approx(1 / (0.25 * 0.8)));
    const ResultTable by_time = equal_time_table(scene);
    REQUIRE(by_time.rows.size() == 2);
    CHECK(by_time.at(0, "integrator") == "path"); // the smallest error is first
    CHECK(by_time.at(0, "of_path") == 1.0);
    CHECK(by_time.at(1, "of_path").text("{:.3g}") == "0.667"); // half the error in three times the time
}

TEST_CASE("an interrupted repetition counts up to its last figure") {
    TransportRow row = transport_row("path", {falling(1, 0.1), {falling(3, 0.1)[0]}});
    const std::vector<TransportPoint> points = points_of(row);
    REQUIRE(points.size() == 4);
    CHECK(points[0].repetitions == 2);
    CHECK(points[0].rel_mse.mean == doctest::Approx(2));
    CHECK(points[1].repetitions == 1);
    CHECK_FALSE(points[1].rel_mse.half_width);
}

TEST_CASE("seeds of repetitions differ from each other and the reference's") {
    for (const uint32_t seed : {0u, 5u, 0x7fffffffu}) {
        TransportSettings settings;
        settings.picture.path.seed = seed;
        std::set<uint32_t> seeds;
        for (uint32_t i = 0; i < kMaxRepetitions; ++i) seeds.insert(repetition_seed(settings, i));
        seeds.insert({reference_seed(settings, 0), reference_seed(settings, 1)});
        CHECK(seeds.size() == kMaxRepetitions + 2);
    }
}

TEST_CASE("each preset is a built-in scene, and three integrators find all of its light") {
    for (const TransportPreset& preset : the_record().presets) {
        CAPTURE(preset.name);
        CHECK(find_named(the_record().presets, preset.name) == &preset);
        CHECK(test::has("cornell-box caustic blind door cove many-lights", preset.scene));
    }
    CHECK(find_named(the_record().presets, "kitchen") == nullptr);
    Scene emitters, glass;
    for (const std::string& name : names_of<IntegratorKind>()) {
        CAPTURE(name);
        const bool finds_all = name == "path" || name == "hybrid" || name == "bidirectional";
        CHECK((light_of(name, emitters) == "all") == finds_all);
        CHECK_FALSE(light_of(name, emitters).empty());
    }
    glass.lights.emplace_back();
    glass.materials.push_back({{.kind = MaterialKind::Dielectric, .roughness = 0}});
    glass.instances.emplace_back();
    glass.instances.back().material = 0;
    CHECK(light_of("path", glass) == "all but LS+D of point lights");
    CHECK(default_reference_integrator(glass) == "bidirectional");
    CHECK(default_reference_integrator(emitters) == "path");
    Scene fog = glass;
    fog.medium.sigma_s = {1, 1, 1};
    CHECK(light_of("irradiance_cache", fog) == "a vacuum in place of media");
    for (const char* name : {"path", "light", "bidirectional", "photon_map"}) {
        CHECK(light_of(name, fog) == light_of(name, glass));
    }
    CHECK(default_reference_integrator(fog) == "bidirectional");
}

TEST_CASE("the light transport report lists results and reasons for missing ones") {
    TransportReport report = {.device = "CPU", .width = 4, .height = 4, .max_depth = 8, .repetitions = 2};
    report.scenes.push_back(small_transport_scene());
    const Measurement m = measurement_of(report);
    const std::string csv = csv_of(m, "repetitions"), text = text_of(report);
    CHECK(test::count(csv, "\n") == 1 + 2 * 8 + 1);
    CHECK(test::has(csv, "\"lamps alone, and \"\"more\"\"\""));
    CHECK(m.table("scenes").at(0, "reference_rel_mse") == 0.001);
    const ResultTable& points = m.table("points");
    REQUIRE(points.rows.size() == 8);
    CHECK(points.at(3, "samples") == 8.0);
    CHECK(points.at(3, "efficiency").text("{:.3g}") == "5"); // the figures of path
    CHECK(points.at(3, "rel_mse").text("{:.3g}") == "0.25");
    CHECK(points.at(3, "rel_mse_high").text("{:.4f}") == "1.8383"); // 0.25 + 12.7062 * 0.125
    CHECK(m.table("repetitions").at(16, "refused") == "lamps alone, and \"more\"");
    CHECK(!m.table("repetitions").at(16, "device_bytes").is_there());
    CHECK(m.notes == std::vector<std::string>{"a <b>: cast: lamps alone, and \"more\""});
    CHECK(test::has(text, "cast: lamps alone"));
    CHECK(test::has(text, "its own noise: relMSE 0.001"));
}
