// pertev render SCENE -o OUT

#include <algorithm>
#include <optional>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/commands.h"
#include "apps/cli/flag_checks.h"
#include "apps/cli/interrupt.h"
#include "apps/cli/render_frames.h"
#include "apps/cli/report_radiosity.h"
#include "apps/cli/report_result.h"
#include "base/byte_units.h"
#include "base/error.h"
#include "base/message_text.h"
#include "base/stopwatch.h"
#include "session/opening/strictness.h"
#include "session/pictures/choose_display.h"
#include "session/pictures/prepare_render.h"
#include "session/survey/ground.h"
#include "session/writing/check_outputs.h"
#include "settings/value_names.h"

namespace pertev {
namespace {

void report_hidden_backs(double share, Messages& messages) {
    if (!(share > 0.01)) return;
    messages.note(fmt::format("the camera looks through the backs of surfaces at {:.0f} % of the picture, as they are "
                              "not double sided (`show_back_faces` shows them)",
                              100 * share));
}

/// Reports what will be rendered, and on which device.
void report_start(const RenderFlags& flags, const RenderSetup& ready, Reporter& reporter) {
    const Scene& scene = ready.scene();
    const PreparedScene& prepared = ready.prepared();
    const RenderSettings& settings = ready.settings;
    const std::string device = ready.queue->device_name();
    const bool has_more = has_ground(scene); // the file is counted, not what is made up
    const uint64_t triangles = prepared.triangles - (has_more ? scene.meshes.back().triangle_count() : 0);
    const uint64_t instances = scene.instances.size() - (has_more ? 1 : 0);
    reporter.print(fmt::format("{}: {}, {}, {}; loaded in {:.2f} s, trees in {:.2f} s; "
                               "rendering {}x{}, {} spp{} on {}, using {:.0f} MiB",
                               flags.scene.scene, counted(triangles, "triangle"), counted(instances, "instance"),
                               counted(prepared.lights.count(), "light"), ready.load_s, prepared.build_seconds,
                               settings.width, settings.height, settings.samples,
                               flags.real_time ? " per frame, reconstructed," : "", device, mebibytes(ready.bytes)));
    reporter.event(fmt::format(
        R"({{"event":"scene","scene":{},"triangles":{},"instances":{},"lights":{},"load_seconds":{:.6f},"build_seconds":{:.6f}}})",
        json_string(flags.scene.scene), triangles, instances, prepared.lights.count(), ready.load_s,
        prepared.build_seconds));
    reporter.event(
        fmt::format(R"({{"event":"picture","width":{},"height":{},"spp":{},"device":{},"predicted_bytes":{}}})",
                    settings.width, settings.height, settings.samples, json_string(device), ready.bytes));
}

/// Error for a picture that was interrupted before its first sample.
Error ended_before_samples(const RenderSettings& settings) {
    if (interrupted()) return {ErrorCode::Interrupted, "interrupted before there was anything to keep"};
    return {
        ErrorCode::Interrupted, "time_limit", fmt::format("{:g}", settings.time_limit_s),
        fmt::format("no sample was finished in this time, so nothing is written; `integrator={}` prepares more than "
                    "samples first",
                    integrator_name(settings))};
}

int write_one(const RenderFlags& flags, const RenderSettings& settings, PictureRecord& record,
              std::optional<Session>& session, const Queue& queue, const Stopwatch& watch, Reporter& reporter) {
    const uint32_t added = session->render(settings.samples, reporter);
    if (added == 0) {
        reporter.end_progress();
        throw ended_before_samples(settings);
    }
    RenderResult result = session->result();
    session.reset(); // writing takes memory too
    reporter.end_progress();
    const bool cut_short = interrupted() && result.samples < settings.samples;
    if (cut_short) reporter.print(fmt::format("interrupted after {} of {} spp", result.samples, settings.samples));
    report_hidden_backs(result.hidden_back_share, reporter.messages());
    reporter.report_messages();
    reporter.set_work("writing");
    const WrittenPicture written = write_picture(flags.outputs, record, result);
    report_files(written, reporter);
    report_result(result, written, queue, watch.seconds(), cut_short, reporter);
    if (const std::string failures = failures_of(written); !failures.empty())
        throw Error(ErrorCode::FileWrite, failures);
    if (flags.strict) refuse_invalid_samples(result.invalid_samples);
    return cut_short ? exit_status(ErrorCode::Interrupted) : 0;
}

int render(RenderFlags& flags) {
    Reporter reporter(flags.report);
    flags.settings.read(flags, reporter.messages());
    for (const std::string& output : flags.outputs) refuse_list(output);
    check_outputs(flags, flags.outputs, reporter.messages());
    const Stopwatch watch;
    const std::unique_ptr<RenderSetup> ready = prepare_render(flags, kRender, reporter, report_solving(reporter));
    report_motion(flags, *ready->moving, reporter.messages());
    const RenderSettings& settings = ready->settings;
    Queue& queue = *ready->queue;
    reporter.report_messages();
    listen_for_interrupt();
    report_start(flags, *ready, reporter);
    PictureRecord record = picture_record(flags, *ready, reporter.messages());
    report_camera(record.camera, reporter);
    reporter.set_work("handing the scene to the device");
    std::optional<Session> session(std::in_place, queue, ready->prepared(), record.camera.camera, settings);
    if (writes_tone_mapped(flags.outputs)) {
        record.display = choose_display(flags, *session, reporter);
        report_display(*record.display, is_metered(flags), reporter);
    }
    reporter.set_work("rendering");
    if (frame_range(flags)) {
        const FrameCamera camera = {*ready->camera, ready->sequence};
        return render_frames(flags, {camera, *ready->moving, record, *session}, reporter);
    }
    return write_one(flags, settings, record, session, queue, watch, reporter);
}

} // namespace

void add_render_command(CLI::App& app, int& status) {
    CLI::App& verb = *app.add_subcommand("render", "Render a picture of a scene");
    const auto flags = std::make_shared<RenderFlags>();
    add_scene_name(verb, flags->scene);
    verb.add_option("-o,--output", flags->outputs,
                    "A picture file to write: .exr .png .jpg .hdr. It may be given again.")
        ->type_name("FILE")
        ->allow_extra_args(false)
        ->check(file_name())
        ->required();
    flags->settings.add_file(verb);
    add_report_flags(verb, flags->report);
    flags->settings.add(verb, kRender, *flags);
    verb.callback([flags, &status] { status = render(*flags); });
}

} // namespace pertev
