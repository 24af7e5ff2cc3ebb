#include "session/pictures/sequence_history.h"

#include <utility>

#include <fmt/format.h>

#include "base/error.h"

namespace pertev {

SequenceHistory::SequenceHistory(const SequenceOfFrames& frames, const PictureOptions& options,
                                 DecidingSettings settings)
    : frames_(frames), every_s_(options.checkpoint_every_s), file_(options.checkpoint, std::move(settings)) {}

uint32_t SequenceHistory::restore(uint32_t first, uint32_t end, Sink& sink) {
    std::optional<KeptFrame> kept = file_.read(sink);
    if (!kept || kept->frame < first || kept->frame >= end) return first;
    seek_frame(kept->frame, frames_.camera, frames_.moving, frames_.session, frames_.record, sink);
    kept->history.camera = frames_.session.camera();
    frames_.session.frames().restore(std::move(kept->history), frames_.session.settings(), sink);
    kept_ = kept->frame;
    sink.note(fmt::format("resumes after frame {} in {}", kept->frame, file_.file()));
    return kept->frame + 1;
}

void SequenceHistory::add(uint32_t frame, Sink& sink) {
    last_ = frame;
    if (since_written_.seconds() < every_s_) return;
    try {
        write();
    } catch (const Error& error) {
        if (error.code() != ErrorCode::FileWrite) throw;
        sink.warn(error.remark().and_then("; the sequence continues without this checkpoint"));
    }
    since_written_ = {};
}

void SequenceHistory::finish() { write(); }

void SequenceHistory::write() {
    if (!last_ || last_ == kept_ || !frames_.session.frames().has_history()) return;
    file_.write(*last_, frames_.session.frames().history());
    kept_ = last_;
}

} // namespace pertev
