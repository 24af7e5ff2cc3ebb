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
    Session& session = frames_.session;
    if (frames_.record.frame) {
        session.frames().restore(std::move(kept->history), session.settings(), sink);
    } else {
        session.film_render().restore(kept->history);
    }
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
    Session& session = frames_.session;
    const bool in_real_time = frames_.record.frame.has_value();
    const bool has_history = in_real_time ? session.frames().has_history() : session.film_render().has_history();
    if (!last_ || last_ == kept_ || !has_history) return;
    file_.write(*last_, in_real_time ? session.frames().history() : session.film_render().history());
    kept_ = last_;
}

} // namespace pertev
