#pragma once

// Built-in scenes, which are named instead of given as a file: our own scenes from scenes/, as self-contained glTF
// files, or as OBJ files with one file of materials and no textures. cmake/embed_scenes.cmake writes the definitions.

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace pertev {

/// The glTF or OBJ file of a built-in scene ("cornell-box"); nothing if there is no scene of that name.
std::optional<std::span<const std::byte>> builtin_scene(std::string_view name);
/// The MTL file of a built-in OBJ scene; nothing for others.
std::optional<std::span<const std::byte>> builtin_materials(std::string_view name);

/// Names of all built-in scenes, for messages.
std::vector<std::string_view> builtin_scene_names();

} // namespace pertev
