#pragma once

// Everything that decides a picture, as names and values in text. Files that hold a part of some work keep it, so that
// only parts of the same work are put together.

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "session/writing/picture_metadata.h"
#include "settings/picture_options.h"

namespace pertev {

using DecidingSettings = std::vector<std::pair<std::string, std::string>>; // names and values

/// Returns all settings, what the metadata of settings_metadata() say of them, which is the same however they were
/// written, and hashes of the files that they name.
DecidingSettings deciding_settings(const PictureOptions& options, const PictureRecord& record);

struct SettingDifference {
    std::string name;          // between backquotes if it is a setting
    std::string before, after; // empty if there is none
};
/// Returns the first difference of `after`, or nothing if both are equal.
std::optional<SettingDifference> first_difference(const DecidingSettings& before, const DecidingSettings& after);

} // namespace pertev
