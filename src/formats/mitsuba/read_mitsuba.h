#pragma once

// Reads the scene files of Mitsuba 3 and 0.6, with what they include.
//
// Source: the plugins' documentation of both; conventions as stated in view.h, shapes.h, colors.h and bsdfs.h.

#include <cstddef>
#include <filesystem>
#include <span>

#include "base/sink.h"
#include "formats/files/file_access.h"
#include "formats/files/read_options.h"
#include "scene/scene.h"

namespace pertev {

/// Reads a file. Unknown and unreadable elements are left out with a warning. The result is not validated. Throws
/// Error(BadInput) if the file cannot be read, and Error(OverLimit) for more files, elements, instances or pictures
/// than its size justifies.
Scene read_mitsuba(const std::filesystem::path& path, const FileAccess& access, const ReadOptions& options, Sink& sink);
/// Reads a text as that of the file `path`.
Scene read_mitsuba(const std::filesystem::path& path, std::span<const std::byte> text, const FileAccess& access,
                   const ReadOptions& options, Sink& sink);

} // namespace pertev
