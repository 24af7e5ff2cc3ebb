#pragma once

// Settings as JSON: all that a picture is a function of beside its scene, so that it can be made again. The names are
// those of the table of settings.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "base/messages.h"
#include "settings/setting_table.h"

namespace pertev {

/// Returns the hash of a scene's file, 32 hexadecimal digits: of its bytes, not of those of other files that it names.
/// The hash of a built-in scene is that of its text. Empty where there is no such file.
std::string scene_hash(const std::string& scene);

/// Returns an object {"version":1,"scene":{"name":...,"hash":...},"settings":{...}} of the settings that were given,
/// and of those that every file of a picture records.
std::string settings_json(const PictureOptions& options, const std::string& hash_of_scene,
                          std::span<const Setting> table = all_settings());

/// Gives `options` the settings of a file. What the file holds and the table or `verbs` do not have is left out with a
/// warning; another scene than that of `options` is a warning, too. Settings named in `overruled` are passed over.
/// Throws Error(BadInput) for a file that is none, or of another version, and for a value that is none.
void read_settings(const std::filesystem::path& file, uint32_t verbs, std::span<const std::string> overruled,
                   PictureOptions& options, Messages& messages);

} // namespace pertev
