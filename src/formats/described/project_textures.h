#pragma once

// Texture coordinates by mappings (formats/described/texture_mapping.h), as further sets of coordinates of a mesh's own
// copy. They are exact at vertices, and linear between them, on triangles that are divided until that is hardly
// visible.

#include "base/sink.h"
#include "formats/described/parts.h"

namespace pertev::described {

/// Gives each image with a mapping a set of coordinates from 1 on, the same sets again if it is called again.
/// Images whose mappings are more than a mesh has sets keep set 0. Returns the mappings of the sets.
std::vector<std::shared_ptr<const TextureMapping>> number_mappings(Surface& surface);

/// Gives shapes whose images have mappings a mesh with these sets. Copies of meshes in one place are shared. Beyond
/// a limit for files of this size the mesh's own coordinates are used, with a warning.
void project_textures(Parts& parts, uint64_t file_bytes, Sink& sink);

} // namespace pertev::described
