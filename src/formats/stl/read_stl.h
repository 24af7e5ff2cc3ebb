#pragma once

// Reads STL (parse_stl.h): a mesh of each solid, with one vertex for equal corners, and one grey material.

#include <filesystem>

#include "base/sink.h"
#include "formats/files/file_access.h"
#include "formats/files/read_options.h"
#include "scene/scene.h"

namespace pertev {

/// Reads an STL file. Instances have the names of their solids, or the file's. The result is not validated. Throws
/// Error(BadInput) as parse_stl() does.
Scene read_stl(const std::filesystem::path& path, const FileAccess& access, const ReadOptions& options, Sink& sink);

} // namespace pertev
