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

/// Finishes the frame under way if the caller stops, because an unfinished one would take the history along.
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
          done_(outputs, settings_of(options, sequence_, frames.record), sequence_.names) {
        if (options.goes_on) {
            remove_leftovers(done_.path());
            done_.load();
        }
        if (!frames.record.frame) return;
        with_history_ = count_frames_to_render();
        if (!options.checkpoint.empty())
            history_.emplace(frames, options, settings_of(options, sequence_, frames.record));
    }

    void run(const std::function<void(const FrameReport&)>& report, SequenceTally& tally) {
        tally.frames = sequence_.count();
        if (frames_.record.frame) frames_.session.cut();
        if (history_ && options_.goes_on && with_history_ > 0) restored_ = history_->restore(count_whole(0), sink_);
        report_history();
        sink_.set_work("rendering");
        for (uint32_t number = 0; number < sequence_.count() && !sink_.should_stop(); ++number) {
            if (!make(sequence_.first + number, report, tally)) break;
        }
        if (history_) history_->finish();
    }

private:
    bool is_there(uint32_t frame) const { return options_.goes_on && done_.has(frame); }

    /// Number of frames in real time that must be rendered: all up to the last one that is missing.
    uint32_t count_frames_to_render() const {
        uint32_t count = sequence_.count();
        while (count > 0 && is_there(sequence_.first + count - 1)) --count;
        return count;
    }

    /// Number of frames from number `first` on that are there, before the first one that is missing.
    uint32_t count_whole(uint32_t first) const {
        uint32_t there = first;
        while (there < with_history_ && is_there(sequence_.first + there)) ++there;
        return there - first;
    }

    void report_history() {
        const uint32_t there = count_whole(restored_), first = sequence_.first + restored_;
        if (there == 0) return;
        sink_.note(there == 1 ? fmt::format("renders frame {} again for the history of those after it", first)
                              : fmt::format("renders frames {} to {} again for the history of those after "
                                            "them",
                                            first, first + there - 1));
        sink_.report_messages();
    }

    /// `share` of the frame is finished.
    void report_progress(const FrameReport& made, double share) {
        const uint32_t number = made.frame - sequence_.first;
        sink_.progress({.doing = fmt::format("frame {} ({} of {}){}", made.frame, number + 1, sequence_.count(),
                                             made.is_kept ? " again" : ""),
                        .share = (number + share) / sequence_.count(),
                        .seconds = watch_.seconds(),
                        .share_of_step = share});
    }

    /// Returns false if it was cancelled: then the frame is not whole, and not written.
    bool make(uint32_t frame, const std::function<void(const FrameReport&)>& report, SequenceTally& tally) {
        FrameReport made;
        made.frame = frame;
        made.time_s = sequence_.time_of(frame);
        if (!sequence_.names.empty()) made.camera = sequence_.names[frame];
        made.is_kept = is_there(frame);
        const uint32_t number = frame - sequence_.first;
        const bool is_rendered = !made.is_kept || (number >= restored_ && number < with_history_);
        if (is_rendered) {
            if (frames_.record.frame) report_progress(made, 0);
            auto [result, update_s] = render(made);
            if (result.samples < frames_.record.settings.samples) return false;
            tally.has_begun = true;
            made.hash = picture_hash(result.picture).hex();
            if (frames_.record.frame) done_.check_picture(frame, made.hash);
            made.samples = result.samples;
            made.update_s = update_s;
            made.render_s = result.render_seconds;
            if (!made.is_kept) write(result, report, made, tally);
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
            history_ ? whole_ : sink_);
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
        if (!failures.empty()) throw Error(ErrorCode::FileWrite, failures);
        done_.add(made.frame, made.hash);
    }

    const SequenceOfFrames& frames_;
    const PictureOptions& options_;
    const std::vector<std::string>& outputs_;
    Sink& sink_;
    const FrameRange& sequence_;
    SequenceRecord done_;
    const Stopwatch watch_;
    uint32_t with_history_ = 0; // in real time: the number of first frames that are all rendered, for the history
    uint32_t restored_ = 0;     // number of first frames that need not be, because the checkpoint has their history
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
