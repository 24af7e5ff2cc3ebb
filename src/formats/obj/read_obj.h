#pragma once

// Reads Wavefront OBJ with its .mtl files. One mesh and one instance for each object, group and material, in the
// order of first use. parse_obj.h and read_mtl.h describe what is read and how it is converted.

#include <cstddef>
#include <filesystem>
#include <span>

#include "base/sink.h"
#include "formats/files/file_access.h"
#include "formats/files/read_options.h"
#include "scene/scene.h"

namespace pertev {

/// Reads an OBJ file without validating the scene. Throws Error(BadInput) that names the file and the line. A missing
/// .mtl or texture gives a warning.
Scene read_obj(const std::filesystem::path& path, const FileAccess& access, const ReadOptions& options, Sink& sink);

struct ObjTexts {
    std::span<const std::byte> geometry,
        materials; // an .mtl file that replaces all files that the .obj file names
};
/// Reads an OBJ file from memory; `path` starts every message.
Scene read_obj(const std::filesystem::path& path, const ObjTexts& texts, const FileAccess& access,
               const ReadOptions& options, Sink& sink);

} // namespace pertev
