#pragma once

// Scenes that are part of the program and are named instead of given as a file: those of our own under scenes/, as glTF
// files without companions, or as OBJ files with one file of materials and no textures. The definitions are written by
// cmake/embed_scenes.cmake.

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace pertev {

/// The glTF or OBJ file of a built-in scene ("cornell-box"); nothing where there is no scene of that name.
std::optional<std::span<const std::byte>> builtin_scene(std::string_view name);
/// The MTL file of a built-in scene that is an OBJ file; nothing for others.
std::optional<std::span<const std::byte>> builtin_materials(std::string_view name);

/// All names, for messages.
std::vector<std::string_view> builtin_scene_names();

} // namespace pertev
