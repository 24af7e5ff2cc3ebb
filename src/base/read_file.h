#pragma once

// Reads regular files: whole into memory, or only for their hash.

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace pertev {

/// Returns the bytes of `path`. Throws Error(BadInput) with the path and the system's reason if it cannot be read or
/// is not a regular file (a FIFO or a device could block for ever).
std::vector<std::byte> read_file(const std::filesystem::path& path);

/// Returns the hash of the bytes of `path`, 32 hexadecimal digits; memory does not depend on the file's size. Empty
/// if there is no such regular file. Throws as read_file() if it cannot be read.
std::string hash_of_file(const std::filesystem::path& path);

} // namespace pertev
