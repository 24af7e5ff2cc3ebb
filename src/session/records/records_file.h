#pragma once

// A file of what an integrator makes before its first sample, so that the parts of a picture share it: whoever finds no
// file makes the contents and writes it. All make the same bytes, so it does not matter who is first.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "session/writing/deciding_settings.h"

namespace pertev {

class RecordsFile {
public:
    /// Makes an object without reading anything. `decides` has everything on which the contents depend.
    RecordsFile(std::string file, DecidingSettings decides) : file_(std::move(file)), decides_(std::move(decides)) {}

    const std::string& file() const { return file_; }
    /// Returns the contents; nothing if the file is not there, after a check that it can be written. Throws
    /// Error(BadInput) if it is damaged or depends on something else, naming the first difference, and
    /// Error(FileWrite).
    std::optional<std::vector<std::byte>> read() const;
    /// Writes the file atomically. Throws Error(FileWrite).
    void write(std::span<const std::byte> contents) const;
    /// Returns the error for a file whose contents are no records of this kind.
    Error damaged(const std::string& why) const;

private:
    std::string file_;
    DecidingSettings decides_;
};

} // namespace pertev
