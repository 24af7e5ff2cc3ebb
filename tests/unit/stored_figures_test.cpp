// Runs are compared with a stored figure only if device, scene and job are the same.

#include "lab/stored_figures.h"

#include <doctest/doctest.h>

#include <array>

#include "lab/record_scenes.h"

using namespace pertev;

namespace {

constexpr const char* kH200 = "NVIDIA H200";
constexpr std::array kOtherDevices = {"CPU", "NVIDIA H200 NVL", "NVIDIA H200 MIG 1g.18gb", "NVIDIA H100 80GB HBM3", ""};

const RecordScene& scene_named(const char* name) { return *find_named(the_record().scenes, name); }
const RecordJob& job_named(const char* name) { return *find_named(the_record().jobs, name); }

/// A ray set of the record, except for the given members.
bool are_rays_known(const char* name, double more_hits = 0, const char* device = kH200, uint64_t more_rays = 0) {
    const RecordScene& scene = scene_named(name);
    return is_on_record(device, &scene, scene.triangles, 2, kRecordRays + more_rays,
                        scene.sets[2].hit_share + more_hits);
}

bool is_job_known(const char* name, double times_mean = 1, const char* device = kH200, uint64_t more_triangles = 0) {
    const RecordJob& job = job_named(name);
    return is_on_record(device, job, job_settings(job), job.triangles + more_triangles, times_mean * job.mean);
}

} // namespace

TEST_CASE("stored figures apply to the scenes and jobs of the record, on its GPU only") {
    for (const RecordScene& scene : the_record().scenes) {
        CHECK(is_on_record(kH200, &scene, scene.triangles));
        CHECK(!is_on_record(kH200, &scene, scene.triangles + 1));
        CHECK(are_rays_known(scene.name.c_str()));
    }
    for (const RecordJob& job : the_record().jobs) CHECK(is_job_known(job.name.c_str()));
    CHECK(find_named(the_record().jobs, "S6") == nullptr);
    CHECK(!is_on_record(kH200, nullptr, 0));
    for (const char* device : kOtherDevices) {
        CAPTURE(device);
        CHECK(!is_on_record(device, &scene_named("bunny"), scene_named("bunny").triangles));
        CHECK(!are_rays_known("bunny", 0, device));
        CHECK(!is_job_known("S8", 1, device));
    }
}

TEST_CASE("stored figures do not apply to other rays, settings or pictures") {
    CHECK(!are_rays_known("sponza", 0, kH200, 1));
    CHECK(are_rays_known("sponza", 0.0009));
    CHECK(!are_rays_known("sponza", 0.002));
    CHECK(!are_rays_known("sponza", -0.002));
    CHECK(are_rays_known("forest", -0.039)); // the value is in docs/ray_sets.md
    CHECK(!are_rays_known("forest", -0.06));
    CHECK(!is_job_known("S5", 1, kH200, 1));
    CHECK(is_job_known("S5", 1.0019));
    CHECK(is_job_known("S5", 0.9981));
    CHECK(!is_job_known("S5", 1.0021));
    CHECK(!is_job_known("S5", 0.9979));
    const RecordJob& job = job_named("S5");
    RenderSettings other = job_settings(job);
    ++other.width;
    CHECK(!is_on_record(kH200, job, other, job.triangles, job.mean));
    other = job_settings(job), other.samples = 64;
    CHECK(!is_on_record(kH200, job, other, job.triangles, job.mean));
}

TEST_CASE("a ratio is a field of a measurement, empty where there is none") {
    CHECK(ratio_field("x", "times", true, 2).value == 2.0);
    CHECK(!ratio_field("x", "times", false, 2).value.is_there());
    for (const char* value : {"NVIDIA H200", "1920x1080", "256 spp", "262204", "0.05784"}) {
        CHECK(why_no_ratios(job_named("S5")).find(value) != std::string::npos);
    }
}

TEST_CASE("the table of jobs has the record's scenes and jobs and the presets of light transport") {
    const Record& record = the_record();
    CHECK(record.device == "NVIDIA H200");
    REQUIRE(record.scenes.size() == 3);
    CHECK(record.scenes[0].view.eye == Vec3{-110, 18, -2});
    CHECK(record.scenes[2].file == "record/forest.ply"); // generated
    for (const RecordScene& scene : record.scenes) CHECK(scene.sets.size() == 5);
    CHECK(record.scenes[0].sets[4].best_rays_per_second == 2.233e9); // bench/figures.json
    CHECK(record.scenes[1].optix_fast_build_s == 0.00095);
    CHECK(job_named("S8").cycles == 41e6);
    CHECK(job_named("corridor").mitsuba == 0); // unknown
    REQUIRE(record.jobs.size() == 7);
    for (const RecordJob& job : record.jobs) CHECK(job.view.has_value() == (job.filter == PixelFilter::Box));
    CHECK(job_named("corridor").view->eye == Vec3{0, 1.6f, 29.5f});
    CHECK_FALSE(job_named("corridor").reflectance); // materials of the file
    CHECK(job_named("bunny").reflectance == 0.5f);
    CHECK(job_settings(job_named("bunny")).path.roulette == RenderSettings{}.path.roulette);
    CHECK(job_settings(job_named("S5")).path.roulette == Roulette::Throughput);
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
