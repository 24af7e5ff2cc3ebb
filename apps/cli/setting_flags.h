#pragma once

// The flags of a verb that are settings: made of the rows of the table (settings/setting_table.h). A flag is a
// setting's name with dashes.

#include <list>
#include <span>
#include <string>
#include <vector>

#include "apps/cli/flag_phrases.h"
#include "base/messages.h"
#include "settings/setting_table.h"

namespace CLI {
class App;
class Option;
} // namespace CLI

namespace pertev {

/// The setting that a flag is made of; null where it is none.
const Setting* setting_of(const CLI::Option& flag);

/// The texts of a line's flags, until it has been read to its end.
class SettingFlags {
public:
    /// Adds a flag for each setting of `verbs`, one bit or several. The values in `options` are what holds without it.
    void add(CLI::App& verb, uint32_t verbs, const PictureOptions& options,
             std::span<const Setting> table = all_settings());
    /// Adds --settings FILE, too.
    void add_file(CLI::App& verb);

    /// Gives `options` what the file of settings says, then what the flags say. Throws Error for values that are none,
    /// and for settings that do not go together.
    void read(PictureOptions& options, Messages& messages) const;

private:
    struct Flag {
        const Setting* setting;
        CLI::Option* option = nullptr;
        std::string text;
        std::vector<std::string> texts;
        bool is_on = false;
    };
    std::list<Flag> flags_; // CLI11 writes into them
    std::string file_;
    uint32_t verbs_ = 0;

    void read_flags(PictureOptions& options) const;
};

} // namespace pertev
