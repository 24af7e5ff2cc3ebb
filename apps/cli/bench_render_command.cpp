// pertev bench render: one job that other renderers were timed on (bench/jobs.json). It prints the ratio to their rates
// if device, scene and settings equal theirs (lab/stored_figures.h).

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/bench_parts.h"
#include "apps/cli/commands.h"
#include "apps/cli/flag_checks.h"
#include "apps/cli/interrupt.h"
#include "base/stopwatch.h"
#include "device/device_timer.h"
#include "image/metrics.h"
#include "image/picture_hash.h"
#include "image/write_image.h"
#include "lab/isolated_rays.h"
#include "lab/record_scenes.h"
#include "lab/stored_figures.h"
#include "session/devices/machine.h"
#include "session/writing/check_outputs.h"
#include "settings/tracer_options.h"

namespace pertev {
namespace {

// Least time of a measurement, unless it takes so many runs.
constexpr double kLeastSeconds = 0.3;
constexpr uint32_t kMostRuns = 1000;

struct JobFlags {
    PictureFlags picture;
    std::string job = "S8", output;
    uint32_t moves = 0;
    bool isolated = false;
};

/// Returns the median time of one sample per pixel after a move of the camera, from the call that moves it until the
/// film has the sample. The moves alternate between two directions a thousandth of a radian apart, so the view stays
/// about the same.
double seconds_after_moves(Session& session, uint32_t moves) {
    const Camera camera = session.camera();
    std::vector<double> seconds;
    for (uint32_t k = 0; k < moves; ++k) {
        throw_if_interrupted();
        const Stopwatch watch;
        session.set_camera(moved(camera, k % 2 == 0 ? 0.001f : -0.001f, {}));
        session.render(1);
        seconds.push_back(watch.seconds());
    }
    return summarize_runs(seconds).median;
}

/// Measures the isolated rays of each kind in the job's scene, by the job's tracers.
IsolatedRates isolated_rates(Queue& queue, const RecordJob& job, const Scene& scene, const TracerChoice& choice,
                             Reporter& reporter) {
    reporter.set_work("measuring rays in isolation");
    const PreparedScene prepared =
        prepare_scene(scene, {.bvh = {}, .bvh_cache = {}, .tracers = choice, .keep_coordinates = true}, reporter);
    const Camera camera = job_camera(job, scene, 16.0f / 9.0f, reporter);    // the aspect of the sets' frames
    const uint32_t count = queue.is_cuda() ? kRecordRays : kRecordRays / 16; // a CPU takes seconds for these
    return measure_isolated_rays(queue, scene, camera, prepared, choice, count, reporter);
}

int bench_job(JobFlags& flags) {
    Reporter reporter(flags.picture.report);
    flags.picture.settings.read(flags.picture, reporter);
    const RecordJob& job = *find_named(the_record().jobs, flags.job);
    const std::string& file = flags.picture.scenes.front();
    RenderSettings settings = job_settings(job);
    if (const auto& size = flags.picture.size) settings.width = size->width, settings.height = size->height;
    if (flags.picture.is_given("spp")) settings.samples = flags.picture.render.samples;
    settings.path.seed = flags.picture.render.path.seed;
    if (!flags.output.empty()) {
        refuse_list(flags.output);
        note_number_signs(flags.output, reporter);
        check_image_output(flags.output, settings.width, settings.height);
    }
    check_bench_scene(file);
    listen_for_interrupt();
    const std::unique_ptr<Queue> queue = open_queue(flags.picture.machine, reporter);
    const UseThreads threads(queue->threads());
    settings.tracers = tracer_choice(flags.picture.tracer, queue->is_cuda());
    BenchReport report(reporter, flags.picture.report, *queue, "One job of the record");
    reporter.set_work(fmt::format("measuring {}", file));
    const Stopwatch watch;
    const Scene scene = make_job_scene(job, file, reporter);
    const double load_s = watch.seconds();
    throw_if_interrupted();
    const PreparedScene prepared = prepare_scene(scene, trees_for(settings, *queue), reporter);
    const Camera camera = job_camera(job, scene, aspect_of(settings.width, settings.height), reporter);
    reporter.report_messages();

    Session session(*queue, prepared, camera, settings);
    render_again(session, 1); // clocks, caches, the driver's first launch
    double render_s = 0;      // the sum over the runs, then the mean
    uint32_t runs = 0;
    do { // pictures of a millisecond are timed one after the other
        render_again(session, settings.samples);
        render_s += session.stats().render_seconds;
    } while (++runs < kMostRuns && render_s < kLeastSeconds);
    const RenderResult result = session.result();
    render_s /= runs;
    const std::string hash = picture_hash(result.picture).hex();
    if (!flags.output.empty()) {
        reporter.write_output(flags.output, [&] { write_image(flags.output, result.picture); });
    }
    const double pixels = static_cast<double>(settings.width) * settings.height, samples = pixels * settings.samples;
    const double samples_per_second = samples / render_s, mean = mean_of(result.picture);
    std::optional<double> moved_per_second;
    if (flags.moves > 0) moved_per_second = pixels / seconds_after_moves(session, flags.moves);
    const double rays_per_second = static_cast<double>(result.rays.total()) / render_s;
    std::optional<double> of_isolated;
    if (flags.isolated) {
        const IsolatedRates rates =
            isolated_rates(*queue, job, scene, tracers_of(settings, queue->is_cuda()), reporter);
        if (const double mix = rates.of_mix(result.rays); mix > 0) of_isolated = rays_per_second / mix;
    }
    const std::string device = queue->device_name();
    const bool is_known = is_on_record(device, job, settings, prepared.triangles, mean);
    const auto ratio_to = [&](const char* key, const char* title, double other) {
        return ratio_field(key, title, is_known && other > 0, samples_per_second / other);
    };
    const Fields fields = {
        {"job", "job", job.name},
        {"device", "device", device},
        {"width", "width", settings.width},
        {"height", "height", settings.height},
        {"samples", "samples per pixel", settings.samples},
        {"triangles", "triangles", prepared.triangles},
        {"load_seconds", "load", load_s, "s", "{:.3f}"},
        {"build_seconds", "trees", prepared.build_seconds, "s", "{:.3f}"},
        {"runs", "runs", runs},
        {"render_seconds", "render", render_s, "s", "{:.4g}"},
        {"samples_per_second", "samples per second", samples_per_second, "", "{:.4g}"},
        {"rays_per_second", "rays per second", rays_per_second, "", "{:.4g}"},
        {"rays_per_sample", "rays per sample", static_cast<double>(result.rays.total()) / samples, "", "{:.2f}"},
        {"ratio_to_isolated_rays", "of the same rays in isolation", of_isolated, "", "{:.3f}"},
        {"moved_samples_per_second", "samples per second after a move", moved_per_second, "", "{:.4g}"},
        {"mean", "mean", mean, "", "{:.5f}"},
        {"invalid_samples", "invalid samples", result.invalid_samples},
        {"hash", "picture", hash},
        ratio_to("ratio_to_mitsuba", "times Mitsuba 3", job.mitsuba),
        ratio_to("ratio_to_cycles", "times Cycles", job.cycles),
        ratio_to("ratio_to_pbrt", "times pbrt-v4", job.pbrt)};
    report.add_alone("job", fields);
    if (!is_known && job.mitsuba > 0) reporter.answer(why_no_ratios(job));
    report.write();
    return 0;
}

} // namespace

void add_bench_render_command(CLI::App& bench, int& status) {
    const auto flags = std::make_shared<JobFlags>();
    CLI::App& verb = add_bench_verb(bench, "render", "Time a job that other renderers were timed on",
                                    [flags, &status] { status = bench_job(*flags); });
    flags->picture.tracer.default_build = TreeBuild::Best; // only the render is timed
    std::vector<std::string> names;
    for (const RecordJob& job : the_record().jobs) names.emplace_back(job.name);
    verb.add_option(
            "--job", flags->job,
            "S5 or S8: grey geometry under a constant sky, at most 5 or 8\nscatterings, Russian roulette from the "
            "second; sponza-textured: the\nsame view with the file's materials, bunny: grey, both with the\ndefault "
            "roulette; cornell-box-65 or cornell-box-8: the\nfile as it is, "
            "at most 65 or 8 edges from the camera to a light;\ncorridor: the file as it is, direct light")
        ->type_name("NAME")
        ->check(one_of(std::move(names)))
        ->capture_default_str();
    verb.add_option("--scene", flags->picture.scenes,
                    "the job's scene: Crytek's Sponza, Bitterli's Cornell box as a\nglTF, the Stanford bunny, or a "
                    "corridor of 5,000 emitters\nby tools/make_corridor.py")
        ->type_name("FILE")
        ->required()
        ->expected(1);
    add_whole(verb, "--moves", flags->moves,
              "number of camera moves, after each of which one sample per\npixel is timed (0)", 0, 100000);
    verb.add_flag("--isolated", flags->isolated,
                  "also traces the sets of `bench rays` in isolation and reports\nthe job's rate relative to theirs");
    verb.add_option("-o,--output", flags->output, "writes the picture to this file")->type_name("FILE");
    add_picture_flags(verb, kBenchRender, flags->picture, "the job's", "the job's");
}

} // namespace pertev
