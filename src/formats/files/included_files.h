#pragma once

// Counts the files that a scene's files include, so that some which include the same ones again and again end soon.

#include <cstddef>
#include <filesystem>
#include <set>

#include "base/error.h"

namespace pertev {

class IncludedFiles {
public:
    /// Counts the inclusion of a file by a statement at `location`. `is_nested`: in an included file; the scene's own
    /// may include a leaf as often as it says so. Throws Error(OverLimit).
    void count(const std::filesystem::path& file, bool is_nested, const FileLocation& location);

private:
    std::set<std::filesystem::path> known_;
    std::size_t repeated_ = 0;
};

} // namespace pertev
