#pragma once

// Reads a camera path from a JSON file:
//     {"keys": [{"time": 0, "eye": [0, 1, 5], "target": [0, 1, 0], "up": [0, 1, 0], "fov": 45}, ...]}
// time is in seconds from 0 on, ascending; eye and target in metres; up defaults to 0, 1, 0; fov is the full vertical
// field of view in degrees, given for all keys or none.

#include <filesystem>

#include "scene/camera_path.h"

namespace pertev {

/// Reads a camera path. Throws Error(BadInput) that names the file, the JSON pointer, and what would be right.
CameraPath read_camera_path(const std::filesystem::path& path);

} // namespace pertev
