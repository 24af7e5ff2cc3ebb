#pragma once

// A process that is killed while it replaces a file (base/write_file_atomically.h) may leave the new content beside it
// under a name with its own number. Whoever writes the file next removes those.

#include <filesystem>

namespace pertev {

/// Removes the files that processes which no longer exist left beside `path`. Failures are ignored: they cost space.
void remove_leftovers(const std::filesystem::path& path);

} // namespace pertev
