#pragma once

// The scenes that the laboratory takes: a file, a built-in scene, or one of the record's by its name.

#include <string>

#include "apps/cli/scene_options.h"
#include "scene/scene.h"

namespace pertev {

/// Geometry, and whatever light it brings. Throws Error; where there is neither a file nor a scene of this name, with
/// the names that there are.
Scene read_lab_scene(const SceneOptions& options, Messages& messages);

/// Returns its title in reports: its file's name without folder and extension, in UTF-8 whatever its bytes are.
std::string lab_scene_title(const std::string& scene);

} // namespace pertev
