// Ratios to stored figures: right where device, scene and job are the figure's, and none where one of them is another.

#include "lab/stored_figures.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "lab/record_scenes.h"

using namespace pertev;

namespace {

constexpr const char* kH200 = "NVIDIA H200";
constexpr std::array kOtherDevices = {"CPU", "NVIDIA H200 NVL", "NVIDIA H200 MIG 1g.18gb", "NVIDIA H100 80GB HBM3", ""};

RaysRun rays_run(const std::string& scene, std::size_t set, double rays_per_second) {
    const RecordScene& record = *find_named(the_record().scenes, scene);
    return {kH200, &record, set, record.triangles, kRecordRays, record.sets[set].hit_share, rays_per_second};
}

BuildRun build_run(const std::string& scene, double seconds) {
    const RecordScene& record = *find_named(the_record().scenes, scene);
    return {kH200, &record, record.triangles, seconds};
}

JobRun job_run(const std::string& name, double samples_per_second) {
    const RecordJob& job = *find_named(the_record().jobs, name);
    return {kH200, &job, job.width, job.height, job.samples, job.triangles, job.mean, samples_per_second};
}

/// `run` with one thing changed.
template <class Run, class Change>
Run changed(Run run, Change change) {
    change(run);
    return run;
}

bool has_any(const std::vector<Ratio>& ratios) {
    return std::ranges::any_of(ratios, [](const Ratio& ratio) { return ratio.value.has_value(); });
}

} // namespace

TEST_CASE("all scenes and jobs of the record have stored figures") {
    for (const RecordScene& scene : the_record().scenes) {
        for (std::size_t set = 0; set < scene.sets.size(); ++set) {
            CHECK(*ratio_of(rays_run(scene.name, set, 2 * scene.sets[set].best_rays_per_second)).value ==
                  doctest::Approx(2));
        }
        for (const Ratio& ratio : ratios_of(build_run(scene.name, 1e-3))) CHECK(ratio.value.value_or(0) > 0.1);
    }
    for (const RecordJob& job : the_record().jobs) {
        for (const Ratio& ratio : ratios_of(job_run(job.name, 1e8))) CHECK(ratio.value.value_or(0) > 0.5);
    }
    CHECK(find_named(the_record().jobs, "S6") == nullptr);
}

TEST_CASE("a ratio is our rate over the other's") {
    CHECK(*ratio_of(rays_run("sponza", 1, 4331e6)).value == doctest::Approx(4331.0 / 3479));
    const auto builds = ratios_of(build_run("sponza", 0.58e-3));
    CHECK(*builds[0].value == doctest::Approx(1.48 / 0.58));
    CHECK(*builds[1].value == doctest::Approx(0.31 / 0.58));
    const auto renders = ratios_of(job_run("S5", 483.19e6));
    CHECK(*renders[0].value == doctest::Approx(483.19 / 109.7));
    CHECK(*renders[2].value == doctest::Approx(483.19 / 72));
    CHECK(*ratios_of(job_run("cornell-box-8", 808e6))[0].value == doctest::Approx(808 / 184.9));
}

TEST_CASE("another card has no ratios, however similar its name") {
    for (const char* device : kOtherDevices) {
        CAPTURE(device);
        const auto elsewhere = [&](auto& run) { run.device = device; };
        CHECK(!ratio_of(changed(rays_run("bunny", 0, 1e9), elsewhere)).value);
        CHECK(!has_any(ratios_of(changed(build_run("bunny", 1e-3), elsewhere))));
        CHECK(!has_any(ratios_of(changed(job_run("S8", 1e8), elsewhere))));
    }
}

TEST_CASE("other rays, scenes and pictures have no ratios") {
    const RaysRun rays = rays_run("sponza", 2, 1e9);
    const BuildRun build = build_run("forest", 1e-3);
    const JobRun job = job_run("cornell-box-65", 1e8);
    REQUIRE(ratio_of(rays).value);
    REQUIRE(has_any(ratios_of(build)));
    REQUIRE(has_any(ratios_of(job)));

    CHECK(!ratio_of(changed(rays, [](RaysRun& run) { run.scene = nullptr; })).value);
    CHECK(!ratio_of(changed(rays, [](RaysRun& run) { ++run.triangles; })).value);
    CHECK(!ratio_of(changed(rays, [](RaysRun& run) { --run.rays; })).value);
    CHECK(!has_any(ratios_of(changed(build, [](BuildRun& run) { run.scene = nullptr; }))));
    CHECK(!has_any(ratios_of(changed(build, [](BuildRun& run) { --run.triangles; }))));
    CHECK(!has_any(ratios_of(changed(job, [](JobRun& run) { ++run.width; }))));
    CHECK(!has_any(ratios_of(changed(job, [](JobRun& run) { --run.height; }))));
    CHECK(!has_any(ratios_of(changed(job, [](JobRun& run) { run.samples = 64; }))));
    CHECK(!has_any(ratios_of(changed(job, [](JobRun& run) { run.triangles = 38; }))));
}

TEST_CASE("compared scenes must match the published views") {
    const auto with_share = [](const char* scene, double more) {
        return ratio_of(changed(rays_run(scene, 2, 1e9), [&](RaysRun& run) { run.hit_share += more; })).value;
    };
    CHECK(with_share("sponza", 0.0009));
    CHECK(!with_share("sponza", 0.002));
    CHECK(!with_share("sponza", -0.002));
    CHECK(with_share("forest", -0.039)); // the value in docs/ray_sets.md
    CHECK(!with_share("forest", -0.06));
    const auto with_mean = [](double times) {
        return has_any(ratios_of(changed(job_run("S5", 1e8), [&](JobRun& run) { run.mean *= times; })));
    };
    CHECK(with_mean(1.0019));
    CHECK(with_mean(0.9981));
    CHECK(!with_mean(1.0021));
    CHECK(!with_mean(0.9979));
}

TEST_CASE("ratios are fields of a measurement, empty where there are none") {
    const RecordJob& job = *find_named(the_record().jobs, "S5");
    const auto fields = [](const std::vector<Ratio>& ratios) {
        Fields all;
        for (const Ratio& ratio : ratios) all.push_back(field_of(ratio));
        return json_of("", all);
    };
    const auto here = ratios_of(job_run("S5", 219.4e6));
    CHECK(field_of(here[2]).value.text("{:.4f}") == "3.0472");
    CHECK(field_of(here[0]).value == 2.0);
    const auto elsewhere = ratios_of(changed(job_run("S5", 219.4e6), [](JobRun& run) { run.device = "CPU"; }));
    CHECK(fields(elsewhere) == R"({"ratio_to_mitsuba":null,"ratio_to_cycles":null,"ratio_to_pbrt":null})");
    CHECK(why_no_ratios(job) == "no ratios to others: their figures are of one NVIDIA H200, 1920x1080, 256 spp, "
                                "262204 triangles and a mean of 0.05784\n");
    CHECK(field_of(ratio_of(rays_run("sponza", 0, 5524e6))).key == std::string("ratio_to_best"));
    const auto builds = ratios_of(build_run("bunny", 1.85e-3));
    CHECK(field_of(builds[0]).value == 2.0);
    CHECK(builds[1].key == std::string("ratio_to_optix_fast_build"));
}

TEST_CASE("the table of jobs has the record's scenes and jobs and the presets of light transport") {
    const Record& record = the_record();
    CHECK(record.device == "NVIDIA H200");
    REQUIRE(record.scenes.size() == 3);
    CHECK(record.scenes[0].view.eye == Vec3{-110, 18, -2});
    CHECK(record.scenes[2].file.empty()); // generated
    for (const RecordScene& scene : record.scenes) CHECK(scene.sets.size() == 5);
    CHECK(record.jobs.size() == 4);
    REQUIRE(record.presets.size() == 6);
    CHECK_FALSE(record.presets[0].view);
    CHECK(camera_choice(record.presets[1]).fov_deg == 50.0f);
}

TEST_CASE("ratios are summarised by their geometric mean and minimum") {
    const RatioSummary summary = summarize(std::array{2.0, 0.5, 4.0});
    CHECK(summary.geometric_mean == doctest::Approx(1.5874).epsilon(1e-4));
    CHECK(summary.least == 0.5);
    CHECK(summarize(std::array{1.25}).geometric_mean == doctest::Approx(1.25));
}

TEST_CASE("depths of jobs are counted as each other program counts them") {
    CHECK(job_settings(*find_named(the_record().jobs, "S8")).path.max_depth == 8); // scatterings
    const RenderSettings box = job_settings(*find_named(the_record().jobs, "cornell-box-65"));
    CHECK(box.path.max_depth == 64); // edges
    CHECK(box.filter == PixelFilter::Tent);
    CHECK(filter_radius_of(box) == 1);
}
