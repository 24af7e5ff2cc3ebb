// pertev bench frames: how long a frame in real time takes while the camera moves, with reconstruction and tone
// mapping, and how much of that the reconstruction is.

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/bench_parts.h"
#include "apps/cli/flag_checks.h"
#include "apps/cli/interrupt.h"
#include "apps/cli/render_flags.h"
#include "base/error.h"
#include "device/device_timer.h"
#include "image/picture_hash.h"
#include "math/portable_math.h"
#include "session/devices/device_names.h"
#include "session/devices/session_on_devices.h"
#include "settings/parse_values.h"
#include "settings/settings_file.h"
#include "settings/value_names.h"

namespace pertev {
namespace {

struct FramesFlags {
    RenderFlags render;
    uint32_t frames = 60;
    bool still = false;
};

/// Returns the camera of a frame, which moves forward by a thousandth of the scene per frame and looks to the left and
/// to the right.
Camera camera_of(const Camera& first, uint32_t frame, float scene_size) {
    const float k = static_cast<float>(frame);
    return moved(first, 0.35f * sin(k * 0.05f), {0, 0, -0.001f * scene_size * k});
}

std::string names_of(std::span<const std::shared_ptr<Queue>> queues) {
    std::vector<std::string> names;
    for (const auto& queue : queues) names.push_back(queue->device_name());
    return text_of_devices(names);
}

int bench_frames(FramesFlags& flags) {
    Reporter reporter(flags.render.report);
    const std::unique_ptr<BenchedScene> benched = read_benched_scene(flags.render, kBenchFrames, reporter);
    const auto& [queue, scene, settings, camera, prepared, queues] = *benched;
    if (!makes_frames(settings.integrator)) refuse_several_devices(flags.render.machine.device, "plain samples");
    refuse(!makes_frames(settings.integrator) && flags.render.reconstruction.has_frame_options(),
           {"integrator", std::string(integrator_name(settings)),
            "this integrator's frames are plain samples; `restir` and `resolution_scale` apply to path and hybrid"});
    BenchReport report(reporter, flags.render.report, *queue, "Frames in real time");
    SessionOnDevices opened(queues, prepared, camera, settings, {.frames = true});
    Session& session = opened.session();
    const ToneMap tone_map = ToneMap::Agx;
    const float exposure = session.meter(tone_map);
    session.cut();
    const ReconstructionOptions& options = flags.render.reconstruction;
    const Camera first = session.camera();
    const float size = length(bounds_of(scene).size());
    const bool reconstructs = makes_frames(settings.integrator);
    std::vector<double> whole, reconstruction, copy; // `copy`: time of copying the displayed picture to the host
    RayCounts rays;
    double seconds = 0;
    DeviceTimer timer(*queue);
    for (uint32_t frame = 0; frame < flags.frames; ++frame) {
        throw_if_interrupted();
        timer.start();
        if (!flags.still) session.set_camera(camera_of(first, frame, size));
        if (reconstructs) {
            session.render_frame(frame, options.used(), options.sharing);
            session.frame().display(tone_map, exposure);
        } else {
            if (flags.still) session.cut();
            session.render(1);
            session.display(tone_map, exposure);
        }
        timer.stop();
        reporter.progress((frame + 1.0) / flags.frames, fmt::format("frame {} of {}", frame + 1, flags.frames));
        if (frame < 2 && flags.frames > 2) continue; // memory is taken, nothing is warm
        whole.push_back(timer.seconds());
        reconstruction.push_back(reconstructs ? session.frame().seconds() : 0);
        copy.push_back(reconstructs ? session.frame().copy_seconds() : 0);
        rays = rays + (reconstructs ? session.frames().rays() : session.stats().rays);
        seconds += whole.back();
    }
    const RunTimes times = summarize_runs(whole);
    const Image last = reconstructs ? session.frame().picture() : session.picture();
    reporter.end_progress();
    report.add_alone(
        "frames",
        {{"scene", "scene", flags.render.scene.scene},
         {"device", "device", names_of(queues)},
         {"integrator", "integrator", integrator_name(settings)},
         {"width", "width", settings.width},
         {"height", "height", settings.height},
         {"max_depth", "max depth", settings.path.max_depth},
         {"frames", "frames", flags.frames},
         {"still", "camera is still", flags.still},
         {"reconstruction", "reconstruction", ResultCell::raw(reconstruction_json(options, settings.frame_depth))},
         {"median_seconds", "frame, median", times.median, "s", "{:.6f}"},
         {"least_seconds", "least", times.least, "s", "{:.6f}"},
         {"greatest_seconds", "greatest", times.greatest, "s", "{:.6f}"},
         {"frames_per_second", "frames per second", 1 / times.median, "", "{:.1f}"},
         {"reconstruction_seconds", "reconstruction time", summarize_runs(reconstruction).median, "s", "{:.6f}"},
         {"copy_seconds", "copy to the host", summarize_runs(copy).median, "s", "{:.6f}"},
         {"mrays_per_s", "Mrays/s", millions_a_second(rays.total(), seconds), "", "{:.1f}"},
         {"picture", "last frame", picture_hash(last).hex()}});
    report.write();
    return 0;
}

} // namespace

void add_bench_frames_command(CLI::App& bench, int& status) {
    const auto flags = std::make_shared<FramesFlags>();
    CLI::App& verb = add_bench_verb(bench, "frames", "Time real-time frames of one sample per pixel, reconstructed",
                                    [flags, &status] { status = bench_frames(*flags); });
    flags->render.size = PictureSize{1920, 1080};
    flags->render.render.path.max_depth = 4;
    add_scene_name(verb, flags->render.scene);
    add_whole(verb, "--frames", flags->frames, "number of frames; the first two are not timed", 1, 100000)
        ->capture_default_str();
    verb.add_flag("--still", flags->still, "keeps the camera still");
    add_bench_report_flags(verb, flags->render.report);
    flags->render.settings.add(verb, kBenchFrames, flags->render);
}

} // namespace pertev
