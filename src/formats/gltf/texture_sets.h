#pragma once

// The sets of texture coordinates of a material. Files may number them at will, and meshes here have two: those that a
// material uses, whatever their numbers are.

#include <array>
#include <cstdint>
#include <string>

#include "base/sink.h"
#include "scene/scene.h"

namespace pertev::gltf {

inline constexpr uint64_t kMaxTextureSet = 255;

/// Numbers of the file's sets that a mesh with a material has as its first and second.
using TextureSets = std::array<uint8_t, 2>;

/// Renumbers the sets of a material that uses others than 0 and 1, in place, and returns them: {0, 1} if it uses no
/// other. A texture with a third set is left out with a warning.
TextureSets pack_texture_sets(MaterialParameters& material, const std::string& file, const std::string& origin,
                              Sink& sink);

/// Leaves out textures of `scene` that still have another set than 0 and 1, with a warning: a conversion made them.
void drop_other_sets(Scene& scene, const std::string& file, Sink& sink);

} // namespace pertev::gltf
