#include "apps/cli/render_frames.h"

#include <algorithm>
#include <exception>

#include <fmt/format.h>

#include "apps/cli/report_result.h"
#include "base/error.h"
#include "base/message_text.h"
#include "base/stopwatch.h"
#include "session/opening/strictness.h"
#include "session/pictures/write_sequence.h"

namespace pertev {
namespace {

std::string kept_text(const SequenceTally& tally) {
    if (tally.kept == 0) return "";
    if (tally.again == 0) return fmt::format(", {} kept", tally.kept);
    return fmt::format(", {} kept ({} of them rendered again for the history of others)", tally.kept, tally.again);
}

void report_frame(const FrameReport& made, Reporter& reporter) {
    report_files(made.written, reporter);
    if (!failures_of(made.written).empty()) return; // an error follows
    if (made.is_kept) {
        reporter.event(fmt::format(R"({{"event":"frame","frame":{},"kept":true{}}})", made.frame,
                                   made.hash.empty() ? "" : fmt::format(R"(,"hash":"{}")", made.hash)));
        return;
    }
    reporter.event(fmt::format(
        R"({{"event":"frame","frame":{},"time":{},{},"samples":{},"update_seconds":{:.6f},"render_seconds":{:.6f}}})",
        made.frame, made.time_s ? fmt::format("{}", *made.time_s) : "null", hashes_json(made.written), made.samples,
        made.update_s, made.render_s));
}

} // namespace

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
    reporter.print(fmt::format("{} of {} written{} in {:.2f} s, of which {:.1f} ms a frame to move the scene; {}{}",
                               tally.written, counted(tally.frames, "frame"), kept_text(tally), watch.seconds(),
                               1e3 * tally.update_s / std::max(tally.written, 1u),
                               counted(tally.invalid_samples, "invalid sample"),
                               cut_short ? "; interrupted: the same command with --continue resumes" : ""));
    reporter.result(fmt::format(
        R"({{"event":"sequence","frames":{},"written":{},"kept":{},"rendered_again":{},"seconds":{:.6f},"update_seconds":{:.6f},"invalid_samples":{},"interrupted":{}}})",
        tally.frames, tally.written, tally.kept, tally.again, watch.seconds(), tally.update_s, tally.invalid_samples,
        cut_short));
    if (failure) std::rethrow_exception(failure);
    if (flags.strict) refuse_invalid_samples(tally.invalid_samples);
    return cut_short ? exit_status(ErrorCode::Interrupted) : 0;
}

} // namespace pertev
