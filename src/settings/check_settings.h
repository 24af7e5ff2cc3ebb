#pragma once

// Whether the settings that were given go together, as the rows of the table say it.

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
        Needs,      // none of the others holds
        Excludes,   // the other one holds
    };
    const Setting* setting;
    Kind kind;
    /// Names of settings, or NAME=VALUE; of Integrator the names of those that have the setting.
    std::vector<std::string> others;
};

/// Returns the first that is found, in the order of the table; none where all go together. Settings that `verbs` do not
/// have are not asked for.
std::optional<SettingConflict> find_conflict(const PictureOptions& options, uint32_t verbs);

/// Returns the name of the setting that yields where settings do not go together: one of a file does to what was given
/// otherwise, and where its value is the default, which a file may hold, too. Empty: neither does.
std::string overruled_setting(const SettingConflict& conflict, const PictureOptions& options);

/// Gives `options` the settings of `verbs` that a scene's file suggests, in its order, but for those that were given
/// and those that do not go with what was. What is no setting, no value, or a setting by which files are opened is left
/// out with a warning: the file has been opened already.
void take_suggestions(const Scene& scene, uint32_t verbs, PictureOptions& options, Messages& messages);

} // namespace pertev
