#pragma once

// A camera's path from a JSON file:
//     {"keys": [{"time": 0, "eye": [0, 1, 5], "target": [0, 1, 0], "up": [0, 1, 0], "fov": 45}, ...]}
// time in seconds from 0 on, rising; eye and target in metres; up (0, 1, 0 without); fov: full vertical angle of view
// in degrees, of all keys or of none.

#include <filesystem>

#include "scene/camera_path.h"

namespace pertev {

/// Throws Error(BadInput) that names the file, the JSON pointer, and what would be right.
CameraPath read_camera_path(const std::filesystem::path& path);

} // namespace pertev
