#pragma once

// Reads the scene files of pbrt-v4, and of pbrt-v3 where they are unambiguous, also gzip'd, with what they include.
//
// Source: the file formats' documentation on pbrt.org; conventions as stated in colors.h, camera.h and materials.h.

#include <cstddef>
#include <filesystem>
#include <span>

#include "base/sink.h"
#include "formats/files/file_access.h"
#include "formats/files/read_options.h"
#include "scene/scene.h"

namespace pertev {

/// Reads a file. Unknown and unreadable statements and parameters are left out with a warning. The result is not
/// validated. Throws Error(BadInput) if the file cannot be read, and Error(OverLimit) for more files, instances or
/// pictures than its size justifies.
Scene read_pbrt(const std::filesystem::path& path, const FileAccess& access, const ReadOptions& options, Sink& sink);
/// Reads a text as that of the file `path`.
Scene read_pbrt(const std::filesystem::path& path, std::span<const std::byte> text, const FileAccess& access,
                const ReadOptions& options, Sink& sink);

} // namespace pertev
