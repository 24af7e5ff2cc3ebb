// pertev view SCENE

#include <fcntl.h>
#include <spawn.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/cli/commands.h"
#include "apps/cli/flag_checks.h"
#include "apps/cli/interrupt.h"
#include "apps/cli/render_flags.h"
#include "apps/cli/report_radiosity.h"
#include "apps/cli/report_result.h"
#include "apps/viewer/access_token.h"
#include "apps/viewer/panel_phrases.h"
#include "apps/viewer/session_frames.h"
#include "apps/viewer/viewer.h"
#include "base/error.h"
#include "base/limits.h"
#include "formats/files/file_choices.h"
#include "formats/read_camera_path.h"
#include "image/write_jpeg.h"
#include "integrators/radiosity/radiosity_display_settings.h"
#include "scene/scene_origin.h"
#include "session/check_integrator.h"
#include "session/machine.h"
#include "session/pictures/choose_display.h"
#include "session/pictures/prepare_render.h"
#include "settings/value_names.h"

extern char** environ;

namespace pertev {
namespace {

constexpr double kFrameOnCpu = 0.12, kFrameOnGpu = 1.0 / 60; // seconds that a frame may take while the camera moves
constexpr double kTurntableFps = 24;                         // the default of --frames
constexpr auto kLongestEnd = std::chrono::milliseconds(800); // from Ctrl-C to the end

struct ViewFlags {
    RenderFlags render;
    std::string host = "127.0.0.1";
    uint32_t port = 8080;
    bool no_browser = false;
    std::string token_file, token;
    std::optional<uint32_t> moving_depth;
    std::string jpeg = "auto";
};

bool is_this_machine_alone(const std::string& host) {
    return host == "localhost" || host == "127.0.0.1" || host == "::1" || host == "[::1]";
}

void check_host(const std::string& host) {
    if (host == "0.0.0.0" || host == "::" || host == "[::]" || host == "*") {
        throw Error(ErrorCode::BadInput, "host", host,
                    "expected the one name or address that browsers will use; requests for another are refused");
    }
}

/// Opens the address in the browser of the desktop, if there is one.
void open_browser(const std::string& address) {
    if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr) return;
    const char* arguments[] = {"xdg-open", address.c_str(), nullptr};
    posix_spawn_file_actions_t files;
    ::posix_spawn_file_actions_init(&files);
    for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        ::posix_spawn_file_actions_addopen(&files, fd, "/dev/null", O_RDWR, 0);
    }
    pid_t child = 0; // where it cannot be started, the address that was printed does as well
    ::posix_spawnp(&child, arguments[0], &files, nullptr, const_cast<char**>(arguments), environ);
    ::posix_spawn_file_actions_destroy(&files);
}

void report_address(const ViewFlags& flags, const std::string& address, Reporter& reporter) {
    reporter.event(fmt::format(R"({{"event":"listening","address":{}}})", json_string(address)));
    if (!is_this_machine_alone(flags.host)) {
        reporter.warn(fmt::format(
            "--host {}: anyone who reaches this machine by that name can try to connect, the connection is not "
            "encrypted, and anyone with the address below can watch and steer; without --host, ssh -L is a safe way",
            flags.host));
        reporter.report_messages();
    }
    const bool is_whole = flags.token.empty();
    if (!reporter.json()) {
        reporter.answer(fmt::format("Open {}{}\nCtrl-C ends the viewer.", address, is_whole ? "" : " with the token"));
    }
    if (is_whole && !flags.no_browser) open_browser(address);
}

/// The text of a scene's camera for --camera; empty where there is none.
std::string camera_name(const SceneOptions& options, const Scene& scene) {
    if (!options.camera.camera.empty()) return options.camera.camera;
    return scene.cameras.empty() ? "" : "0";
}

/// Turns as --turntable N does at 24 frames a second. Its places are said by eye, target and up, so that flags can say
/// them too: but for rounding they are those of render's frames.
CameraSource turned_camera(const RenderSetup& ready, double time_s) {
    const double frames = std::fmod(time_s * kTurntableFps, ready.sequence.turntable);
    CameraSource source = camera_at(*ready.camera, ready.scene(), time_s, frames / ready.sequence.turntable);
    if (frames == 0) return source;
    const Pose pose = pose_of(source.camera, {}, {}, source.camera.focus_distance);
    source.camera.world_from_camera = look_at(pose.eye, pose.target, pose.up);
    source.target = in_file(ready.scene(), pose.target);
    source.up = pose.up;
    return source;
}

/// Says in the panel which animation plays and which scene is shown, where the file has several, and by which words the
/// others are chosen.
void report_choices(const Scene& scene, ViewerStart& start) {
    const auto report = [&](const char* label, const std::string& chosen, const std::vector<std::string>& all,
                            const char* flag) {
        if (chosen.empty()) return;
        start.about.emplace_back(label, fmt::format("{} of {} ({})", chosen, fmt::join(all, ", "), flag));
    };
    report("animation", clip_choice(scene.clips), list_clips(scene.clips), "--animation");
    report("scene of the file", file_scene_choice(scene), list_file_scenes(scene), "--file-scene");
}

/// Sets how time moves the camera, and when all motion ends.
void let_time_move(const ViewFlags& flags, const RenderSetup& ready, ViewerStart& start) {
    const MovingScene& moving = *ready.moving;
    const uint32_t turntable = flags.render.turntable;
    const bool is_still = moving.is_animated() && ready.settings.radiosity->solution != nullptr;
    start.is_animated = moving.is_animated() && !is_still;
    start.clock = {.end_s = is_still ? 0 : moving.end_s(), .time_s = moving.time_s(), .plays = !moving.time_s()};
    if (is_still) {
        start.still_s = moving.time_s();
        start.why_still = fmt::format("stands {}: radiosity is solved for one time",
                                      start.still_s ? fmt::format("at {:g} s", *start.still_s) : "as at rest");
    }
    if (!flags.render.camera_path.empty()) {
        start.camera.path = read_camera_path(flags.render.camera_path);
        start.clock.end_s = std::max(start.clock.end_s, start.camera.path.keys.back().time_s);
    }
    if (flags.render.scene.camera.focus) start.camera.focus_m = *flags.render.scene.camera.focus;
    if (turntable > 0) {
        start.clock.end_s = std::max(start.clock.end_s, turntable / kTurntableFps);
        start.camera.at = [&ready](double time_s) { return turned_camera(ready, time_s); };
    } else if (flags.render.camera_path.empty()) {
        start.camera.at = [&ready](double time_s) { return camera_at(*ready.camera, ready.scene(), time_s, 0); };
    }
    start.camera.moves = start.is_animated || turntable > 0;
    const SceneOptions& scene = flags.render.scene;
    const bool is_made_up = ready.scene().cameras.empty() && !scene.camera.eye && flags.render.camera_path.empty();
    if (is_made_up && turntable == 0 && !moving.is_animated()) {
        start.camera.framed = [&ready, choice = scene.camera](float aspect) {
            const MovingCamera framed(choice, std::nullopt, ready.scene(), aspect, nobody()); // already reported
            return camera_at(framed, ready.scene(), std::nullopt, 0);
        };
    }
}

/// Returns the first pose. The view turns about the point in the middle of the picture, unless a target was given.
Pose start_pose(const PictureRecord& record, const Scene& scene, FrameSource& source, float scene_size) {
    const Camera& camera = record.camera.camera;
    float distance = 0.5f * scene_size;
    if (!record.camera.target) {
        if (const auto point = source.pick(camera, 0.5f, 0.5f)) distance = max(point->distance, 1e-3f * scene_size);
    }
    return pose_of(record.camera, scene, distance);
}

/// Queue of the GPU that renders; null if the CPU encodes pictures.
std::unique_ptr<Queue> queue_for_jpeg(const ViewFlags& flags) {
    if (flags.jpeg == "cpu") return nullptr;
    try {
        std::unique_ptr<Queue> queue = take_machine(flags.render.machine, nobody());
        return queue->is_cuda() ? std::move(queue) : nullptr;
    } catch (const Error&) { // it has no room for two
        return nullptr;
    }
}

/// Integrators that would show the scene as black, and why.
std::vector<std::pair<IntegratorKind, std::string>> dark_integrators(RenderSettings settings, const Scene& scene) {
    std::vector<std::pair<IntegratorKind, std::string>> dark;
    for (const std::string& name : integrator_names()) {
        set_integrator(settings, name);
        const std::optional<Remark> is_dark = why_dark(settings, scene);
        std::string why = is_dark ? panel_phrase(*is_dark) : "";
        if (why.empty() && is_solved(settings.integrator) && !settings.radiosity->solution) {
            why = "radiosity is solved before anything is shown: start pertev view --integrator radiosity";
        }
        if (!why.empty()) dark.emplace_back(settings.integrator, std::move(why));
    }
    return dark;
}

/// After a request to end, the program ends in any case: nothing would be lost.
void end_soon() {
    std::thread([] {
        while (!interrupted()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
        std::this_thread::sleep_for(kLongestEnd);
        std::_Exit(0);
    }).detach();
}

int view(ViewFlags& flags) {
    Reporter reporter(flags.render.report);
    flags.render.settings.read(flags.render, reporter);
    check_host(flags.host);
    flags.token = given_token(flags.token_file);
    const std::unique_ptr<RenderSetup> ready = prepare_render(flags.render, kView, reporter, report_solving(reporter));
    const UseThreads threads(ready->queue->threads());
    if (!makes_frames(ready->settings.integrator) && flags.render.reconstruction.has_frame_options()) {
        reporter.note({"integrator", std::string(integrator_name(ready->settings)),
                       "its frames are not reconstructed; `restir` and `resolution_scale` apply once the "
                       "panel's integrator is path or hybrid"});
    }
    if (flags.render.time_s) report_motion(flags.render, *ready->moving, reporter);
    const uint32_t width = ready->settings.width, height = ready->settings.height;
    check_jpeg_size({"size", fmt::format("{}x{}", width, height), ""}, width, height); // that is how pictures are sent
    reporter.report_messages();
    listen_for_interrupt();
    reporter.set_work("uploading the scene");
    PictureRecord record = picture_record(flags.render, *ready, reporter.messages());
    const Camera& camera = record.camera.camera;
    Session session(*ready->queue, ready->prepared(), camera, ready->settings);
    const bool on_cuda = ready->queue->is_cuda();
    SessionFrames source(session, *ready->moving, on_cuda ? kFrameOnGpu : kFrameOnCpu);
    ViewerStart start;
    start.scene = &ready->scene();
    start.camera.camera = camera;
    start.record = record;
    start.options = flags.render;
    start.view.options = flags.render;
    start.view.options.render = ready->settings;
    if (!flags.render.size) {
        start.view.window_pixels = uint64_t(ready->settings.width) * ready->settings.height;
    }
    start.view.display = choose_display(flags.render, session, reporter);
    start.view.finds_exposure = is_metered(flags.render);
    report_display(start.view.display, start.view.finds_exposure, reporter);
    start.view.dark = dark_integrators(ready->settings, ready->scene());
    start.view.lens = camera;
    start.view.on_cuda = on_cuda;
    start.view.moving_depth =
        flags.moving_depth.value_or(flags.render.is_given("max_depth") ? ready->settings.path.max_depth : kMovingDepth);
    if (start.view.finds_exposure) {
        source.begin_exposed({.camera = camera, .view = start.view}, start.view.display.exposure_stops);
        start.view.display.exposure_stops = 0;
    }
    start.camera.name = camera_name(flags.render.scene, ready->scene());
    const float size = length(bounds_of(ready->scene()).size());
    start.speed = 0.12f * size;
    start.camera.pose = start_pose(start.record, ready->scene(), source, size);
    report_choices(ready->scene(), start);
    let_time_move(flags, *ready, start);
    if (!start.why_still.empty()) {
        reporter.note(
            {FileLocation{flags.render.scene.scene},
             fmt::format("the scene {}; `time` shows it at another, `integrator=path` moving", start.why_still)});
        reporter.report_messages();
    }
    const std::unique_ptr<Queue> jpeg_queue = on_cuda ? queue_for_jpeg(flags) : nullptr;
    reporter.set_work(""); // from now on nothing is said that was said before
    end_soon();
    run_viewer(
        {.host = flags.host,
         .port = static_cast<uint16_t>(flags.port),
         .token = flags.token,
         .jpeg_queue = jpeg_queue.get()},
        start, source, [&](const std::string& address) { report_address(flags, address, reporter); },
        [] { return !interrupted(); });
    reporter.result(R"({"event":"done"})");
    return 0;
}

} // namespace

void add_view_command(CLI::App& app, int& status) {
    CLI::App& verb = *app.add_subcommand("view", "Show a scene in a browser, through one port");
    const auto flags = std::make_shared<ViewFlags>();
    add_scene_name(verb, flags->render.scene);
    const char* group = "Server";
    add_whole(verb, "--port", flags->port, "port to listen on; 0 is any free one", 0, 65535)
        ->capture_default_str()
        ->group(group);
    verb.add_option("--host", flags->host, "host name or address to listen on, as browsers will use it")
        ->type_name("NAME")
        ->check(file_name())
        ->capture_default_str()
        ->group(group);
    verb.add_option("--jpeg", flags->jpeg, "JPEG encoder: auto (the GPU that renders if nvJPEG is\nfound), cpu")
        ->type_name("NAME")
        ->check(one_of({"auto", "cpu"}))
        ->capture_default_str()
        ->group(group);
    verb.add_option("--token-file", flags->token_file,
                    "file with the address's token, for services; PERTEV_TOKEN\nholds one too (otherwise a new one)")
        ->type_name("FILE")
        ->group(group);
    verb.add_flag("--no-browser", flags->no_browser, "do not open a browser")->group(group);
    add_whole(verb, "--moving-depth", flags->moving_depth,
              fmt::format("maximum path depth in motion ({}, or --max-depth if given)", kMovingDepth), 0,
              kMaxPathDepth - 1)
        ->group("Frames");
    flags->render.settings.add_file(verb);
    add_report_flags(verb, flags->render.report);
    flags->render.settings.add(verb, kView, flags->render);
    verb.callback([flags, &status] { status = view(*flags); });
}

} // namespace pertev
