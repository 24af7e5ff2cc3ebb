// pertev render SCENE -o OUT

#include <algorithm>
#include <exception>
#include <initializer_list>
#include <optional>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/commands.h"
#include "apps/cli/flag_checks.h"
#include "apps/cli/interrupt.h"
#include "apps/cli/render_flags.h"
#include "apps/cli/report_radiosity.h"
#include "apps/cli/report_result.h"
#include "base/error.h"
#include "base/machine_memory.h"
#include "base/message_text.h"
#include "base/stopwatch.h"
#include "device_scene/pack_texels.h"
#include "session/devices/session_on_devices.h"
#include "session/film_file/film_file.h"
#include "session/mpi/ranks.h"
#include "session/opening/camera_list.h"
#include "session/opening/strictness.h"
#include "session/pictures/choose_display.h"
#include "session/pictures/prepare_render.h"
#include "session/pictures/render_samples.h"
#include "session/pictures/render_with_checkpoint.h"
#include "session/pictures/share_records.h"
#include "session/pictures/write_sequence.h"
#include "session/sample_range.h"
#include "session/survey/ground.h"
#include "session/writing/check_outputs.h"

namespace pertev {
namespace {

/// Reports what will be rendered, and on which device.
void report_start(const RenderFlags& flags, const RenderSetup& ready, Reporter& reporter) {
    const Scene& scene = ready.scene();
    const PreparedScene& prepared = ready.prepared();
    const RenderSettings& settings = ready.settings;
    const PixelWindow window = settings.window();
    const std::string device = ready.device_name();
    const bool has_more = has_ground(scene); // counts the file's contents, without defaults
    const uint64_t triangles = prepared.triangles - (has_more ? scene.meshes.back().triangle_count() : 0);
    const uint64_t instances = scene.instances.size() - (has_more ? 1 : 0);
    const uint64_t textures = texture_bytes(scene);
    reporter.print(fmt::format(
        "{}: {}, {}, {}; loaded in {:.2f} s, trees in {:.2f} s; "
        "rendering {}x{}{}, {} spp{} on {}, using {:.0f} MiB{}",
        flags.scene.scene, counted(triangles, "triangle"), counted(instances, "instance"),
        counted(prepared.lights.count(), "light"), ready.load_s, prepared.build_seconds, window.width, window.height,
        settings.crop ? fmt::format(" at {},{} of {}x{}", window.x, window.y, settings.width, settings.height) : "",
        settings.range().count(), flags.real_time ? " per frame, reconstructed," : "", device, mebibytes(ready.bytes),
        textures > 0 ? fmt::format(" with {:.1f} MiB of textures", mebibytes(textures)) : ""));
    reporter.event(fmt::format(
        R"({{"event":"scene","scene":{},"triangles":{},"instances":{},"lights":{},"texture_bytes":{},"load_seconds":{:.6f},"build_seconds":{:.6f}}})",
        json_string(flags.scene.scene), triangles, instances, prepared.lights.count(), textures, ready.load_s,
        prepared.build_seconds));
    reporter.event(fmt::format(
        R"({{"event":"picture","width":{},"height":{},"crop":{},"spp":{},"device":{},"predicted_bytes":{}}})",
        settings.width, settings.height,
        settings.crop ? fmt::format("[{},{},{},{}]", window.x, window.y, window.width, window.height) : "null",
        settings.range().count(), json_string(device), ready.bytes));
}

/// Names the part that is rendered, as "part 2/3"; empty for a whole picture.
std::string part_text(const PictureOptions& options) {
    std::string text;
    for (const auto& [name, value] :
         {std::pair("part", &options.part), {"samples", &options.samples}, {"rows", &options.rows}}) {
        if (!value->empty()) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, *value);
    }
    return text;
}

std::string kept_text(const SequenceTally& tally) {
    if (tally.kept == 0) return "";
    if (tally.again == 0) return fmt::format(", {} kept", tally.kept);
    return fmt::format(", {} kept ({} of them rendered again as history of later frames)", tally.kept, tally.again);
}

void report_frame(const FrameReport& made, Reporter& reporter) {
    report_files(made.written, reporter);
    if (!failures_of(made.written).empty()) return; // an error follows
    const std::string camera = made.camera.empty() ? "" : fmt::format(R"(,"camera":{})", json_string(made.camera));
    if (made.is_kept) {
        reporter.event(fmt::format(R"({{"event":"frame","frame":{}{},"kept":true{}}})", made.frame, camera,
                                   made.hash.empty() ? "" : fmt::format(R"(,"hash":"{}")", made.hash)));
        return;
    }
    reporter.event(fmt::format(
        R"({{"event":"frame","frame":{}{},"time":{},{},"samples":{},"update_seconds":{:.6f},"render_seconds":{:.6f}}})",
        made.frame, camera, made.time_s ? fmt::format("{}", *made.time_s) : "null", hashes_json(made.written),
        made.samples, made.update_s, made.render_s));
}

/// Renders and writes the frames by write_sequence and reports them. Ctrl-C ends after the last whole frame. Returns
/// the exit status. Throws Error.
int render_frames(const RenderFlags& flags, const SequenceOfFrames& frames, Reporter& reporter) {
    const Stopwatch watch;
    SequenceTally tally;
    std::exception_ptr failure; // ends the sequence, and is reported after the frames before it
    try {
        write_sequence(
            frames, flags, flags.outputs, reporter, [&](const FrameReport& made) { report_frame(made, reporter); },
            tally);
    } catch (...) {
        failure = std::current_exception();
    }
    if (failure && !tally.has_begun && tally.kept == 0) std::rethrow_exception(failure); // there is nothing to count
    reporter.end_progress();
    reporter.report_messages();
    const bool cut_short = !failure && !tally.is_complete();
    reporter.print(fmt::format("{} of {} written{} in {:.2f} s, including {:.1f} ms per frame to move the scene; {}{}",
                               tally.written, counted(tally.frames, "frame"), kept_text(tally), watch.seconds(),
                               1e3 * tally.update_s / std::max(tally.written, 1u),
                               counted(tally.invalid_samples, "invalid sample"),
                               cut_short ? "; interrupted: add --continue to resume" : ""));
    reporter.result(fmt::format(
        R"({{"event":"sequence","frames":{},"written":{},"kept":{},"rendered_again":{},"seconds":{:.6f},"update_seconds":{:.6f},"invalid_samples":{},"interrupted":{}}})",
        tally.frames, tally.written, tally.kept, tally.again, watch.seconds(), tally.update_s, tally.invalid_samples,
        cut_short));
    if (failure) std::rethrow_exception(failure);
    if (flags.strict) refuse_invalid_samples(tally.invalid_samples);
    return cut_short ? exit_status(ErrorCode::Interrupted) : 0;
}

int write_one(const RenderFlags& flags, const RenderSettings& settings, const PictureRecord& record,
              std::optional<SessionOnDevices>& opened, const Queue& queue, const Stopwatch& watch, const Ranks* ranks,
              Reporter& reporter) {
    Session& session = opened->session();
    std::optional<RenderWithCheckpoint> kept;
    if (!flags.checkpoint.empty()) kept.emplace(session, flags, record, reporter);
    reporter.report_messages();
    RenderResult result = kept ? kept->render(reporter) : render_samples(session, reporter);
    reporter.end_progress();
    const uint32_t samples = settings.range().count();
    const bool cut_short = interrupted() && result.samples < samples;
    if (cut_short) reporter.print(fmt::format("interrupted after {} of {} spp", result.samples, samples));
    reporter.report_messages();
    if (ranks != nullptr) {
        if (!ranks->all(!cut_short)) return exit_status(ErrorCode::Interrupted); // each keeps its part
        reporter.set_work("summing the films of all ranks");
        ranks->sum(flags.render.samples, kept->film_render(), result);
        if (ranks->rank() > 0) {
            if (ranks->all(true)) Generations(flags.checkpoint).remove(); // the whole picture is written
            return 0;
        }
    }
    reporter.set_work("writing");
    PictureFacts facts = facts_of(record, result.ids);
    std::vector<WrittenFile> films;
    if (writes_films(flags.outputs)) {
        const Film& film = kept ? kept->film() : session.film();
        films = write_film_files(flags.outputs, film_header(flags, record, facts, result, film), film);
    }
    if (kept && ranks == nullptr) films.push_back(kept->written());
    kept.reset(), opened.reset();                                // writing takes memory too
    if (!writes_tone_mapped(flags.outputs)) facts.shown.clear(); // only film files have them
    WrittenPicture written = write_picture(flags.outputs, facts, result);
    written.files.insert(written.files.end(), films.begin(), films.end());
    report_files(written, reporter);
    if (ranks != nullptr && ranks->all(failures_of(written).empty())) Generations(flags.checkpoint).remove();
    report_result(result, settings.rendered_pixels(), written, queue, record.device, watch.seconds(), cut_short,
                  reporter);
    refuse_faults(written, result.invalid_samples, flags.strict);
    return cut_short ? exit_status(ErrorCode::Interrupted) : 0;
}

/// Lets this process render its part, if it is one of several of mpirun's. Only the first one writes files.
std::unique_ptr<Ranks> join_ranks(RenderFlags& flags) {
    const bool is_part = std::ranges::any_of(std::initializer_list<const char*>{"part", "samples", "rows"},
                                             [&](const char* name) { return flags.is_given(name); });
    std::unique_ptr<Ranks> ranks = is_part ? nullptr : Ranks::join();
    if (!ranks) return ranks;
    ranks->divide(flags.outputs.front(), flags);
    if (ranks->rank() > 0 && !has_frames(flags)) flags.outputs.clear();
    return ranks;
}

int render(RenderFlags& flags) {
    Reporter reporter(flags.report);
    flags.settings.read(flags, reporter);
    name_standard_output(flags.output_format, flags.report.json, flags.outputs);
    const std::unique_ptr<Ranks> ranks = join_ranks(flags);
    if (ranks && ranks->rank() > 0) reporter.silence_events();
    for (const std::string& output : flags.outputs) refuse_list(output);
    reporter.set_part(part_text(flags));
    read_camera_list(flags);
    check_outputs(flags, flags.outputs, reporter);
    const Stopwatch watch;
    const std::unique_ptr<RenderSetup> ready = prepare_render(flags, kRender, reporter, report_solving(reporter));
    report_motion(flags, *ready->moving, reporter);
    const RenderSettings& settings = ready->settings;
    Queue& queue = *ready->queue;
    const UseThreads threads(queue.threads());
    reporter.report_messages();
    listen_for_interrupt();
    report_start(flags, *ready, reporter);
    PictureRecord record = picture_record(flags, *ready, reporter);
    report_camera(record.camera, reporter);
    share_records(flags, *ready, record, reporter);
    reporter.set_work("uploading the scene");
    const SharedWork shared = {.pictures = !flags.real_time, .frames = flags.real_time};
    std::optional<SessionOnDevices> opened(std::in_place, ready->queues, ready->prepared(), record.camera.camera,
                                           settings, shared);
    Session& session = opened->session();
    const bool keeps_film = !flags.checkpoint.empty() && !flags.real_time && !flags.keeps_history();
    if (writes_tone_mapped(flags.outputs) || keeps_film || writes_films(flags.outputs)) {
        record.display = choose_display(flags, session, reporter);
        report_display(*record.display, is_metered(flags), reporter);
    }
    reporter.set_work("rendering");
    if (frame_range(flags)) {
        const FrameCamera camera = {*ready->camera, ready->sequence, ready->list};
        return render_frames(flags, {camera, *ready->moving, record, session}, reporter);
    }
    return write_one(flags, settings, record, opened, queue, watch, ranks.get(), reporter);
}

} // namespace

void add_render_command(CLI::App& app, int& status) {
    CLI::App& verb = *app.add_subcommand("render", "Render a picture of a scene");
    const auto flags = std::make_shared<RenderFlags>();
    add_scene_name(verb, flags->scene);
    verb.add_option("-o,--output", flags->outputs,
                    "A picture file to write: .exr .png .jpg .hdr, or .pvf for pertev merge. It may be given again.")
        ->type_name("FILE")
        ->allow_extra_args(false)
        ->check(file_name())
        ->required();
    flags->settings.add_file(verb);
    add_report_flags(verb, flags->report);
    add_progress_flag(verb, flags->report);
    flags->settings.add(verb, kRender, *flags);
    verb.callback([flags, &status] { status = render(*flags); });
}

} // namespace pertev
