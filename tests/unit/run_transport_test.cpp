// A small measurement of integrators on the CPU.

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include <doctest/doctest.h>

#include "base/stopwatch.h"
#include "integrators/irradiance_cache/overture_grid.h"
#include "integrators/irradiance_cache/record_store.h"
#include "lab/run_transport.h"
#include "lab/transport_solutions.h"
#include "radiosity/radiosity_view.h"
#include "session/opening/choose_camera.h"
#include "session/opening/open_scene.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

struct SmallRun {
    Scene scene;
    Camera camera;
    Queue queue = Queue::make_cpu();
    TransportSettings settings;

    SmallRun() {
        Messages messages;
        scene = open_scene("cornell-box", messages);
        camera = choose_camera({}, scene, 1, messages);
        settings.integrators = {"path"};
        settings.picture.width = settings.picture.height = 16;
        settings.picture.path.max_depth = 4;
        settings.seconds = 1000; // max_samples ends the measurement
        settings.max_samples = 64;
        settings.reference_samples = 1024;
    }
    TransportScene run(Sink&& sink = Sink()) { return run_transport(queue, scene, camera, settings, sink); }
};

/// The progress of precomputation that a call for one sample reported.
struct Making {
    int times_requested = 0;
    double last_request_s = 0, made_s = 0, end_s = 0;
};

Making render_one(Session& session) {
    Making making;
    session.render(1, ProgressSink([&](const Progress& now) {
                       const bool is_made = now.seconds > now.made_seconds; // rendering samples took time
                       if (!is_made) ++making.times_requested, making.last_request_s = now.seconds;
                       making.made_s = now.made_seconds, making.end_s = now.seconds;
                       return true;
                   }));
    return making;
}

const TransportRow& row_named(const TransportScene& scene, std::string_view name) {
    return *std::ranges::find(scene.rows, name, &TransportRow::name);
}

} // namespace

TEST_CASE("path tracing's error falls as one over its samples, and the reference's noise is measured") {
    SmallRun small;
    small.settings.integrators = {"path", "hybrid", "cast"};
    double last_share = 0;
    bool shares_rise = true;
    const TransportScene scene = small.run(ProgressSink([&](const Progress& now) {
        shares_rise &= now.share >= last_share && now.share <= 1;
        last_share = now.share;
        return true;
    }));
    CHECK(shares_rise);
    CHECK(last_share > 0.5);
    CHECK_FALSE(scene.interrupted);
    const std::vector<TransportPoint> points = points_of(row_named(scene, "path"));
    REQUIRE(points.size() == 7);
    CHECK(points.back().samples == 64);
    CHECK(points.back().repetitions == 4);
    // Low-discrepancy samples converge slightly faster than 1 / 64.
    const double fall = points.front().rel_mse.mean / points.back().rel_mse.mean;
    CHECK(fall > 40);
    CHECK(fall < 300);
    for (std::size_t i = 1; i < points.size(); ++i) {
        CHECK(points[i].seconds.mean > points[i - 1].seconds.mean);
        CHECK(points[i].flip.mean < 1.1 * points[i - 1].flip.mean);
    }
    // With 16 times the samples of the last picture, the noise is at most a sixteenth.
    REQUIRE(scene.reference.rel_mse);
    CHECK(scene.reference.samples == 1024);
    const double ratio = points.back().rel_mse.mean / *scene.reference.rel_mse;
    CHECK(ratio > 8);
    CHECK(ratio < 80);
    // A different integrator with equal samples, and one that finds more than emitted light.
    CHECK(row_named(scene, "hybrid").repetitions.back().back().rel_mse ==
          row_named(scene, "path").repetitions.back().back().rel_mse);
    CHECK(row_named(scene, "path").bytes > 16 * 16 * 3 * 16); // at least a film is allocated
    CHECK(row_named(scene, "cast").repetitions.empty());
    CHECK_FALSE(row_named(scene, "cast").refused.empty());
    CHECK(scene.pictures.size() == 3);
}

TEST_CASE("radiosity takes part with solutions of growing detail, whose time includes solving") {
    SmallRun small;
    small.settings.integrators = {"path", "radiosity"};
    small.settings.repetitions = 2;
    small.settings.max_solutions = 2;
    small.settings.max_samples = 16;
    const TransportScene scene = small.run();
    const TransportRow row = row_named(scene, "radiosity");
    CHECK(row.refused == "");
    CHECK(row.is_solved);
    CHECK(row.light == "all, by patches ever smaller");
    CHECK_FALSE(row.finds_all);
    REQUIRE(row.repetitions.size() == 2);
    REQUIRE(row.repetitions[0].size() == 2);
    CHECK(row.repetitions[1].size() == 2);
    CHECK(row.host_bytes > row.repetitions[0].back().patches * sizeof(PatchLight));
    for (const Repetition& repetition : row.repetitions) {
        for (std::size_t i = 0; i < repetition.size(); ++i) {
            CHECK(repetition[i].samples == 16);
            CHECK(repetition[i].rel_mse > 0);
            if (i == 0) continue;
            CHECK(repetition[i].patches > 2 * repetition[i - 1].patches);
        }
        // More detail reduces the error down to the size of pixels.
        CHECK(repetition.back().rel_mse < repetition.front().rel_mse);
    }
    // Other seeds give other form factors.
    CHECK(row.repetitions[0][0].rel_mse != row.repetitions[1][0].rel_mse);
    CHECK(std::ranges::any_of(scene.notes, [](const std::string& note) { return note.starts_with("radiosity: "); }));
    CHECK(scene.pictures.size() == 3);
}

TEST_CASE("the table has the host memory of irradiance caching beside the device's, and others use none") {
    SmallRun small;
    small.settings.integrators = {"path", "irradiance_cache"};
    small.settings.reference_samples = 2;
    small.settings.repetitions = 2;
    small.settings.max_samples = 2;
    const TransportScene scene = small.run();
    const TransportRow cache = row_named(scene, "irradiance_cache");
    CHECK(cache.refused == "");
    Queue dry = Queue::make_dry_run(false);
    RecordStore store(dry);
    store.allocate(16 * 16);
    CHECK(cache.host_bytes == store.host_bytes());
    CHECK(cache.host_bytes > 1000); // records have positions
    CHECK(row_named(scene, "path").host_bytes == 0);
}

TEST_CASE("irradiance caching makes its records once within the reported time and continues by the time of samples") {
    SmallRun small;
    small.settings.integrators = {"irradiance_cache"};
    small.settings.reference_samples = 2;
    small.settings.repetitions = 2;
    small.settings.picture.width = small.settings.picture.height = 32;
    small.settings.max_samples = 4;
    const TransportScene scene = small.run();
    const TransportRow& row = row_named(scene, "irradiance_cache");
    REQUIRE(row.repetitions.size() == 2);
    for (const Repetition& repetition : row.repetitions) {
        REQUIRE(repetition.size() == 3);
        const double made_s = repetition.front().made_seconds;
        CHECK(made_s > 0);
        CHECK(made_s < repetition.front().seconds);
        for (const TransportFigures& figures : repetition) CHECK(figures.made_seconds == made_s); // once
    }

    Messages messages;
    const PreparedScene prepared = prepare_scene(small.scene, {}, messages);
    RenderSettings picture = small.settings.picture;
    picture.integrator = IntegratorKind::IrradianceCache;
    picture.width = picture.height = 64;
    Session session(small.queue, prepared, small.camera, picture);
    int reported = 0;
    warm_up(session, [&] { ++reported; });
    CHECK(session.history().samples == 0);
    CHECK(reported == 2); // at its start, and shortly later
    // No record has been made yet. The number of calls depends on the clock, but is at least two per round.
    const Making first = render_one(session);
    CHECK(first.times_requested >= 2 * static_cast<int>(kOvertureRounds));
    CHECK(first.made_s >= first.last_request_s);
    CHECK(first.made_s < first.end_s);
    const Making second = render_one(session);
    CHECK(second.times_requested == 0);
    CHECK(second.made_s == 0);

    picture.integrator = IntegratorKind::Path;
    session.set_settings(picture);
    int samples = 0;
    warm_up(session, [&] { ++samples; });
    CHECK(samples == 1); // nothing is precomputed
    CHECK(session.history().samples == 0);
}

TEST_CASE("the time of a solution's picture includes solving and rendering, and patch sizes halve") {
    SmallRun small;
    Messages messages;
    const PreparedScene prepared = prepare_scene(small.scene, {}, messages);
    RenderSettings picture = small.settings.picture;
    picture.integrator = IntegratorKind::Radiosity;
    const Stopwatch watch;
    double begun_s = -1, solving_s = 0;
    ProgressSink sink([&](const Progress& now) {
        if (begun_s < 0) begun_s = watch.seconds();
        if (now.doing != "rendering") solving_s = watch.seconds() - begun_s;
        return true;
    });
    const SolvedPicture solved = solve_picture(small.queue, prepared, small.camera, picture, 0, 2, sink);
    CHECK(solving_s > 0);
    CHECK(solved.figures.seconds > solving_s);
    CHECK(solved.figures.seconds < watch.seconds());
    CHECK(solved.figures.samples == 2);
    CHECK(solved.picture.width == 16);
    CHECK(solved.device_bytes > solved.figures.patches * sizeof(PatchLight)); // the solution is on the device
    const RadiositySettings coarse = solution_settings(prepared, 0, 3), fine = solution_settings(prepared, 2, 3);
    CHECK(coarse.patch_size == 4 * fine.patch_size);
    CHECK(fine.patch_size == doctest::Approx(patch_size_of(prepared, {}))); // the default of pertev render
    CHECK(fine.seed == 3);
}

TEST_CASE("a scene without diffuse surfaces is refused in radiosity's row") {
    SmallRun small;
    small.settings.integrators = {"path", "radiosity"};
    small.settings.reference_samples = 2;
    small.settings.max_samples = 1;
    for (Material& material : small.scene.materials) {
        material.base_color = {};
        if (!material.is_emissive()) material.kind = MaterialKind::Conductor;
    }
    const TransportScene emitters = small.run(); // the emitter's surface is diffuse and black
    CHECK(row_named(emitters, "radiosity").refused.find("diffuse") != std::string::npos);
    CHECK_FALSE(row_named(emitters, "path").repetitions.empty());
}

TEST_CASE("an interrupt during a solution keeps the previous one") {
    SmallRun small;
    small.settings.integrators = {"radiosity"};
    small.settings.reference_samples = 2;
    small.settings.seconds = 1e6;
    const TransportScene scene =
        small.run(ProgressSink([](const Progress& now) { return now.doing.find("solution 2") == std::string::npos; }));
    CHECK(scene.interrupted);
    REQUIRE(scene.rows[0].repetitions.size() == 1);
    CHECK(scene.rows[0].repetitions[0].size() == 1);
}

TEST_CASE("an interrupt keeps the previous repetitions, or the finished part of the first") {
    SmallRun small;
    small.settings.reference_samples = 2;
    small.settings.max_samples = 8;
    int seen = 0; // stops in the third repetition, after it has figures
    const TransportScene second =
        small.run(ProgressSink([&](const Progress& now) { return now.doing != "path, 3 of 4" || ++seen < 5; }));
    CHECK(second.interrupted);
    REQUIRE(second.rows[0].repetitions.size() == 2);
    CHECK(second.rows[0].repetitions[1].size() == 4);
    int calls = 0; // the sink is checked before the session is made, after the untimed sample, and after each pass
    const TransportScene first =
        small.run(ProgressSink([&](const Progress& now) { return now.doing != "path, 1 of 4" || ++calls < 5; }));
    CHECK(first.interrupted);
    REQUIRE(first.rows[0].repetitions.size() == 1);
    CHECK(first.rows[0].repetitions[0].size() == 2);
    const TransportScene none =
        small.run(ProgressSink([](const Progress& now) { return !now.doing.starts_with("reference"); }));
    CHECK(none.interrupted);
    CHECK_FALSE(has_findings(none));
}

TEST_CASE("the budget ends a repetition before the samples that would not fit") {
    SmallRun small;
    small.settings.reference_samples = 2;
    small.settings.seconds = 1e-9; // one sample takes longer than this
    const TransportScene scene = small.run();
    REQUIRE(scene.rows[0].repetitions.size() == 4);
    for (const Repetition& repetition : scene.rows[0].repetitions) CHECK(repetition.size() == 1);
}

TEST_CASE("an unsuitable reference is refused before anything is rendered") {
    SmallRun small;
    small.settings.reference_file = "given.exr";
    const auto message = [&](Image reference) {
        small.settings.reference = std::move(reference);
        return test::bad_input_message([&] { small.run(); });
    };
    CHECK(message({8, 16, 3, std::vector<float>(8 * 16 * 3)}).find("8x16") != std::string::npos);
    Image bad = {16, 16, 3, std::vector<float>(16 * 16 * 3)};
    bad.pixels[5] = std::numeric_limits<float>::infinity();
    CHECK(message(bad).find("given.exr") != std::string::npos);
    small.settings.reference.reset();
    small.settings.reference_integrator = "cast";
    CHECK(test::is_about(test::thrown_error([&] { small.run(); }), ErrorCode::BadInput, "reference", "cast"));
}
