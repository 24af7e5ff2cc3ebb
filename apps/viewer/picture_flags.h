#pragma once

// The flags of pertev render that make the picture on screen, for people to copy.

#include <string>

#include "settings/picture_options.h"

namespace pertev {

/// Returns the settings of `options` that differ from their defaults as flags, and `view` after them. `view` has the
/// flags of the camera, and settings that it has are not repeated.
std::string picture_flags(const PictureOptions& options, const std::string& view);

} // namespace pertev
