#pragma once

// Decodes the colours of an OpenEXR file for decode_image; image/read_exr.h reads every layer.

#include <cstddef>
#include <span>
#include <string>

#include "image/image.h"

namespace pertev {

/// R, G, B (and A), or else Y (and A), of the first part that has them, over the display window; linear. Throws
/// Error(BadInput) that lists the existing channels if no part has them.
Image decode_exr(std::span<const std::byte> bytes, const std::string& name);

} // namespace pertev
