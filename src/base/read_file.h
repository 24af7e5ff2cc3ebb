#pragma once

// Reads regular files: whole into memory, or for their hash alone.

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace pertev {

/// The bytes of `path`. Throws Error(BadInput) with the path and the system's reason when it cannot be read or is not
/// a regular file (a FIFO or a device could block for ever).
std::vector<std::byte> read_file(const std::filesystem::path& path);

/// Returns the hash of the bytes of `path`, 32 hexadecimal digits, and takes no more memory for a large file. Empty
/// where no regular file is called so. Throws as read_file() where it cannot be read.
std::string hash_of_file(const std::filesystem::path& path);

} // namespace pertev
