#include "apps/cli/help.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/cli/setting_flags.h"
#include "base/error.h"

namespace pertev {
namespace {

constexpr std::size_t kColumns = 80, kTextColumn = 27;
constexpr const char* kOwnGroup = "Options";  // CLI11's name of the group of flags that are no settings
constexpr const char* kSettings = "Settings"; // heading of a short help

std::string small_letters(std::string text) {
    std::ranges::transform(text, text.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
    return text;
}

/// Breaks a text between words into lines of at most `width`, each behind `indent` spaces but the first.
std::string wrapped(const std::string& text, std::size_t width, std::size_t indent) {
    std::string lines, line;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find_first_of(" \n", at), text.size());
        const std::string word = text.substr(at, end - at);
        at = end + 1;
        if (!line.empty() && line.size() + 1 + word.size() > width) {
            lines += line + '\n' + std::string(indent, ' ');
            line.clear();
        }
        line += (line.empty() ? "" : " ") + word;
    }
    return lines + line;
}

/// Returns an option's names and value as help shows them: "-o,--output FILE".
std::string names_of(const CLI::Option& option) {
    std::string name = shown_names(option);
    const bool is_flag = option.get_items_expected_max() == 0;
    if (!is_flag && !option.get_type_name().empty()) name += ' ' + option.get_type_name();
    return name;
}

/// Begins a text with a capital letter and ends it with a full stop, which comes before a default in parentheses.
std::string as_sentence(std::string text) {
    if (text.empty()) return text;
    if (text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
    if (text.ends_with('.')) return text;
    std::size_t at = text.ends_with(')') ? text.rfind('(') : text.size();
    while (at > 0 && at < text.size() && (text[at - 1] == ' ' || text[at - 1] == '\n')) --at;
    return text.insert(std::min(at, text.size()), ".");
}

std::string entry(const CLI::Option& option, bool is_short) {
    std::string head = "  " + names_of(option);
    head += head.size() + 3 > kTextColumn ? '\n' + std::string(kTextColumn, ' ')
                                          : std::string(kTextColumn - head.size(), ' ');
    return head + wrapped(flag_description(option, is_short), kColumns - kTextColumn, kTextColumn) + '\n';
}

bool is_rare(const CLI::Option& option) {
    const Setting* const setting = setting_of(option);
    return setting != nullptr && !setting->is_common;
}

std::vector<const CLI::Option*> flags_of(const CLI::App& verb, const std::string& group) {
    return verb.get_options([&](const CLI::Option* option) {
        return !option->get_positional() && !option->get_group().empty() &&
               (group.empty() || option->get_group() == group);
    });
}

std::vector<std::string> words_of(const CLI::App& verb) {
    std::string path;
    for (const CLI::App* app = &verb; app != nullptr; app = app->get_parent())
        path = app->get_name() + (path.empty() ? "" : " ") + path;
    return {path};
}

bool is_of_settings(const std::string& group) { return value_named<SettingGroup>(group).has_value(); }

/// Groups that have flags which a short help leaves out.
std::set<std::string> groups_with_more(const CLI::App& verb) {
    std::set<std::string> groups;
    for (const CLI::Option* option : flags_of(verb, "")) {
        if (is_rare(*option)) groups.insert(small_letters(option->get_group()));
    }
    return groups;
}

} // namespace

std::string shown_names(const CLI::Option& option) {
    if (option.get_positional() || option.get_snames().empty()) return option.get_name(option.get_positional());
    return "-" + option.get_snames().front() + (option.get_lnames().empty() ? "" : "," + option.get_name());
}

std::string flag_description(const CLI::Option& option, bool is_short) {
    const Setting* const setting = setting_of(option);
    std::string text = as_sentence(option.get_description());
    if (setting != nullptr && is_short) text = text.substr(0, std::min(text.find(". "), text.size() - 1)) + ".";
    if (setting != nullptr && !is_short && *setting->more != '\0') text += fmt::format(" {}", setting->more);
    std::string otherwise = option.get_default_str();
    if (otherwise.starts_with('[') && otherwise.ends_with(']')) // CLI11's brackets of a list
        otherwise = otherwise.substr(1, otherwise.size() - 2);
    if (!otherwise.empty()) text += fmt::format(" ({})", otherwise);
    return option.get_required() ? text + " Required." : text;
}

std::string Help::make_help(const CLI::App* verb, std::string, CLI::AppFormatMode) const {
    const std::vector<const CLI::App*> verbs = verb->get_subcommands([](const CLI::App*) { return true; });
    const std::string path = words_of(*verb).front();
    std::string text = wrapped(verb->get_description(), kColumns, 0) + "\nUsage: " + path + " [OPTIONS]";
    const auto positionals = verb->get_options([](const CLI::Option* option) { return option->get_positional(); });
    for (const CLI::Option* option : positionals) text += ' ' + option->get_name(true);
    text += verbs.empty() ? "\n" : " VERB\n";
    const bool has_all = group_.empty() || group_ == "all";
    if (has_all) {
        for (const CLI::Option* option : positionals) text += entry(*option, false);
        for (const CLI::App* below : verbs) {
            const std::string head = fmt::format("  {:<{}}", below->get_name(), kTextColumn - 2);
            text += head + wrapped(below->get_description(), kColumns - kTextColumn, kTextColumn) + '\n';
        }
    }
    std::vector<std::string> groups = verb->get_groups();
    std::ranges::stable_partition(groups, [](const std::string& group) { return group == kOwnGroup; });
    std::string heading; // heading of the last group; a short help lists all settings under one, the verb's own if they
                         // come first
    for (const std::string& group : groups) {
        if (group.empty() || !(has_all || small_letters(group) == group_)) continue;
        std::string entries;
        for (const CLI::Option* option : flags_of(*verb, group)) {
            if (!group_.empty() || !is_rare(*option)) entries += entry(*option, group_.empty());
        }
        if (entries.empty()) continue;
        const std::string own = group_.empty() && is_of_settings(group) ? std::string(kSettings) : group;
        const bool is_joined = own == kSettings && (heading == kSettings || heading == kOwnGroup);
        if (!is_joined) text += (heading = own) + ":\n";
        text += entries;
    }
    const std::set<std::string> more = groups_with_more(*verb);
    if (group_.empty() && !more.empty()) {
        text +=
            wrapped(fmt::format("{} --help GROUP shows more: {}, or all.", path, fmt::join(more, ", ")), kColumns, 0) +
            '\n';
    }
    return text;
}

std::string take_help_group(std::vector<std::string>& words) {
    const auto help =
        std::ranges::find_if(words, [](const std::string& word) { return word == "--help" || word == "-h"; });
    if (help == words.end() || help + 1 == words.end() || help[1].starts_with('-')) return "";
    std::set<std::string> groups = {"all"};
    for (const auto& [group, name] : kSettingGroups) groups.insert(small_letters(std::string(name)));
    const std::string group = small_letters(help[1]);
    if (!groups.contains(group)) {
        if (help == words.begin()) return ""; // a verb, for example
        throw Error(ErrorCode::BadInput, "help", help[1],
                    fmt::format("no such group; there are {}", fmt::join(groups, ", ")));
    }
    words.erase(help + 1);
    return group;
}

} // namespace pertev
