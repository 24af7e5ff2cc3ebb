#include "session/pictures/write_sequence.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/remove_leftovers.h"
#include "base/stopwatch.h"
#include "image/picture_hash.h"
#include "session/pictures/frame_settings.h"
#include "session/pictures/sequence_history.h"
#include "session/writing/deciding_settings.h"
#include "session/writing/sequence_record.h"

namespace pertev {
namespace {

/// Returns settings that are the same for all frames of a sequence, also if other frames were rendered before.
DecidingSettings settings_of(const PictureOptions& options, const FrameRange& sequence, const PictureRecord& record) {
    DecidingSettings settings = deciding_settings(options, record);
    std::erase_if(settings, [](const auto& setting) { return setting.first == "frames"; });
    settings.emplace(settings.begin(), "first frame", fmt::format("{}", sequence.first));
    return settings;
}

/// Finishes the frame in real time under way if the caller stops, because an unfinished one would take the history
/// along.
struct WholeFrame final : Sink {
    explicit WholeFrame(Sink& caller) : of_caller(caller) {}
    void receive(const Message& message) override { of_caller.receive(message); }
    const Messages& messages() const override { return of_caller.messages(); }
    void progress(const Progress& now) override { of_caller.progress(now); }
    bool should_stop() override { return false; }
    Sink& of_caller;
};

/// The frames and their record.
class SequenceWriter {
public:
    SequenceWriter(const SequenceOfFrames& frames, const PictureOptions& options,
                   const std::vector<std::string>& outputs, Sink& sink)
        : frames_(frames), options_(options), outputs_(outputs), sink_(sink), sequence_(frames.camera.sequence),
          own_(sequence_.of_part()),
          done_(outputs, settings_of(options, sequence_, frames.record), sequence_.names, sequence_.part) {
        if (options.goes_on) {
            remove_leftovers(done_.path());
            done_.load();
        }
        if (!has_history()) return;
        find_runs();
        if (!options.checkpoint.empty())
            history_.emplace(frames, options, settings_of(options, sequence_, frames.record));
    }

    void run(const std::function<void(const FrameReport&)>& report, SequenceTally& tally) {
        tally.frames = own_.second - own_.first;
        if (!runs_.empty()) begin_run(runs_.front());
        if (history_ && options_.goes_on && !runs_.empty()) {
            Run& run = runs_.front();
            run.first = history_->restore(run.first, first_missing(run), sink_);
        }
        std::ranges::for_each(runs_, [&](const Run& run) { report_history(run); });
        sink_.set_work("rendering");
        for (uint32_t frame = first(); frame < own_.second && !sink_.should_stop(); ++frame) {
            if (!make(frame, report, tally)) break;
        }
        if (history_) history_->finish();
    }

private:
    /// Frames [first, end) with a history that are rendered one after the other, since they are missing or the history
    /// of missing ones, which begins at a cut.
    struct Run {
        uint32_t cut, first, end;
    };

    /// Returns whether frames depend on those before them.
    bool has_history() const { return frames_.record.in_sequence.has_value(); }
    bool is_own(uint32_t frame) const { return frame >= own_.first; }
    bool is_there(uint32_t frame) const { return options_.goes_on && is_own(frame) && done_.has(frame); }
    /// Returns the first frame that is rendered, written or kept.
    uint32_t first() const { return runs_.empty() ? own_.first : std::min(own_.first, runs_.front().first); }

    /// Finds the runs from cut to cut; each ends with the last frame that is missing.
    void find_runs() {
        for (uint32_t end = own_.second; end > own_.first;) {
            const uint32_t cut = sequence_.cut_before(end - 1), least = std::max(cut, own_.first);
            while (end > least && is_there(end - 1)) --end;
            if (end > least) runs_.insert(runs_.begin(), Run{cut, cut, end});
            end = least;
        }
    }

    uint32_t first_missing(const Run& run) const {
        uint32_t frame = std::max(run.first, own_.first);
        while (is_there(frame)) ++frame;
        return frame;
    }

    bool is_in_run(uint32_t frame) const {
        return std::ranges::any_of(runs_, [&](const Run& run) { return frame >= run.first && frame < run.end; });
    }

    void begin_run(const Run& run) {
        frames_.session.cut();
        frames_.record.in_sequence->cut = run.cut;
    }

    void report_history(const Run& run) {
        const uint32_t end = first_missing(run);
        if (run.first == end) return;
        const char* const again = is_own(run.first) ? " again" : "";
        sink_.note(end - run.first == 1
                       ? fmt::format("renders frame {}{} for the history of those after it", run.first, again)
                       : fmt::format("renders frames {} to {}{} for the history of those after them", run.first,
                                     end - 1, again));
        sink_.report_messages();
    }

    /// Reports that `share` of the frame is finished.
    void report_progress(const FrameReport& made, double share) {
        const uint32_t number = made.frame - first(), count = own_.second - first();
        sink_.progress({.doing = fmt::format("frame {} ({} of {}){}", made.frame, number + 1, count,
                                             made.is_kept          ? " again"
                                             : !is_own(made.frame) ? " for the history"
                                                                   : ""),
                        .share = (number + share) / count,
                        .seconds = watch_.seconds(),
                        .share_of_step = share});
    }

    /// Renders and writes a frame. Returns false if it was cancelled: then the frame is not whole, and not written.
    bool make(uint32_t frame, const std::function<void(const FrameReport&)>& report, SequenceTally& tally) {
        FrameReport made;
        made.frame = frame;
        made.time_s = sequence_.time_of(frame);
        if (!sequence_.names.empty()) made.camera = sequence_.names[frame];
        made.is_kept = is_there(frame);
        const bool is_rendered = has_history() ? is_in_run(frame) : !made.is_kept;
        if (is_rendered) {
            if (has_history()) report_progress(made, 0);
            const auto begun = std::ranges::find(runs_, frame, &Run::cut);
            if (begun != runs_.end() && begun != runs_.begin()) begin_run(*begun);
            auto [result, update_s] = render(made);
            if (result.samples < frames_.record.settings.samples) return false;
            tally.has_begun = true;
            made.hash = picture_hash(result.picture).hex();
            if (has_history()) done_.check_picture(frame, made.hash);
            made.samples = result.samples;
            made.update_s = update_s;
            made.render_s = result.render_seconds;
            if (!made.is_kept && is_own(frame)) write(result, report, made, tally);
            if (history_) history_->add(frame, sink_);
        }
        tally.kept += made.is_kept;
        tally.again += made.is_kept && is_rendered;
        if (made.is_kept) report(made);
        return true;
    }

    RenderedFrame render(const FrameReport& made) {
        ProgressSink part(
            [&](const Progress& now) {
                report_progress(made, now.made_share >= 1 ? now.share : 0);
                return true;
            },
            history_ && frames_.record.frame ? whole_ : sink_);
        return render_frame(made.frame, frames_, part);
    }

    void write(RenderResult& result, const std::function<void(const FrameReport&)>& report, FrameReport& made,
               SequenceTally& tally) {
        SceneSource& source = frames_.record.scene;
        source.build_seconds = made.update_s;
        source.settings = settings_of_frame(options_, frames_.record, made.frame);
        std::vector<std::string> files;
        for (const std::string& output : outputs_) files.push_back(frame_file(output, made.frame, sequence_.names));
        if (options_.goes_on) std::ranges::for_each(files, remove_leftovers); // a killed process left them
        made.written = write_picture(files, frames_.record, result);
        const std::string failures = failures_of(made.written);
        if (failures.empty()) {
            ++tally.written;
            tally.update_s += made.update_s;
            tally.invalid_samples += result.invalid_samples;
        }
        report(made);
        refuse_faults(made.written, 0, false);
        done_.add(made.frame, made.hash);
    }

    const SequenceOfFrames& frames_;
    const PictureOptions& options_;
    const std::vector<std::string>& outputs_;
    Sink& sink_;
    const FrameRange& sequence_;
    const std::pair<uint32_t, uint32_t> own_; // the frames [first, end) of this part
    SequenceRecord done_;
    const Stopwatch watch_;
    std::vector<Run> runs_;                  // frames with a history, in order
    std::optional<SequenceHistory> history_; // with a checkpoint
    WholeFrame whole_{sink_};
};

} // namespace

void write_sequence(const SequenceOfFrames& frames, const PictureOptions& options,
                    const std::vector<std::string>& outputs, Sink& sink,
                    const std::function<void(const FrameReport&)>& report, SequenceTally& tally) {
    SequenceWriter(frames, options, outputs, sink).run(report, tally);
}

} // namespace pertev
