#pragma once

// Replaces a file atomically: the new content is written beside the target, flushed, and renamed over it.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "base/sink.h"

namespace pertev {

/// Returns the path that stands for the standard output, with the extension of a format ("png").
std::filesystem::path standard_output(const std::string& extension);

/// Replaces `path` with `bytes`, all or nothing: after a crash, kill -9, power loss or a full disk at any moment,
/// `path` holds either its old content or the new. Returns once the new content is on the disk. A symbolic link is
/// followed; permissions are those of the replaced file, or the user's defaults. Throws Error(FileWrite), with the path
/// and the system's reason, if that fails or if `path` is not a regular file (a device would be replaced, not written);
/// nothing is left behind. `sink` may end it, which leaves the old content. To standard_output() it appends; a reader
/// that has closed it is no error.
void write_file_atomically(const std::filesystem::path& path, std::span<const std::byte> bytes, Sink& sink = nobody());
/// Replaces `path` atomically. Its old content, if there is any, stays as `previous`, whose own content is lost. At
/// any moment `path` exists if it did before the call. After an error it is unchanged.
void write_generation(const std::filesystem::path& path, const std::filesystem::path& previous,
                      std::span<const std::byte> bytes);

/// Returns the bytes that are free where `target`, a path without links, lies or would; nothing if the system reports
/// no number.
std::optional<uint64_t> free_disk_bytes(const std::filesystem::path& target);

/// Throws the Error(FileWrite) that write_file_atomically would throw for a path that cannot be written. It is for
/// use before a long render. Creates nothing that stays.
void check_writable(const std::filesystem::path& path);

} // namespace pertev
