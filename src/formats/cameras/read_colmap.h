#pragma once

// COLMAP's cameras and images: cameras.txt and images.txt, or cameras.bin and images.bin, in one folder. Pixels are
// counted from the picture's upper left corner, as here.

#include "formats/cameras/read_cameras.h"

namespace pertev {

/// Returns whether `path` is a folder or a file of COLMAP's, by its name.
bool is_colmap(const std::filesystem::path& path);

/// Reads the folder `path`, its sparse/0 if it has no such files itself, or the folder that has the file `path`. Throws
/// Error(BadInput) with the line of a text.
std::vector<CameraOfFile> read_colmap(const std::filesystem::path& path);

} // namespace pertev
