#pragma once

// Reads files of many cameras: our own JSON, NeRF's transforms.json, and COLMAP's cameras and images, as text or binary
// (formats/cameras/read_colmap.h). A camera is stated by settings, under their names in the table of settings.
//
// Our own:
//     {"cameras": [{"name": "front", "eye": [0, 1, 5], "target": [0, 1, 0], "fov": 40}, ...], "lens": "fisheye", ...}
// Members are settings; those beside "cameras" hold for each camera that does not have its own. Without a name a
// camera has its number.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "scene/scene.h"

namespace pertev {

struct CameraOfFile {
    std::string name;      // differs from those of the others, and can be that of a file
    FileLocation location; // in the file
    std::vector<SuggestedSetting> settings;
};

/// Reads a file, or a folder with COLMAP's files. `width` and `height` apply to a file whose cameras have an angle of
/// view and no size of their pictures; 0: none. Throws Error(BadInput) with the line or the JSON pointer.
std::vector<CameraOfFile> read_cameras(const std::filesystem::path& path, uint32_t width = 0, uint32_t height = 0);

} // namespace pertev
