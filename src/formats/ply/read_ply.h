#pragma once

// Reads PLY, Stanford's polygon file format (Greg Turk, 1994), ascii and binary of both byte orders: vertex
// positions, normals, colours and texture coordinates, faces, triangle strips and textures
// (formats/ply/ply_textures.h); everything else is skipped. Every count is checked against the remaining bytes.

#include <filesystem>

#include "base/sink.h"
#include "formats/files/file_access.h"
#include "formats/files/read_options.h"
#include "scene/scene.h"

namespace pertev {

/// Reads one mesh for each texture, grey if there is neither a texture nor vertex colours, which are sRGB
/// (formats/mesh/vertex_colors.h); v of texture coordinates points up. The result is not validated. Throws
/// Error(BadInput) that names the file and the header line, or the element, its number and the line (binary: the
/// byte).
Scene read_ply(const std::filesystem::path& path, const FileAccess& access, const ReadOptions& options, Sink& sink);

} // namespace pertev
