#pragma once

// Keeps the history of a sequence, in real time or of denoised frames, in its checkpoint
// (session/film_file/history_file.h), so that an interrupted one goes on without rendering its frames again.

#include <optional>

#include "base/stopwatch.h"
#include "session/film_file/history_file.h"
#include "session/pictures/render_sequence.h"

namespace pertev {

class SequenceHistory {
public:
    /// Makes an object for the checkpoint of the options; `settings` decide all frames, and `frames` outlives it.
    SequenceHistory(const SequenceOfFrames& frames, const PictureOptions& options, DecidingSettings settings);

    /// Goes on after the checkpoint's frame if that is in [first, end), and returns the next one; else `first`. Throws
    /// as HistoryFile::read.
    uint32_t restore(uint32_t first, uint32_t end, Sink& sink);
    /// Takes note that a frame was rendered, whose files are there. If the checkpoint is due, it is written; a failure
    /// is a warning.
    void add(uint32_t frame, Sink& sink);
    /// Writes the checkpoint of the last frame. Throws Error(FileWrite).
    void finish();

private:
    void write();

    const SequenceOfFrames& frames_;
    double every_s_;
    HistoryFile file_;
    Stopwatch since_written_;
    std::optional<uint32_t> last_, kept_; // the last frame, and that of the checkpoint
};

} // namespace pertev
