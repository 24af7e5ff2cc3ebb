#pragma once

// Reads a panorama: light from far away.

#include <filesystem>

#include "base/messages.h"
#include "image/image.h"

namespace pertev {

/// The equirectangular picture at `path` (.hdr, .exr; also .png and .jpg, whose whites are cut off, with a warning), 3
/// channels, linear. Throws Error(BadInput) that names the file for what cannot be read.
Image read_environment_image(const std::filesystem::path& path, Messages& messages);

} // namespace pertev
