#pragma once

// The flags of a verb that are settings, made from the rows of the table (settings/setting_table.h). A flag is a
// setting's name with dashes.

#include <list>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apps/cli/flag_phrases.h"
#include "base/sink.h"
#include "settings/setting_table.h"

namespace CLI {
class App;
class Option;
} // namespace CLI

namespace pertev {

/// The setting of a flag; null if it is none.
const Setting* setting_of(const CLI::Option& flag);

/// The texts of a line's flags until all of it has been parsed.
class SettingFlags {
public:
    /// Adds a flag for each setting of `verbs`, one bit or several. The values in `options` are the defaults, and
    /// `own` describes other defaults of some settings for this verb.
    void add(CLI::App& verb, uint32_t verbs, const PictureOptions& options,
             std::span<const Setting> table = all_settings(), const std::map<std::string_view, std::string>& own = {});
    /// Adds --settings FILE.
    void add_file(CLI::App& verb);

    /// Sets `options` from the settings file, then from the flags, by combine_settings. Throws Error.
    void read(PictureOptions& options, Sink& sink) const;

private:
    struct Flag {
        const Setting* setting;
        CLI::Option* option = nullptr;
        std::string text;
        std::vector<std::string> texts;
        bool is_on = false;
    };
    std::list<Flag> flags_; // a list, because CLI11 writes into its elements
    std::string file_;
    uint32_t verbs_ = 0;

    void read_flags(PictureOptions& options) const;
};

} // namespace pertev
