#pragma once

// Help, a man page and shell completion, generated from the flags of verbs.

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace pertev {

/// Writes the help of verbs in 80 columns. It lists common settings and the names of other groups, or everything for
/// a given group or "all".
class Help : public CLI::FormatterBase {
public:
    explicit Help(std::string group) : group_(std::move(group)) {}
    std::string make_help(const CLI::App* verb, std::string name, CLI::AppFormatMode mode) const override;

private:
    std::string group_; // in lower case; empty: none
};

/// Removes and returns the group of flags after --help or -h, or "all"; empty if none follows. `words` is the command
/// line. Throws Error(BadInput) for another word after a verb's --help.
std::string take_help_group(std::vector<std::string>& words);

/// The names of a flag, as in "-o,--output". Names of earlier versions, which follow the first long one, are hidden.
std::string shown_names(const CLI::Option& option);

/// The description of a flag as sentences, with its default. For a setting `is_short` means the first sentence alone.
std::string flag_description(const CLI::Option& option, bool is_short);

/// A man page of all verbs.
std::string man_page(const CLI::App& app);
/// A completion script for verbs, flags, and the named values of settings. Throws Error(BadInput) for another shell
/// than bash, zsh and fish.
std::string completion(const CLI::App& app, const std::string& shell);
/// The content of docs/settings.md: the table of settings.
std::string settings_document();

} // namespace pertev
