// pertev view SCENE

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <unistd.h>

#include <cstdlib>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/commands.h"
#include "apps/cli/flag_checks.h"
#include "apps/cli/interrupt.h"
#include "apps/cli/render_flags.h"
#include "apps/cli/report_radiosity.h"
#include "apps/cli/report_result.h"
#include "apps/viewer/access_token.h"
#include "apps/viewer/start_viewer.h"
#include "apps/viewer/viewer.h"
#include "base/error.h"
#include "image/write_jpeg.h"
#include "session/devices/session_on_devices.h"
#include "session/pictures/choose_display.h"
#include "session/pictures/prepare_render.h"
#include "settings/value_names.h"

extern char** environ;

namespace pertev {
namespace {

constexpr double kFrameOnCpu = 0.12, kFrameOnGpu = 1.0 / 60; // seconds that a frame may take while the camera moves
constexpr auto kLongestEnd = std::chrono::milliseconds(800); // from Ctrl-C to the end

struct ViewFlags {
    RenderFlags render;
    std::string host = "127.0.0.1";
    uint32_t port = 8080;
    bool no_browser = false, embed = false;
    std::string token_file, token;
    std::string jpeg = "auto";
};

bool is_this_machine_alone(const std::string& host) {
    return host == "localhost" || host == "127.0.0.1" || host == "::1" || host == "[::1]";
}

void check_host(const std::string& host) {
    if (host == "0.0.0.0" || host == "::" || host == "[::]" || host == "*") {
        throw Error(ErrorCode::BadInput, "host", host,
                    "expected the name or address that browsers will use; requests for any other are refused");
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
            "--host {}: everyone who reaches this machine by that name can try to connect, the connection is not "
            "encrypted, and everyone with the address below can watch and steer; the safe way is ssh -L without "
            "--host",
            flags.host));
        reporter.report_messages();
    }
    const bool is_whole = flags.token.empty();
    if (!reporter.json()) {
        reporter.answer(fmt::format("Open {}{}\nCtrl-C ends the viewer.", address, is_whole ? "" : " with the token"));
    }
    if (is_whole && !flags.no_browser) open_browser(address);
}

/// Queue of the GPU that renders; null if the CPU encodes pictures.
std::unique_ptr<Queue> queue_for_jpeg(const ViewFlags& flags, const Queue& renders) {
    if (flags.jpeg == "cpu" || !renders.is_cuda()) return nullptr;
    try {
        return std::make_unique<Queue>(Queue::make_cuda(renders.device_index(), renders.threads()));
    } catch (const Error&) { // the device has no memory for a second queue
        return nullptr;
    }
}

/// Returns whether the standard output is a pipe whose reader has gone.
bool has_lost_reader() {
    pollfd output = {.fd = STDOUT_FILENO, .events = 0, .revents = 0};
    return ::poll(&output, 1, 0) > 0 && (output.revents & POLLERR) != 0;
}

/// After a request to end, the program ends in any case: nothing would be lost. If a program shows the viewer, it also
/// ends when that program has ended, even if it was killed.
void end_soon(bool has_reader) {
    std::thread([has_reader] {
        while (!interrupted()) {
            if (has_reader && has_lost_reader()) std::_Exit(0);
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
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
                       "this integrator's frames are not reconstructed; `restir` and `resolution_scale` apply once "
                       "the panel's integrator is path or hybrid"});
    }
    if (flags.render.time_s) report_motion(flags.render, *ready->moving, reporter);
    const uint32_t width = ready->settings.width, height = ready->settings.height;
    check_jpeg_size({"size", fmt::format("{}x{}", width, height), ""}, width, height); // that is how pictures are sent
    reporter.report_messages();
    listen_for_interrupt();
    reporter.set_work("uploading the scene");
    const PictureRecord record = picture_record(flags.render, *ready, reporter.messages());
    const SharedWork shared = {.pictures = true, .frames = true, .after_loss = AfterLoss::Cut};
    SessionOnDevices opened(ready->queues, ready->prepared(), record.camera.camera, ready->settings, shared);
    Session& session = opened.session();
    const bool on_cuda = ready->queue->is_cuda();
    SessionFrames source(session, *ready->moving, on_cuda ? kFrameOnGpu : kFrameOnCpu);
    const Display display = choose_display(flags.render, session, reporter);
    report_display(display, is_metered(flags.render), reporter);
    const ViewerStart start = start_viewer(flags.render, *ready, record, display, source);
    if (!start.why_still.empty()) {
        reporter.note({FileLocation{flags.render.scene.scene},
                       fmt::format("the scene {}; `time` shows it at another time, `integrator=path` in motion",
                                   start.why_still)});
        reporter.report_messages();
    }
    const std::unique_ptr<Queue> jpeg_queue = queue_for_jpeg(flags, *ready->queue);
    reporter.set_work(""); // messages printed so far are not repeated
    end_soon(flags.embed && reporter.json());
    run_viewer(
        {.host = flags.host,
         .port = static_cast<uint16_t>(flags.port),
         .token = flags.token,
         .embed = flags.embed,
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
    verb.add_flag("--no-browser", flags->no_browser, "opens no browser")->group(group);
    verb.add_flag("--embed", flags->embed, "lets other pages, such as notebooks, show the viewer in a frame")
        ->group(group);
    flags->render.settings.add_file(verb);
    add_report_flags(verb, flags->render.report);
    flags->render.settings.add(verb, kView, flags->render);
    verb.callback([flags, &status] { status = view(*flags); });
}

} // namespace pertev
