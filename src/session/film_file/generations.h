#pragma once

// A file that is written again and again, and the generation before it beside it as FILE.previous.

#include <cstdint>
#include <string>

namespace pertev {

/// Returns whether the file exists.
bool has_generation(const std::string& file);
inline std::string previous_generation(const std::string& file) { return file + ".previous"; }
/// Throws Error(FileWrite) if two generations that take so many bytes each, and the next while it is written, may not
/// fit on the disk.
void check_space_for_generations(const std::string& file, uint64_t bytes);

} // namespace pertev
