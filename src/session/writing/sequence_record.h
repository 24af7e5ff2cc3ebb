#pragma once

// Which frames of a sequence are done: a small JSON file beside them that holds what all of them were asked for with,
// of each file that was written whole the hash of its bytes, and of each frame that of its picture. By it an
// interrupted sequence goes on: what is there with the very bytes that were written is kept, all else is rendered.
// Since pictures do not depend on each other they are those of an undisturbed run; frames in real time do, and those
// before are rendered again for them, and compared with what is known of their pictures.

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace pertev {

class SequenceRecord {
public:
    using Settings = std::vector<std::pair<std::string, std::string>>; // names and values

    /// `outputs`: names with '#' (session/frame_range.h). `settings`: all that decides the frames' pictures.
    SequenceRecord(std::vector<std::string> outputs, Settings settings);

    /// "frame-####.png" has its record in "frame-####.json".
    const std::filesystem::path& path() const { return path_; }

    /// Takes over the record of an earlier run; false where there is none. Throws Error(BadInput) for a file that is no
    /// such record, and for one of other settings, the first of which it names.
    bool load();
    /// Whether all files of the frame are there, with the bytes that the record knows.
    bool has(uint32_t frame) const;
    /// Notes the frame's files, which have just been written, and the hash of its picture, and writes the record.
    /// Throws Error(BadInput, FileWrite).
    void add(uint32_t frame, const std::string& picture);
    /// Throws Error(BadInput) where the record knows the frame with another picture than that of this hash.
    void check_picture(uint32_t frame, const std::string& picture) const;

private:
    std::vector<std::string> outputs_;
    Settings settings_;
    std::filesystem::path path_;
    std::map<std::string, std::string> hashes_; // by file name
    std::map<uint32_t, std::string> pictures_;  // hashes by frame
};

} // namespace pertev
