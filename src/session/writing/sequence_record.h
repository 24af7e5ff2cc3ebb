#pragma once

// Records the finished frames of a sequence in a small JSON file beside them: the settings of all frames, the hash of
// the bytes of each completely written file, and the hash of each frame's picture. With it an interrupted sequence
// continues: files that still have the recorded bytes are kept, and everything else is rendered. Pictures do not
// depend on each other, so they equal those of an uninterrupted run. Real-time frames do, so earlier frames are
// rendered again and compared with the recorded hashes. Each part of a sequence has a record of its own, and keeps the
// frames that are in those of others.

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "session/sample_range.h"
#include "session/writing/deciding_settings.h"

namespace pertev {

class SequenceRecord {
public:
    /// Makes a record. `outputs` are patterns, `names` the cameras and `part` which of the frames are rendered
    /// (session/frame_range.h); `settings` is everything that determines the frames' pictures.
    SequenceRecord(std::vector<std::string> outputs, DecidingSettings settings, std::vector<std::string> names = {},
                   std::optional<PartNumber> part = std::nullopt);

    /// Path of the record: "frame-####.json" for "frame-####.png", and "frame-####.part-2-of-4.json" of a part.
    const std::filesystem::path& path() const { return path_; }

    /// Loads the record of an earlier run and returns false if there is none. Throws Error(BadInput) for a file that
    /// is no such record, and for one with other settings, of which it names the first. Records of other parts, or of
    /// the whole, count if they have the same settings.
    bool load();
    /// Returns whether all files of the frame exist with the recorded bytes.
    bool has(uint32_t frame) const;
    /// Records the frame's files, which have just been written, and the hash of its picture, and writes the record.
    /// Throws Error(BadInput, FileWrite).
    void add(uint32_t frame, const std::string& picture);
    /// Checks a frame's picture. Throws Error(BadInput) if it is recorded with another hash.
    void check_picture(uint32_t frame, const std::string& picture) const;

private:
    /// The frames of one file.
    struct Frames {
        std::map<std::string, std::string> hashes; // by file name
        std::map<uint32_t, std::string> pictures;  // hashes by frame
    };
    /// Returns the frames of a record. Throws Error(BadInput), also if it has other settings.
    Frames frames_in(const std::filesystem::path& record) const;
    std::vector<std::string> outputs_, names_;
    DecidingSettings settings_;
    std::filesystem::path path_;
    Frames own_;
    std::vector<Frames> others_; // other parts' frames
};

} // namespace pertev
