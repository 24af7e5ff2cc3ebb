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
/// written, and hashes of all files, which the record has. Files in settings have names without their folders.
DecidingSettings deciding_settings(const PictureOptions& options, const PictureRecord& record);

struct SettingDifference {
    std::string name;          // one of the names in the settings
    std::string before, after; // empty if there is none
};
/// Returns the difference that explains the others, or the first; nothing if both are equal except for names of files.
std::optional<SettingDifference> first_difference(const DecidingSettings& before, const DecidingSettings& after);
/// Says a difference from `before`, which is "there", as in "`seed` is "0" there, not "1"" or "a.mtl is another file
/// there".
std::string text_of(const SettingDifference& difference);

} // namespace pertev
