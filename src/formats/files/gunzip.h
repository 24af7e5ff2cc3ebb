#pragma once

// Decompresses gzip (RFC 1952) and zlib's own format (RFC 1950).

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/limits.h"

namespace pertev {

/// Returns whether bytes begin like a gzip'd file.
bool is_gzip(std::span<const std::byte> bytes);

/// Returns the most bytes that a compressed file of `bytes` may decompress to: what the files of a scene have without a
/// reason, and 32 times its size, which scenes and meshes stay below. Zeros are compressed to a thousandth.
constexpr uint64_t most_decompressed(uint64_t bytes) { return kFreeMeshBytes + 32 * bytes; }

/// Returns the content of a gzip'd file, of all its members. `file` is for messages. Throws Error(BadInput) if it is
/// damaged or cut off, and Error(OverLimit) if it decompresses to more than `limit` bytes; without one, to more than
/// most_decompressed().
std::vector<std::byte> gunzip(std::span<const std::byte> bytes, const std::string& file, uint64_t limit);
std::vector<std::byte> gunzip(std::span<const std::byte> bytes, const std::string& file);

/// Returns the content of one stream of zlib in front of `bytes`. Throws as gunzip().
std::vector<std::byte> inflate_zlib(std::span<const std::byte> bytes, const std::string& file);

struct UnzippedFile {
    std::vector<std::byte> bytes;
    uint64_t size = 0; // bytes on the disk
};

/// Reads a file, and decompresses it if it is gzip'd. Throws as read_file() and gunzip().
UnzippedFile read_unzipped(const std::filesystem::path& path);

} // namespace pertev
