#pragma once

// The checkpoint of a sequence in real time: what its last frame leaves for the next one, in a file of packed blocks
// (block_file.h), and the generation before it beside it. Frames themselves are in their own files.

#include <optional>
#include <string>

#include "base/sink.h"
#include "session/frame_history.h"
#include "session/writing/deciding_settings.h"

namespace pertev {

/// A frame of a sequence, and what it leaves; the camera is that of the frame, and not in the file.
struct KeptFrame {
    uint32_t frame = 0;
    FrameHistory history;
};

class HistoryFile {
public:
    /// Makes an object without reading anything. `settings` decide all frames.
    HistoryFile(std::string file, DecidingSettings settings);

    /// Returns what the file has, if it is there. Removes what killed processes left beside it. If the file is damaged,
    /// it warns and returns what the generation before has; nothing if that is not whole. Throws Error(BadInput) if the
    /// file is of another sequence, naming the first difference.
    std::optional<KeptFrame> read(Sink& sink);
    /// Replaces the file; the file so far becomes the generation before. Throws Error(FileWrite); then the file is the
    /// one before.
    void write(uint32_t frame, const FrameHistory& history);

    const std::string& file() const { return file_; }

private:
    KeptFrame read_generation(const std::string& file) const;

    std::string file_, previous_;
    DecidingSettings settings_;
    bool is_damaged_ = false; // the file, which thus is no generation to keep
};

} // namespace pertev
