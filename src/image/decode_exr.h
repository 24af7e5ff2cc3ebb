#pragma once

// The colour picture of an OpenEXR file. Called by decode_image; image/read_exr.h gives every layer.

#include <cstddef>
#include <span>
#include <string>

#include "image/image.h"

namespace pertev {

/// R, G, B (and A), or else Y (and A), of the first part that has them, over the display window; linear. Throws
/// Error(BadInput) that lists the channels there are when no part has them.
Image decode_exr(std::span<const std::byte> bytes, const std::string& name);

} // namespace pertev
