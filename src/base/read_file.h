#pragma once

// Reads a whole regular file into memory.

#include <cstddef>
#include <filesystem>
#include <vector>

namespace pertev {

/// The bytes of `path`. Throws Error(BadInput) with the path and the system's reason when it cannot be read or is not
/// a regular file (a FIFO or a device could block for ever).
std::vector<std::byte> read_file(const std::filesystem::path& path);

} // namespace pertev
