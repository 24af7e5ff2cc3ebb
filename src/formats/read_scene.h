#pragma once

// Reads a scene file of any supported kind, by its extension: .obj .ply .gltf .glb. Readers are an open set: one file
// each (read_obj, read_ply, read_gltf), listed in the table in read_scene.cpp.

#include <filesystem>
#include <string>
#include <vector>

#include "base/messages.h"
#include "formats/file_access.h"
#include "scene/scene.h"

namespace pertev {

struct ReadOptions {
    std::vector<std::filesystem::path> allowed_paths; // --allow-path
    bool geometry_only = false;                       // skip textures and materials: every surface grey
};

/// Throws Error(BadInput) that names the file, the place in it and what would be right. What was left out or repaired
/// is said in `messages`. The scene has been through validate().
Scene read_scene(const std::filesystem::path& path, const ReadOptions& options, Messages& messages);

/// A scene that is part of the program (formats/builtin_scenes.h has the names). Throws Error(BadInput) that lists
/// them when there is none of that name.
Scene read_builtin_scene(const std::string& name, Messages& messages);

} // namespace pertev
