#pragma once

// Reads a panorama of distant light.

#include <filesystem>

#include "base/sink.h"
#include "image/image.h"

namespace pertev {

/// Reads the equirectangular picture at `path` (.hdr, .exr; also .png and .jpg, whose highlights are clipped, with a
/// warning): 3 channels, linear. Throws Error(BadInput) that names the file if it cannot be read.
Image read_environment_image(const std::filesystem::path& path, Sink& sink);

} // namespace pertev
