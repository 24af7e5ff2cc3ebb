#pragma once

// Verbs describe themselves by what is made of their flags: help, a page for man, completion for shells.

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace pertev {

/// Writes the help of verbs, in 80 columns. Of flags that are settings it has those that most people use, and of other
/// groups the names, unless it is made for a group, or for "all".
class Help : public CLI::FormatterBase {
public:
    explicit Help(std::string group) : group_(std::move(group)) {}
    std::string make_help(const CLI::App* verb, std::string name, CLI::AppFormatMode mode) const override;

private:
    std::string group_; // in small letters; empty: none
};

/// Takes the word after --help or -h off the line where it names a group of flags, or all: it is returned. `words`: the
/// command line.
std::string take_help_group(std::vector<std::string>& words);

/// A page in the language of man, of all verbs.
std::string man_page(const CLI::App& app);
/// A script that completes verbs and flags, and the values of settings that have names. Throws Error(BadInput) for
/// another shell than bash, zsh and fish.
std::string completion(const CLI::App& app, const std::string& shell);
/// docs/settings.md: the table of settings.
std::string settings_document();

} // namespace pertev
