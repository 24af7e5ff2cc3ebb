#pragma once

// The checkpoint of a sequence in real time: what its last frame leaves for the next one, in a file of packed blocks
// (block_file.h), and the generation before it. Frames themselves are in their own files.

#include <optional>
#include <string>
#include <vector>

#include "base/sink.h"
#include "session/film_file/block_file.h"
#include "session/film_file/generations.h"
#include "session/frame_history.h"
#include "session/writing/deciding_settings.h"

namespace pertev {

inline constexpr BlockFileKind kHistoryFile = {"\x89PVH\r\n\x1a\n", 1, "history"};

/// A frame of a sequence and its history. The camera is the frame's, which the file does not hold.
struct KeptFrame {
    uint32_t frame = 0;
    FrameHistory history;
};

class HistoryFile {
public:
    /// Makes an object without reading anything. `settings` decide all frames.
    HistoryFile(std::string file, DecidingSettings settings);

    /// Returns what the file has, if it is there. If the file is damaged, it warns and returns what the generation
    /// before has; nothing if that is not whole. Throws Error(BadInput) if the file is of another sequence, naming the
    /// first difference.
    std::optional<KeptFrame> read(Sink& sink);
    /// Replaces the file; the file so far becomes the generation before. Throws Error(FileWrite) and leaves the old
    /// file unchanged.
    void write(uint32_t frame, const FrameHistory& history);

    const std::string& file() const { return generations_.file(); }

private:
    KeptFrame read_generation(const std::string& file) const;

    Generations generations_;
    DecidingSettings settings_;
};

/// Returns the bytes of a file.
std::vector<std::byte> history_file_bytes(const DecidingSettings& settings, uint32_t frame,
                                          const FrameHistory& history);

} // namespace pertev
