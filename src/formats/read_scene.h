#pragma once

// Reads a scene file of any supported kind, by its extension: .obj .ply .gltf .glb. Readers are an open set: one file
// each (read_obj, read_ply, read_gltf), listed in the table in read_scene.cpp. Built-in scenes are read by their names.

#include <filesystem>
#include <string>

#include "base/messages.h"
#include "formats/files/read_options.h"
#include "scene/scene.h"

namespace pertev {

/// The scene in a file, or the one that is part of the program under this name (formats/builtin_scenes.h). Throws
/// Error(BadInput) that names the file, the place in it and what would be right; so it does for an animation or a scene
/// that the file does not have, with the list of those that it has. What was left out or repaired is said
/// in `messages`. The scene has been through validate().
Scene read_scene(const std::filesystem::path& path, const ReadOptions& options, Messages& messages);

/// Whether files of this name's kind can say if a surface emits from one face or from both; so can built-in scenes.
bool tells_lamp_sides(const std::filesystem::path& path);

/// Whether files of this name's kind tell their unit and which way is up, so that ReadOptions::space means nothing to
/// them; so do built-in scenes.
bool tells_space(const std::filesystem::path& path);

/// Whether a name could be a scene's: it has an extension from above or is that of a built-in scene.
bool is_scene_name(const std::filesystem::path& path);
/// What there is to be named, for messages: "a scene file (.obj ...) nor a built-in scene (...)".
std::string scene_kinds();

} // namespace pertev
