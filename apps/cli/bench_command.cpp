// pertev bench: how fast this machine loads, builds and renders whole scenes as a user meets them.

#include <unistd.h>

#include <algorithm>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "accel/builders/bvh_cache.h"
#include "apps/cli/bench_parts.h"
#include "apps/cli/commands.h"
#include "apps/cli/interrupt.h"
#include "apps/cli/reporter.h"
#include "base/error.h"
#include "base/stopwatch.h"
#include "session/devices/machine.h"
#include "session/opening/choose_camera.h"
#include "session/opening/open_scene.h"
#include "session/session.h"
#include "settings/tracer_options.h"

namespace pertev {
namespace {

constexpr const char* kSize = "1920x1080";

/// A temporary cache folder.
class ScratchCache {
public:
    ScratchCache() : path_(std::filesystem::temp_directory_path() / fmt::format("pertev-bench-{}", ::getpid())) {}
    ~ScratchCache() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    ScratchCache(const ScratchCache&) = delete;
    ScratchCache& operator=(const ScratchCache&) = delete;
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

/// Returns the row of a scene on a device.
Fields measure(const std::string& file, Queue& queue, RenderSettings settings) {
    Sink& sink = nobody();
    const Stopwatch watch;
    const Scene scene = open_scene(file, sink, SceneUse::Benchmark);
    const double load_s = watch.seconds();
    const ScratchCache cache;
    PrepareOptions options = trees_for(settings, queue);
    const PrepareOptions uncached = options;
    options.bvh_cache = cache.path();
    throw_if_interrupted();
    const PreparedScene prepared = prepare_scene(scene, options, sink); // fills the cache, too
    throw_if_interrupted();
    const PreparedScene cached = prepare_scene(scene, options, sink);
    const double build_s = prepare_scene(scene, uncached, sink).build_seconds;

    const Camera camera = choose_camera(CameraChoice{}, scene, aspect_of(settings.width, settings.height), sink);
    {
        Session warm_up(queue, cached, camera, settings); // leaves the trees of `prepared` unconverted
        render_again(warm_up, 1);
    }
    Session session(queue, prepared, camera, settings);
    render_again(session, settings.samples);
    const RenderStats whole = session.stats();

    settings.time_kinds = true; // once more, each kind of ray on its own
    settings.body = PathBody::Wavefront;
    session.set_settings(settings);
    render_again(session, settings.samples);
    const RenderStats staged = session.stats();
    const auto rate = [](uint64_t count, double seconds) { return 1e6 * millions_a_second(count, seconds); };
    const uint64_t samples = uint64_t(settings.width) * settings.height * whole.samples;
    return {
        {"scene", "scene", std::filesystem::path(file).stem().string()},
        {"device", "device", queue.device_name()},
        {"triangles", "triangles", prepared.triangles},
        {"load_seconds", "load", load_s, "s", "{:.3f}"},
        {"build_seconds", "build", build_s, "s", "{:.3f}"},
        {"cached_seconds", "cached", cached.build_seconds, "s", "{:.3f}"},
        {"first_pixel_seconds", "first", whole.upload_seconds + whole.first_pixel_seconds, "s", "{:.3f}"},
        {"render_seconds", "render", whole.render_seconds, "s", "{:.3f}"},
        {"samples_per_second", "samples/s", rate(samples, whole.render_seconds), "", "{:.4g}"},
        {"camera_rays_per_second", "camera rays/s", rate(staged.rays.camera, staged.kind_seconds.camera), "", "{:.4g}"},
        {"bounce_rays_per_second", "bounce rays/s", rate(staged.rays.bounce, staged.kind_seconds.bounce), "", "{:.4g}"},
        {"shadow_rays_per_second", "shadow rays/s", rate(staged.rays.shadow, staged.kind_seconds.shadow), "",
         "{:.4g}"}};
}

/// Sponza and Sibenik of the test scenes, in the folder PERTEV_SCENES.
std::vector<std::string> default_scenes() {
    const std::filesystem::path root = public_scenes_folder();
    std::vector<std::string> scenes;
    for (const char* name : {"crytek-sponza/sponza.obj", "sibenik/sibenik.obj"}) {
        if (!root.empty() && std::filesystem::exists(root / name)) scenes.push_back((root / name).string());
    }
    if (scenes.empty()) {
        throw Error(ErrorCode::BadInput, "scene", "",
                    "name scene files, or set PERTEV_SCENES to the folder with crytek-sponza/sponza.obj and "
                    "sibenik/sibenik.obj (docs/scenes.md)");
    }
    return scenes;
}

int bench_scenes(PictureFlags& flags) {
    Reporter reporter(flags.report);
    flags.settings.read(flags, reporter);
    RenderSettings settings;
    const PictureSize size = flags.size.value_or(PictureSize{1920, 1080});
    settings.width = size.width, settings.height = size.height;
    const std::vector<std::string> scenes = flags.scenes.empty() ? default_scenes() : flags.scenes;
    for (const std::string& scene : scenes) check_bench_scene(scene);
    listen_for_interrupt();
    std::vector<std::unique_ptr<Queue>> queues;
    queues.push_back(open_queue(flags.machine, reporter));
    const UseThreads threads(queues.front()->threads());
    if (flags.machine.device == "auto" && queues.front()->is_cuda()) {
        queues.push_back(std::make_unique<Queue>(Queue::make_cpu()));
    }
    reporter.report_messages();
    BenchReport report(reporter, flags.report, *queues.front(), "Loading, building and rendering");
    for (const std::string& scene : scenes) {
        for (const auto& queue : queues) {
            reporter.set_work(fmt::format("measuring {} on {}", scene, queue->device_name()));
            settings.tracers = tracer_choice(flags.tracer, queue->is_cuda());
            settings.samples = flags.is_given("spp") ? flags.render.samples : (queue->is_cuda() ? 64 : 4);
            report.add("bench", measure(scene, *queue, settings));
        }
    }
    report.write();
    return 0;
}

} // namespace

void add_bench_command(CLI::App& app, int& status) {
    CLI::App& verb = *app.add_subcommand("bench", "Measure loading, building and rendering on this machine");
    const auto flags = std::make_shared<PictureFlags>();
    verb.add_option("--scene", flags->scenes,
                    "a scene file or a built-in scene; may be given again\n(Sponza and Sibenik under PERTEV_SCENES)")
        ->type_name("FILE")
        ->allow_extra_args(false);
    add_picture_flags(verb, kBench, *flags, "1920x1080", "64 in CUDA, 4 on the CPU");
    add_bench_render_command(verb, status);
    add_bench_rays_command(verb, status);
    add_bench_frames_command(verb, status);
    add_bench_noise_command(verb, status);
    add_bench_sequence_command(verb, status);
    add_bench_cameras_command(verb, status);
    add_bench_devices_command(verb, status);
    add_bench_build_command(verb, status);
    add_bench_page_command(verb, status);
    verb.require_subcommand(0, 1);
    verb.callback([&verb, flags, &status] {
        if (verb.get_subcommands().empty()) status = bench_scenes(*flags);
    });
}

} // namespace pertev
