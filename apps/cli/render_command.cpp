// pertev render SCENE -o OUT

#include <algorithm>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "accel/bvh/bvh_cache.h"
#include "apps/cli/choose_display.h"
#include "apps/cli/commands.h"
#include "apps/cli/interrupt.h"
#include "apps/cli/render_flags.h"
#include "apps/cli/render_frames.h"
#include "apps/cli/report_result.h"
#include "base/byte_units.h"
#include "base/error.h"
#include "base/message_text.h"
#include "base/stopwatch.h"
#include "formats/read_camera_path.h"

namespace pertev {
namespace {

/// Of the samples, or of the time where that ends first.
double share_done(const RenderProgress& now, double time_limit_s) {
    const double of_samples = static_cast<double>(now.samples_done) / now.samples;
    return time_limit_s > 0 ? std::max(of_samples, std::min(now.seconds / time_limit_s, 1.0)) : of_samples;
}

/// Shows the progress; false when asked to end.
bool report_progress(const RenderProgress& now, double time_limit_s, Reporter& reporter) {
    const double share = share_done(now, time_limit_s);
    reporter.progress(share, fmt::format("{}/{} spp  {:.1f} Mrays/s  {:.0f} s left", now.samples_done, now.samples,
                                         static_cast<double>(now.rays.total()) / now.seconds * 1e-6,
                                         now.seconds * (1 - share) / std::max(share, 1e-9)));
    reporter.event(fmt::format(R"({{"event":"progress","samples":{},"of":{},"seconds":{:.3f},"rays":{}}})",
                               now.samples_done, now.samples, now.seconds, now.rays.total()));
    return !interrupted();
}

void say_hidden_backs(double share, Messages& messages) {
    if (!(share > 0.01)) return;
    messages.note(fmt::format("the camera looks through the backs of surfaces at {:.0f} % of the picture, as they are "
                              "not double sided (--show-back-faces shows them)",
                              100 * share));
}

/// --strict: throws Error(BadInput) that repeats the first warning of a texture or a file of materials that is missing.
void refuse_missing(const Messages& messages) {
    const std::vector<Message>& all = messages.all();
    const auto missing = static_cast<uint64_t>(std::ranges::count_if(all, &Message::is_missing));
    if (missing == 0) return;
    throw Error(ErrorCode::BadInput,
                fmt::format("--strict: {}{}; nothing is rendered",
                            std::ranges::find_if(all, &Message::is_missing)->text,
                            missing > 1 ? fmt::format(" (and {} like it)", counted(missing - 1, "warning")) : ""));
}

/// What is about to be rendered, and on what.
void report_start(const RenderFlags& flags, const Scene& scene, const PreparedScene& prepared,
                  const RenderSettings& settings, const Queue& queue, double load_s, Reporter& reporter) {
    const std::size_t bytes = predicted_bytes(prepared, settings, queue.is_cuda());
    reporter.say(fmt::format("{}: {}, {}, {}; loaded in {:.2f} s, trees in {:.2f} s; "
                             "rendering {}x{}, {} spp on {}, which takes {:.0f} MiB there",
                             flags.scene.scene, counted(prepared.triangles, "triangle"),
                             counted(scene.instances.size(), "instance"), counted(prepared.lights.count(), "light"),
                             load_s, prepared.build_seconds, settings.width, settings.height, settings.samples,
                             queue.device_name(), mebibytes(bytes)));
    reporter.event(fmt::format(
        R"({{"event":"scene","scene":{},"triangles":{},"instances":{},"lights":{},"load_seconds":{:.6f},"build_seconds":{:.6f}}})",
        json_string(flags.scene.scene), prepared.triangles, scene.instances.size(), prepared.lights.count(), load_s,
        prepared.build_seconds));
    reporter.event(
        fmt::format(R"({{"event":"picture","width":{},"height":{},"spp":{},"device":{},"predicted_bytes":{}}})",
                    settings.width, settings.height, settings.samples, json_string(queue.device_name()), bytes));
}

SceneSource scene_source(const SceneOptions& options, const Scene& scene) {
    return {.scene = options.scene,
            .environment = options.environment,
            .environment_scale = options.environment_scale,
            .environment_rotation_deg = options.environment_rotation_deg,
            .has_environment = scene.environment.has_value(),
            .two_sided_lights = options.two_sided_lights,
            .show_back_faces = options.show_back_faces};
}

/// Says what a time would show where none is given, or that one shows nothing.
void say_what_moves(const RenderFlags& flags, const MovingScene& moving, Messages& messages) {
    const bool has_time = flags.time_s || !flags.frames.empty();
    if (moving.is_animated() && !has_time) {
        double end_s = 0;
        for (const Animation& animation : moving.scene().animations) end_s = std::max(end_s, animation.end_s());
        messages.note(fmt::format("{}: shown at rest; --time S shows it at a time of its {} (0 to {:.4g} s)",
                                  flags.scene.scene, counted(moving.scene().animations.size(), "animation"), end_s));
    }
    if (!moving.is_animated() && has_time && flags.camera_path.empty() && flags.turntable == 0) {
        messages.warn(fmt::format("--{}: nothing moves in this scene (--time-limit ends a render after a time)",
                                  flags.time_s ? "time" : "frames"));
    }
}

int write_one(const RenderFlags& flags, const RenderSettings& settings, PictureRecord& record,
              std::optional<Session>& session, const Queue& queue, const Stopwatch& watch, Reporter& reporter) {
    session->render(settings.samples,
                    [&](const RenderProgress& now) { return report_progress(now, settings.time_limit_s, reporter); });
    RenderResult result = session->result();
    session.reset(); // writing takes memory too
    reporter.end_progress();
    const bool cut_short = interrupted() && result.samples < settings.samples;
    if (cut_short) reporter.say(fmt::format("interrupted after {} of {} spp", result.samples, settings.samples));
    say_hidden_backs(result.hidden_back_share, reporter.messages());
    reporter.say_messages();
    reporter.set_work("writing");
    const WrittenPicture written = write_picture(flags.outputs, record, result);
    const std::string failures = report_files(written, reporter);
    report_result(result, written.hash, queue, watch.seconds(), cut_short, reporter);
    if (!failures.empty()) throw Error(ErrorCode::FileWrite, failures);
    if (flags.strict && result.invalid_samples > 0) throw not_finite(result.invalid_samples);
    return cut_short ? exit_status(ErrorCode::Interrupted) : 0;
}

int render(const RenderFlags& flags) {
    Reporter reporter(flags.report);
    Messages& messages = reporter.messages();
    check_render_flags(flags, messages);
    const std::optional<FrameSequence> frames = frame_sequence(flags);
    std::optional<CameraPath> path;
    if (!flags.camera_path.empty()) path = read_camera_path(flags.camera_path);
    ComingMachine machine(flags.machine, messages);
    std::optional<TracerChoice> tracers; // what does not fit the device is refused before the scene is read
    if (!flags.tracer.are_empty()) tracers = tracer_choice(flags.tracer, machine.is_cuda());
    reporter.say_messages();
    reporter.set_work(fmt::format("loading {}", flags.scene.scene));
    const Stopwatch watch;
    Scene scene = load_scene(flags.scene, messages);
    if (flags.strict) refuse_missing(messages);
    RenderSettings settings = render_settings(flags, scene);
    settings.tracers = tracers;
    const float aspect = static_cast<float>(settings.width) / static_cast<float>(settings.height);
    const MovingCamera camera(camera_choice(flags.scene), path, scene, aspect, messages);
    const double load_s = watch.seconds();
    PrepareOptions prepare;
    prepare.tracers = tracers.value_or(default_tracers(machine.is_cuda()));
    prepare.may_be_better = may_be_better(flags.tracer);
    if (!flags.no_cache) prepare.bvh_cache = bvh_cache_folder();
    reporter.set_work("building trees");
    MovingScene moving(std::move(scene), frames ? frames->time_of(frames->first) : flags.time_s, prepare, messages);
    say_what_moves(flags, moving, messages);
    const std::unique_ptr<Queue> queue = machine.take();
    reporter.say_messages();
    listen_for_interrupt();
    report_start(flags, moving.scene(), moving.prepared(), settings, *queue, load_s, reporter);
    PictureRecord record = {.scene = scene_source(flags.scene, moving.scene()),
                            .camera = {},
                            .settings = settings,
                            .device = queue->device_name(),
                            .display = {}};
    record.scene.load_seconds = load_s;
    record.scene.build_seconds = moving.prepared().build_seconds;
    FrameCamera frame_camera = {camera, frames.value_or(FrameSequence{.time_s = flags.time_s})};
    place_frame(frame_camera.sequence.first, moving.scene(), frame_camera, record);
    report_camera(record.camera, reporter);
    reporter.set_work("metering");
    std::optional<Session> session(std::in_place, *queue, moving.prepared(), record.camera.camera, settings);
    record.display = choose_display(flags, *session, reporter);
    if (frames) return render_frames(flags, frame_camera, moving, record, *session, reporter);
    return write_one(flags, settings, record, session, *queue, watch, reporter);
}

} // namespace

void add_render_command(CLI::App& app, int& status) {
    CLI::App& verb = *app.add_subcommand("render", "Render a picture of a scene");
    const auto flags = std::make_shared<RenderFlags>();
    add_render_flags(verb, *flags);
    verb.callback([flags, &status] { status = render(*flags); });
}

} // namespace pertev
