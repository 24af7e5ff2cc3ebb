// pertev bench cameras: times a batch of small pictures, the same pictures one after the other, and one large
// picture.

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/bench_parts.h"
#include "apps/cli/flag_checks.h"
#include "apps/cli/interrupt.h"
#include "base/stopwatch.h"
#include "session/batch_render.h"
#include "settings/value_names.h"

namespace pertev {
namespace {

struct CamerasFlags {
    RenderFlags render;
    uint32_t pictures = 0; // 0: by the device
    uint32_t runs = 3;
};

/// A job of the benchmark: settings of its pictures, and how many of them there are.
struct Job {
    const char* name;
    RenderSettings settings;
    uint32_t pictures;
};

/// Returns the seconds of all pictures of a job as one batch, and adds up its rays.
double seconds_of_batch(PictureRenderer& pictures, const CameraBatch& batch, const RenderSettings& settings,
                        uint32_t at_once, BatchArrays& arrays, RayCounts& rays) {
    pictures.queue().wait();
    const Stopwatch watch;
    BatchRender render(pictures, batch, settings, at_once);
    while (render.next(arrays, InterruptSink())) {
    }
    pictures.queue().wait();
    throw_if_interrupted();
    rays = render.rays();
    return watch.seconds();
}

/// Returns the seconds of a picture by each of the first cameras, one after the other, including its layers' copies.
double seconds_in_turn(Session& session, const CameraBatch& batch, uint32_t count) {
    const Stopwatch watch;
    for (uint32_t k = 0; k < count; ++k) {
        throw_if_interrupted();
        session.set_camera(batch.cameras[k % batch.count()]);
        render_again(session, session.settings().samples);
        session.picture();
        session.layers();
    }
    return watch.seconds() / count;
}

int bench_cameras(CamerasFlags& flags) {
    Reporter reporter(flags.render.report);
    const std::unique_ptr<BenchedScene> benched = read_benched_scene(flags.render, kBenchCameras, reporter);
    const auto& [queue, scene, settings, camera, prepared, queues] = *benched;
    BenchReport report(reporter, flags.render.report, *queue, "Batches of cameras");
    const uint32_t pictures = flags.pictures > 0 ? flags.pictures : (queue->is_cuda() ? 8192 : 32);
    const float size = length(bounds_of(scene).size());

    Job centres = {"centres", settings, pictures};
    centres.settings.aovs = kAovDepth | kAovNormal | kAovIds;
    centres.settings.layers_at = LayersAt::Centre;
    Job direct = centres, paths = centres;
    centres.settings.samples = 0;
    direct.name = "direct"; // a camera ray through the centre of each pixel, for the layers too, and a shadow ray
    direct.settings.samples = 1, direct.settings.path.max_depth = 1;
    direct.settings.path.strategy = LightStrategy::NeeOnly;
    direct.settings.layers_at = LayersAt::Samples;
    sample_centres(direct.settings);
    paths.name = "paths";
    paths.pictures = std::max(pictures / 16, 1u);

    DeviceScene on_device(*queue);
    on_device.set(prepared, settings);
    PictureRenderer renderer(on_device);
    const std::size_t limit = batch_memory(*queue, settings, {}).bytes;
    double samples_per_second = 0;
    for (const Job& job : {centres, direct, paths}) {
        reporter.set_work(fmt::format("measuring {}", job.name));
        const CameraBatch batch = cameras_about(camera, job.pictures, size);
        const uint32_t at_once = pictures_at_once(prepared, batch, job.settings, limit, queue->is_cuda());
        BatchArrays arrays;
        RayCounts rays;
        std::vector<double> seconds;
        for (uint32_t run = 0; run <= flags.runs; ++run) { // the first one takes memory and warms up
            seconds.push_back(seconds_of_batch(renderer, batch, job.settings, at_once, arrays, rays));
        }
        seconds.erase(seconds.begin());
        const RunTimes times = summarize_runs(seconds);
        std::optional<double> in_turn;
        if (job.settings.samples > 0) {
            Session session(*queue, prepared, camera, job.settings);
            seconds_in_turn(session, batch, 2);
            in_turn = 1 / seconds_in_turn(session, batch, std::min(job.pictures, 64u));
        }
        const double pixels = static_cast<double>(settings.width) * settings.height * job.pictures;
        samples_per_second = pixels * job.settings.samples / times.median;
        Fields fields = {{"job", "job", job.name},
                         {"scene", "scene", flags.render.scene.scene},
                         {"device", "device", queue->device_name()},
                         {"width", "width", settings.width},
                         {"height", "height", settings.height},
                         {"pictures", "pictures", job.pictures},
                         {"at_once", "at once", at_once},
                         {"samples", "samples", job.settings.samples},
                         {"max_depth", "max depth", job.settings.path.max_depth}};
        for (ResultField& field : time_fields(times)) fields.push_back(std::move(field));
        fields.push_back({"pictures_per_second", "pictures/s", job.pictures / times.median, "", "{:.5g}"});
        fields.push_back({"in_turn_pictures_per_second", "one by one", in_turn, "", "{:.5g}"});
        fields.push_back({"rays_per_second", "rays/s", static_cast<double>(rays.total()) / times.median, "", "{:.4g}"});
        fields.push_back({"samples_per_second", "samples/s", samples_per_second, "", "{:.4g}"});
        report.add("cameras", fields);
    }

    // One large picture with the same settings and layers.
    RenderSettings large = paths.settings;
    large.width = 1920, large.height = 1080;
    Session session(*queue, prepared, camera, large);
    render_again(session, 1); // takes memory
    std::vector<double> seconds;
    for (uint32_t run = 0; run < (queue->is_cuda() ? flags.runs : 1); ++run) { // a CPU takes half a minute
        render_again(session, large.samples);
        seconds.push_back(session.stats().render_seconds);
    }
    const double rate = 1920.0 * 1080 * large.samples / summarize_runs(seconds).median;
    report.add("large_picture", {{"width", "width", large.width},
                                 {"height", "height", large.height},
                                 {"samples", "samples", large.samples},
                                 {"samples_per_second", "samples/s of one large picture", rate, "", "{:.4g}"},
                                 {"ratio_of_batch", "paths, of that", samples_per_second / rate, "", "{:.3f}"}});
    report.write();
    return 0;
}

} // namespace

void add_bench_cameras_command(CLI::App& bench, int& status) {
    const auto flags = std::make_shared<CamerasFlags>();
    CLI::App& verb = add_bench_verb(bench, "cameras", "Time batches of small pictures by many cameras",
                                    [flags, &status] { status = bench_cameras(*flags); });
    flags->render.size = PictureSize{128, 128};
    flags->render.render.path.max_depth = 5;
    flags->render.render.samples = 16;
    add_scene_name(verb, flags->render.scene);
    add_whole(verb, "--pictures", flags->pictures,
              "number of pictures in a batch; with all samples a sixteenth\n(8192 in CUDA, 32 on the CPU)", 1,
              10000000);
    add_whole(verb, "--runs", flags->runs, "number of timed runs; the result is the median", 1, 10000)
        ->capture_default_str();
    add_bench_report_flags(verb, flags->render.report);
    flags->render.settings.add(verb, kBenchCameras, flags->render);
}

} // namespace pertev
