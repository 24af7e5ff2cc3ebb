#pragma once

// Phrases settings as flags, for front ends, and those of a picture as flags of pertev render, for people to copy.

#include <string>
#include <string_view>

#include "settings/setting.h"

namespace pertev {

/// The flag of a setting: two dashes and its name, with dashes in place of underscores.
std::string flag_of(std::string_view setting);

/// Returns the flag with each of its values, quoted for a shell, and a space after each; empty without values.
std::string flags_of(const Setting& setting, const std::vector<std::string>& texts);

/// Returns the settings of `options` that differ from their defaults as flags, and `view` after them. `view` has the
/// flags of the camera, and settings that it has are not repeated.
std::string picture_flags(const PictureOptions& options, const std::string& view);

} // namespace pertev
