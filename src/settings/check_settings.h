#pragma once

// Checks that the given settings are compatible, according to the rows of the table.

#include <optional>
#include <string>
#include <vector>

#include "settings/setting_table.h"

namespace pertev {

/// Returns the names of the integrators that have the setting.
std::vector<std::string> integrators_with(const Setting& setting);

struct SettingConflict {
    enum class Kind : uint8_t {
        Integrator, // the integrator does not have the setting
        Needs,      // none of the others is satisfied
        Excludes,   // the other one is set
    };
    const Setting* setting;
    Kind kind;
    /// Names of settings, or NAME=VALUE; for Integrator the names of those that have the setting.
    std::vector<std::string> others;
    std::string value = ""; // the setting's value, if only that is in conflict
};

/// Returns the first conflict in the order of the table; nothing if there is none. Settings that `verbs` do not have
/// are ignored.
std::optional<SettingConflict> find_conflict(const PictureOptions& options, uint32_t verbs);

/// Describes a conflict: the setting, and why it cannot be as the options have it.
Remark remark_of(const SettingConflict& conflict, const PictureOptions& options);

/// Throws Error(BadInput) for the first conflict.
void check_settings(const PictureOptions& options, uint32_t verbs);

/// Returns the name of the setting that is dropped if settings conflict: one from a file gives way to one given
/// otherwise, and so does one with the default value, which a file may contain too. Empty if neither does.
std::string overruled_setting(const SettingConflict& conflict, const PictureOptions& options);

/// Adds to `options` the settings of `verbs` that a scene's file suggests for pictures of its camera `own` (null:
/// none), in its order, except for those that were given and those in conflict with them. Unknown settings, invalid
/// values, and settings by which files are opened are skipped with a warning, because the file is open already.
void apply_suggestions(const Scene& scene, const Camera* own, uint32_t verbs, PictureOptions& options, Sink& sink);

} // namespace pertev
