#pragma once

// The sets of texture coordinates of a material. Files may number them at will, and meshes here have some: those that a
// material uses, whatever their numbers are.

#include <cstdint>
#include <string>
#include <vector>

#include "base/sink.h"
#include "scene/scene.h"

namespace pertev::gltf {

inline constexpr uint64_t kMaxTextureSet = 255;

/// Numbers of the file's sets that a mesh with a material has, at most kTextureSets.
using TextureSets = std::vector<uint8_t>;

/// Renumbers the sets of a material that uses others than 0 and 1, in place, and returns them: {0, 1} if it uses no
/// other. A texture with one set too many is left out with a warning.
TextureSets pack_texture_sets(MaterialParameters& material, const std::string& file, const std::string& origin,
                              Sink& sink);

} // namespace pertev::gltf
