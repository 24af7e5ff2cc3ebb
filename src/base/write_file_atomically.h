#pragma once

// Replaces a file all or nothing: the new content is written beside the target, flushed, and renamed over it.

#include <cstddef>
#include <filesystem>
#include <span>

namespace pertev {

/// Replaces `path` with `bytes`, all or nothing: after a crash, kill -9, power loss or a full disk at any moment,
/// `path` holds either its old content or the new. Returns once the new content is on the disk. A symbolic link is
/// followed; permissions are those of the file that is replaced, or what the user's mask leaves. Throws
/// Error(FileWrite), with the path and the system's reason, when that fails or when `path` is something other than a
/// regular file (a device would be replaced, not written); nothing is left behind.
void write_file_atomically(const std::filesystem::path& path, std::span<const std::byte> bytes);

/// Throws the Error(FileWrite) that write_file_atomically would throw for a place that cannot be written: asked for
/// before a long render, so that the hour is not lost. Creates nothing that stays.
void check_writable(const std::filesystem::path& path);

} // namespace pertev
