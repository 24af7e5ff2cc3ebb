#pragma once

// Settings as JSON: everything besides its scene on which a picture depends, so that it can be rendered again. The
// names are those of the table of settings.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "base/sink.h"
#include "settings/setting_table.h"

namespace pertev {

/// Returns the hash of a scene's file, 32 hexadecimal digits: of its own bytes, not of other files that it refers to.
/// The hash of a built-in scene is that of its text. Empty if there is no such file.
std::string scene_hash(const std::string& scene);

/// Returns whether settings_json contains the setting: it was given or every file of a picture records it, and it has
/// a value that can be given again.
bool is_written(const PictureOptions& options, const Setting& setting);

/// Returns an object {"version":1,"scene":{"name":...,"hash":...},"settings":{...}} with the settings
/// that is_written() names.
std::string settings_json(const PictureOptions& options, const std::string& hash_of_scene,
                          std::span<const Setting> table = all_settings());

/// Returns `json`, an object of settings_json(), for a picture that has `samples` per pixel; unchanged if `json` does
/// not name the samples.
std::string with_samples(const std::string& json, std::string_view samples);
/// Returns `json` with the value that `options` have for a setting, which `json` may lack.
std::string with_setting(const std::string& json, const PictureOptions& options, std::string_view name);

/// Returns the settings that determine a real-time frame besides those of its picture, as a JSON object: `options`,
/// and the depth of frames if they have their own.
std::string reconstruction_json(const ReconstructionOptions& options, std::optional<uint32_t> frame_depth);

/// Adds the settings of a file to `options`. Entries that the table or `verbs` do not have are skipped with a
/// warning; another scene than that of `options` gives a warning too. Settings in `overruled` are skipped. Throws
/// Error(BadInput) for a file that is invalid or has another version, and for an invalid value.
void read_settings(const std::filesystem::path& file, uint32_t verbs, std::span<const std::string> overruled,
                   PictureOptions& options, Sink& sink);

/// Sets some of the options.
using SetOthers = std::function<void(PictureOptions&)>;

/// Adds the settings of a file, if there is one, and then the others, which overrule it: a setting of the file that
/// does not go with them is dropped. Throws Error(BadInput) for a conflict between the others (check_settings), and as
/// read_settings and `set_others`.
void combine_settings(const std::filesystem::path& file, uint32_t verbs, const SetOthers& set_others,
                      PictureOptions& options, Sink& sink);

} // namespace pertev
