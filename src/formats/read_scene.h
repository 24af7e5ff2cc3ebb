#pragma once

// Reads a scene file of any supported kind, by its extension: .obj .ply .stl .gltf .glb .pbrt .xml. Readers are an open
// set: one file each (read_obj, read_ply, read_stl, read_gltf, read_pbrt, read_mitsuba), listed in the table in
// read_scene.cpp. Built-in scenes are read by their names.

#include <filesystem>
#include <string>

#include "base/sink.h"
#include "formats/files/read_options.h"
#include "scene/scene.h"

namespace pertev {

/// Reads the scene of a file, or the built-in one with this name (formats/builtin_scenes.h). Throws Error(BadInput)
/// that names the file, the location in it and what would be right, and, for an animation or a scene that the file
/// does not have, a list of those that it has. `sink` reports what was left out or repaired. The scene has passed
/// validate().
Scene read_scene(const std::filesystem::path& path, const ReadOptions& options, Sink& sink);

/// Returns whether files of this name's format can say if a surface emits from one face or from both; built-in scenes
/// can.
bool defines_emitter_sides(const std::filesystem::path& path);

/// Returns whether files of this name's format define their unit and up axis, so that ReadOptions::space has no effect;
/// built-in scenes do.
bool defines_space(const std::filesystem::path& path);

/// Returns whether a name could be a scene's: it has an extension from above or is that of a built-in scene.
bool is_scene_name(const std::filesystem::path& path);
/// List of the possible names for messages: "a scene file (.obj ...) nor a built-in scene (...)".
std::string scene_kinds();

} // namespace pertev
