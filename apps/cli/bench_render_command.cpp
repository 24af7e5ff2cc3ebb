// pertev bench render: one job that other renderers were timed on (lab/record_jobs.h), and how many times as fast as
// they it is done where that can be said (lab/stored_figures.h).

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
#include "image/picture_hash.h"
#include "image/write_image.h"
#include "integrators/path/path_integrator.h"
#include "lab/isolated_rays.h"
#include "lab/record_jobs.h"
#include "lab/stored_figures.h"
#include "session/machine.h"
#include "settings/parse_values.h"

namespace pertev {
namespace {

struct JobFlags {
    PictureFlags picture;
    std::string job = "S8", output;
    uint32_t seed = 0, moves = 0;
    bool isolated = false;
};

RenderSettings settings_of(const RecordJob& job, const JobFlags& flags) {
    RenderSettings settings = job_settings(job);
    if (!flags.picture.size_text.empty()) {
        std::tie(settings.width, settings.height) = parse_size("--size", flags.picture.size_text);
    }
    if (flags.picture.samples > 0) settings.samples = flags.picture.samples;
    settings.path.seed = flags.seed;
    return settings;
}

struct JobBytes {
    std::size_t of_queues = 0;           // of paths in flight
    std::optional<double> of_structures; // on a GPU, a triangle; on a CPU trees are not copied
};

JobBytes bytes_of(const RenderSettings& settings, const PreparedScene& prepared, const Queue& queue) {
    JobBytes bytes;
    const TracerChoice tracers = tracers_of(settings, queue.is_cuda());
    bytes.of_queues = predicted_bytes(settings,
                                      {.width = settings.width,
                                       .height = settings.height,
                                       .samples = settings.samples,
                                       .walks_on_host = can_walk_on_host(tracers, queue.is_cuda())},
                                      queue.is_cuda());
    if (queue.is_cuda() && prepared.triangles > 0) {
        bytes.of_structures =
            static_cast<double>(prepared.structures->device_bytes(tracers)) / static_cast<double>(prepared.triangles);
    }
    return bytes;
}

/// Seconds that one sample of every pixel takes after the camera has moved, from the call that moves it until the film
/// has the sample: the median of so many moves. They turn the camera to and fro by a thousandth of a radian, so that
/// what is seen stays about the same.
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

/// Rays a second of each kind by themselves, in the job's scene and by what the job traces them by.
IsolatedRates isolated_rates(Queue& queue, const RecordJob& job, const Scene& scene, const TracerChoice& choice,
                             Reporter& reporter) {
    reporter.set_work("measuring rays by themselves");
    const PreparedScene prepared = prepare_scene(
        scene, {.bvh = {}, .bvh_cache = {}, .tracers = choice, .keep_coordinates = true}, reporter.messages());
    const Camera camera = job_camera(job, scene, 16.0f / 9.0f, reporter.messages()); // as the sets' frames
    const uint32_t count = queue.is_cuda() ? kRecordRays : kRecordRays / 16;         // a CPU takes seconds for these
    return measure_isolated_rays(queue, scene, camera, prepared, choice, count, throw_if_interrupted);
}

int bench_job(JobFlags& flags) {
    Reporter reporter(flags.picture.report);
    Messages& messages = reporter.messages();
    flags.picture.settings.read(flags.picture, messages);
    const RecordJob& job = *find_record_job(flags.job);
    const std::string& file = flags.picture.scenes.front();
    RenderSettings settings = settings_of(job, flags);
    if (!flags.output.empty()) {
        refuse_list(flags.output);
        note_number_signs(flags.output, "with pertev render --frames A-B alone", messages);
        check_image_output(flags.output, settings.width, settings.height);
    }
    check_bench_scene(file);
    listen_for_interrupt();
    const std::unique_ptr<Queue> queue = take_machine(flags.picture.machine, messages);
    settings.tracers = tracer_choice(flags.picture.tracer, queue->is_cuda());
    reporter.set_work(fmt::format("measuring {}", file));
    const Stopwatch watch;
    const Scene scene = make_job_scene(job, file, messages);
    const double load_s = watch.seconds();
    throw_if_interrupted();
    const PreparedScene prepared = prepare_scene(scene, trees_for(settings, *queue), messages);
    const Camera camera = job_camera(job, scene, aspect_of(settings.width, settings.height), messages);
    reporter.say_messages();

    Session session(*queue, prepared, camera, settings);
    render_anew(session, 1); // clocks, caches, the driver's first launch
    render_anew(session, settings.samples);
    const RenderResult result = session.result();
    const std::string hash = picture_hash(result.picture).hex();
    if (!flags.output.empty()) {
        reporter.write_output(flags.output, [&] { write_image(flags.output, result.picture); });
    }
    const double pixels = static_cast<double>(settings.width) * settings.height, samples = pixels * settings.samples;
    const double samples_per_second = samples / result.render_seconds, mean = mean_of(result.picture);
    std::optional<double> moved_per_second;
    if (flags.moves > 0) moved_per_second = pixels / seconds_after_moves(session, flags.moves);
    const double rays_per_second = static_cast<double>(result.rays.total()) / result.render_seconds;
    std::optional<double> of_isolated;
    if (flags.isolated) {
        const IsolatedRates rates =
            isolated_rates(*queue, job, scene, tracers_of(settings, queue->is_cuda()), reporter);
        if (const double mix = rates.of_mix(result.rays); mix > 0) of_isolated = rays_per_second / mix;
    }
    const JobBytes bytes = bytes_of(settings, prepared, *queue);
    const std::size_t path_bytes = PathIntegrator::bytes_of_path({});
    const std::string device = queue->device_name();
    const std::vector<Ratio> ratios = ratios_of(JobRun{device, &job, settings.width, settings.height, settings.samples,
                                                       prepared.triangles, mean, samples_per_second});
    if (flags.picture.report.json) {
        reporter.event(fmt::format(
            R"({{"event":"job","job":"{}","device":{},"width":{},"height":{},"samples":{},"triangles":{},"load_seconds":{:.4f},"build_seconds":{:.4f},"render_seconds":{:.4f},"samples_per_second":{:.0f},"rays_per_second":{:.0f},"rays_per_sample":{:.3f},"ratio_to_isolated_rays":{},"queue_bytes":{},"bytes_per_path":{},"structure_bytes_per_triangle":{},"moved_samples_per_second":{},"mean":{:.6f},"invalid_samples":{},"hash":"{}",{}}})",
            job.name, json_string(device), settings.width, settings.height, settings.samples, prepared.triangles,
            load_s, prepared.build_seconds, result.render_seconds, samples_per_second, rays_per_second,
            static_cast<double>(result.rays.total()) / samples,
            of_isolated ? fmt::format("{:.4f}", *of_isolated) : "null", bytes.of_queues, path_bytes,
            bytes.of_structures ? fmt::format("{:.2f}", *bytes.of_structures) : "null",
            moved_per_second ? fmt::format("{:.0f}", *moved_per_second) : "null", mean, result.invalid_samples, hash,
            ratios_json(ratios)));
    } else {
        reporter.answer(
            fmt::format("job {} on {}: {}x{}, {} spp, {} triangles\nload {:.3f} s, trees {:.3f} s, render {:.3f} s\n"
                        "{:.2f} Msamples/s, {:.1f} Mrays/s, {:.2f} rays a sample\n{}\nmean {:.5f}, picture {}\n",
                        job.name, device, settings.width, settings.height, settings.samples, prepared.triangles, load_s,
                        prepared.build_seconds, result.render_seconds, samples_per_second * 1e-6,
                        millions_a_second(result.rays.total(), result.render_seconds),
                        static_cast<double>(result.rays.total()) / samples, ratios_line(ratios, job), mean, hash));
        if (bytes.of_structures) {
            reporter.answer(fmt::format(
                "queues of paths {:.1f} MB, {} bytes a path, trees with their triangles {:.1f} bytes a triangle\n",
                static_cast<double>(bytes.of_queues) * 1e-6, path_bytes, *bytes.of_structures));
        }
        if (of_isolated) {
            reporter.answer(fmt::format("rays a second: {:.3f} of the same mix of the record's rays by themselves\n",
                                        *of_isolated));
        }
        if (moved_per_second) {
            reporter.answer(
                fmt::format("one sample a pixel after the camera moved: {:.2f} Msamples/s, {:.3f} of {} spp\n",
                            *moved_per_second * 1e-6, *moved_per_second / samples_per_second, settings.samples));
        }
    }
    return 0;
}

} // namespace

void add_bench_render_command(CLI::App& bench, int& status) {
    CLI::App& verb = *bench.add_subcommand("render", "One job that other renderers were timed on");
    const auto flags = std::make_shared<JobFlags>();
    flags->picture.tracer.default_build = TreeBuild::Best; // what is timed is the render alone
    std::vector<std::string> names;
    for (const RecordJob& job : record_jobs()) names.emplace_back(job.name);
    verb.add_option(
            "--job", flags->job,
            "S5 or S8: grey geometry under a constant sky, at most 5 or 8\nscatterings, Russian roulette from the "
            "second;\ncornell-box-65 or cornell-box-8: the file as it is, at most\n65 or 8 edges from the camera to "
            "a light")
        ->type_name("NAME")
        ->check(one_of(std::move(names)))
        ->capture_default_str();
    verb.add_option("--scene", flags->picture.scenes,
                    "the job's: Crytek's Sponza or Bitterli's Cornell box, as a\nglTF")
        ->type_name("FILE")
        ->required()
        ->expected(1);
    add_whole(verb, "--seed", flags->seed, "of the random numbers", 0, UINT32_MAX)->capture_default_str();
    add_whole(verb, "--moves", flags->moves,
              "move the camera so often, too, and time one sample of every\npixel after each move (0)", 0, 100000);
    verb.add_flag("--isolated", flags->isolated,
                  "trace the sets of `bench rays` by themselves, too, and say\nwhat share of their rate the job's rays "
                  "have");
    verb.add_option("-o,--output", flags->output, "keep the picture")->type_name("FILE");
    add_picture_flags(verb, flags->picture, "the job's", "the job's");
    verb.callback([&verb, flags, &status] {
        refuse_flags_before(verb);
        status = bench_job(*flags);
    });
}

} // namespace pertev
