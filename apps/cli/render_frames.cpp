#include "apps/cli/render_frames.h"

#include <algorithm>
#include <exception>
#include <iterator>
#include <map>
#include <string_view>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/cli/interrupt.h"
#include "apps/cli/reconstruction_flags.h"
#include "apps/cli/report_result.h"
#include "base/error.h"
#include "base/message_text.h"
#include "base/read_file.h"
#include "base/stopwatch.h"
#include "image/picture_hash.h"
#include "session/writing/sequence_record.h"

namespace pertev {
namespace {

/// All that decides the pictures: what the first frame's metadata say, and how the others follow.
SequenceRecord::Settings settings_of(const RenderFlags& flags, const FrameRange& sequence,
                                     const PictureRecord& record) {
    SequenceRecord::Settings settings;
    const RenderSettings& picture = record.settings;
    for (const auto& [name, value] : settings_metadata(record)) {
        // They stand there only where they are; a run without them must be told apart from one with them.
        constexpr std::string_view kSometimes[] = {
            "pertev.denoise",     "pertev.ambient",        "pertev.shading",      "pertev.wireframe",
            "pertev.lpe",         "pertev.up_axis",        "pertev.unit",         "pertev.lamp",
            "pertev.quantity",    "pertev.false_color",    "pertev.shutter",      "pertev.frame",
            "pertev.first_frame", "pertev.reconstruction", "pertev.displacement", "pertev.animation",
            "pertev.file_scene",  "pertev.ground"};
        if (std::ranges::find(kSometimes, name) != std::end(kSometimes)) continue;
        settings.emplace_back(name, std::visit([](const auto& v) { return fmt::format("{}", v); }, value));
    }
    settings.insert(settings.end(), {{"first frame", fmt::format("{}", sequence.first)},
                                     {"hash of --camera-path", hash_of_file(flags.camera_path)},
                                     {"hash of the scene's file", hash_of_file(flags.scene.scene)},
                                     {"hash of --environment", hash_of_file(flags.scene.environment)},
                                     {"the real size", fmt::format("{}x{}", picture.width, picture.height)}});
    const std::optional<Shutter> open = shutter(flags);
    const std::map<std::string_view, std::string> resolved = {
        // however they were written, or not at all
        {"animation", record.scene.animation},
        {"file_scene", record.scene.file_scene},
        {"shutter", open ? fmt::format("{},{}", open->open_s, open->close_s) : ""}};
    for (const Setting& setting : all_settings()) { // frames may be others of the same sequence
        if (!setting.is_kept || (setting.verbs & kRender) == 0 || setting.name == std::string_view("frames")) continue;
        const auto known = resolved.find(setting.name);
        settings.emplace_back(flag_of(setting.name), known != resolved.end()
                                                         ? known->second
                                                         : fmt::format("{}", fmt::join(texts_of(flags, setting), " ")));
    }
    return settings;
}

/// Totals reported for a whole sequence.
struct Tally {
    bool has_begun = false;                    // a frame was rendered, written or not
    uint32_t written = 0, kept = 0, again = 0; // again: of those that were kept, rendered for the history of others
    uint64_t invalid_samples = 0;
    double update_s = 0;
};

std::string kept_text(const Tally& tally) {
    if (tally.kept == 0) return "";
    if (tally.again == 0) return fmt::format(", {} kept", tally.kept);
    return fmt::format(", {} kept ({} of them rendered again for the history of others)", tally.kept, tally.again);
}

/// Everything needed to render and write any frame.
struct SequenceRun : SequenceOfFrames {
    const RenderFlags& flags;
    Reporter& reporter;
};

void show_progress(const SequenceRun& run, uint32_t frame, double share, const std::string& detail) {
    const FrameRange& sequence = run.camera.sequence;
    const uint32_t number = frame - sequence.first;
    run.reporter.progress((number + share) / sequence.count(),
                          fmt::format("frame {} ({} of {}){}", frame, number + 1, sequence.count(), detail));
}

std::vector<std::string> files_of(const RenderFlags& flags, uint32_t frame) {
    std::vector<std::string> files;
    for (const std::string& output : flags.outputs) files.push_back(frame_file(output, frame));
    return files;
}

/// Frames from the first one on that must be rendered: all of those in real time up to the last one that is missing.
uint32_t count_frames_to_make(const FrameRange& sequence, const SequenceRecord& done, bool goes_on) {
    uint32_t count = sequence.count();
    while (goes_on && count > 0 && done.has(sequence.first + count - 1)) --count;
    return count;
}

void report_history(const SequenceRun& run, const SequenceRecord& done, uint32_t frames) {
    const uint32_t first = run.camera.sequence.first;
    uint32_t there = 0;
    while (there < frames && done.has(first + there)) ++there;
    if (there == 0) return;
    run.reporter.print(there == 1 ? fmt::format("renders frame {} again for the history of those after it", first)
                                  : fmt::format("renders frames {} to {} again for the history of those after them",
                                                first, first + there - 1));
}

/// Writes the frame's files. Throws Error(FileWrite) that names those that could not be written.
WrittenPicture write_frame(const SequenceRun& run, uint32_t frame, RenderResult& result) {
    WrittenPicture written = write_picture(files_of(run.flags, frame), run.record, result);
    const std::string failures = report_files(written, run.reporter);
    if (!failures.empty()) throw Error(ErrorCode::FileWrite, failures);
    return written;
}

/// Renders and writes those frames that are not there yet, in their order, and counts in `tally` as it goes on. Throws
/// Error where one cannot be made or written: those before it are whole.
void make_frames(const SequenceRun& run, SequenceRecord& done, Tally& tally) {
    const FrameRange& sequence = run.camera.sequence;
    const bool goes_on = run.flags.goes_on, in_real_time = run.record.frame.has_value();
    const uint32_t with_history = in_real_time ? count_frames_to_make(sequence, done, goes_on) : 0;
    if (in_real_time) run.session.cut();
    if (goes_on) report_history(run, done, with_history);
    run.reporter.set_work("rendering");
    for (uint32_t number = 0; number < sequence.count() && !interrupted(); ++number) {
        const uint32_t frame = sequence.first + number;
        const std::optional<double> time_s = sequence.time_of(frame);
        const bool is_there = goes_on && done.has(frame);
        if (is_there && number >= with_history) {
            ++tally.kept;
            run.reporter.event(fmt::format(R"({{"event":"frame","frame":{},"kept":true}})", frame));
            continue;
        }
        if (in_real_time) show_progress(run, frame, 0, is_there ? " again" : "");
        ProgressSink part(
            [&](const Progress& now) {
                show_progress(run, frame, now.made_share >= 1 ? now.share : 0,
                              now.made_share >= 1
                                  ? fmt::format("  {}/{} spp", now.samples_done, now.samples)
                                  : fmt::format("  {:.0f} % before the first sample", 100 * now.made_share));
                return true;
            },
            &run.reporter);
        auto [result, update_s] = render_frame(frame, run, part);
        if (result.samples < run.record.settings.samples) return; // interrupted: not whole, and not written
        tally.has_begun = true;
        const std::string hash = picture_hash(result.picture).hex();
        if (in_real_time) done.check_picture(frame, hash);
        if (is_there) {
            ++tally.kept, ++tally.again;
            run.reporter.event(fmt::format(R"({{"event":"frame","frame":{},"kept":true,"hash":"{}"}})", frame, hash));
            continue;
        }
        run.record.scene.build_seconds = update_s;
        const WrittenPicture written = write_frame(run, frame, result);
        ++tally.written;
        tally.update_s += update_s;
        tally.invalid_samples += result.invalid_samples;
        run.reporter.event(fmt::format(
            R"({{"event":"frame","frame":{},"time":{},{},"samples":{},"update_seconds":{:.6f},"render_seconds":{:.6f}}})",
            frame, time_s ? fmt::format("{}", *time_s) : "null", hashes_json(written), result.samples, update_s,
            result.render_seconds));
        done.add(frame, hash);
    }
}

} // namespace

ReconstructedFrame reconstructed_frame(const RenderFlags& flags, const FrameRange& sequence) {
    return {sequence.first, sequence.first, reconstruction_settings(flags.reconstruction),
            flags.reconstruction.sharing};
}

int render_frames(const RenderFlags& flags, const FrameCamera& camera, MovingScene& moving, PictureRecord& record,
                  Session& session, Reporter& reporter) {
    const Stopwatch watch;
    const FrameRange& sequence = camera.sequence;
    const SequenceRun run = {{camera, moving, record, session}, flags, reporter};
    SequenceRecord done(flags.outputs, settings_of(flags, sequence, record));
    if (flags.goes_on) done.load();
    Tally tally;
    std::exception_ptr failure; // ends the sequence, and is told once the frames before it have been
    try {
        make_frames(run, done, tally);
    } catch (...) {
        failure = std::current_exception();
    }
    if (failure && !tally.has_begun && tally.kept == 0) std::rethrow_exception(failure); // there is nothing to count
    reporter.end_progress();
    reporter.report_messages();
    const bool is_whole = tally.written + tally.kept == sequence.count(), cut_short = !failure && !is_whole;
    reporter.print(fmt::format("{} of {} written{} in {:.2f} s, of which {:.1f} ms a frame to move the scene; {}{}",
                               tally.written, counted(sequence.count(), "frame"), kept_text(tally), watch.seconds(),
                               1e3 * tally.update_s / std::max(tally.written, 1u),
                               counted(tally.invalid_samples, "invalid sample"),
                               cut_short ? "; interrupted: the same command with --continue resumes" : ""));
    reporter.result(fmt::format(
        R"({{"event":"sequence","frames":{},"written":{},"kept":{},"rendered_again":{},"seconds":{:.6f},"update_seconds":{:.6f},"invalid_samples":{},"interrupted":{}}})",
        sequence.count(), tally.written, tally.kept, tally.again, watch.seconds(), tally.update_s,
        tally.invalid_samples, cut_short));
    if (failure) std::rethrow_exception(failure);
    if (flags.strict && tally.invalid_samples > 0) throw not_finite(tally.invalid_samples);
    return cut_short ? exit_status(ErrorCode::Interrupted) : 0;
}

} // namespace pertev
