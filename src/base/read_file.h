#pragma once

// Reads regular files: whole into memory, in pieces, or only for their hash.

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace pertev {

using InputFile = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;
/// Opens `path` for reading from its start. Throws as read_file().
InputFile open_file(const std::filesystem::path& path);

/// Returns the bytes of `path`. Throws Error(BadInput) with the path and the system's reason if it cannot be read or
/// is not a regular file (a FIFO or a device could block without end).
std::vector<std::byte> read_file(const std::filesystem::path& path);

/// Returns the hash of the bytes of `path`, 32 hexadecimal digits; memory does not depend on the file's size. Empty
/// if there is no such regular file. Throws as read_file() if it cannot be read.
std::string hash_of_file(const std::filesystem::path& path);

} // namespace pertev
