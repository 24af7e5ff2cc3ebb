#pragma once

// A file that is written again and again, and the generation before it beside it as FILE.previous. Each is written
// atomically, so that whatever ends the process leaves a whole one.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "base/error.h"
#include "base/sink.h"

namespace pertev {

/// The refusal of a whole file, for which the generation before is no substitute.
class RefusedGeneration : public Error {
public:
    using Error::Error;
};

class Generations {
public:
    /// Makes an object without reading anything.
    explicit Generations(std::string file) : file_(std::move(file)), previous_(file_ + ".previous") {}

    const std::string& file() const { return file_; }
    /// Calls `take` for the file, if it is there; if that throws Error(BadInput, OverLimit), the file is damaged: warns
    /// and calls it for the generation before. Removes what killed processes left beside them. Returns why none is
    /// whole, with both names; nothing if one was taken, or if there is no file, about which it warns if the generation
    /// before is there. Throws RefusedGeneration and other errors of `take`.
    std::optional<Error> take(const std::function<void(const std::string& file)>& take, Sink& sink);
    /// Throws Error(FileWrite) if two generations that take so many bytes each, and the next while it is written, may
    /// not fit on the disk.
    void check_space(uint64_t bytes) const;
    /// Replaces the file; the file so far becomes the generation before, unless it is damaged. Throws Error(FileWrite)
    /// and leaves the old file unchanged.
    void write(std::span<const std::byte> bytes);
    /// Deletes the file and the generation before, as far as that is possible.
    void remove() const;

private:
    std::string file_, previous_;
    bool is_damaged_ = false; // the file, which thus is no generation to keep
};

} // namespace pertev
