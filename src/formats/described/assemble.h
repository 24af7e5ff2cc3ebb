#pragma once

// Makes a scene of the parts of a described one. Each pair of a surface and what its shapes add to it is one material.

#include <cstdint>
#include <string_view>

#include "base/sink.h"
#include "formats/described/parts.h"
#include "formats/files/load_textures.h"
#include "scene/scene.h"

namespace pertev::described {

/// Makes a scene without cameras. The meshes are finished, and their normals and indices fit. `scene_from_world` maps
/// the file's world to the scene's; `file_bytes` is the size of the files of statements. `expected` says what a file
/// without shapes lacks. Throws Error(OverLimit) for pictures that take more than the files justify.
Scene assemble(Parts parts, const DoubleTransform& scene_from_world, uint64_t file_bytes, std::string_view expected,
               TextureLoader& loader, Sink& sink);

} // namespace pertev::described
