#include "apps/cli/describe_usage_error.h"

#include <algorithm>
#include <cctype>
#include <vector>

#include <fmt/format.h>

#include "apps/cli/flag_phrases.h"
#include "apps/cli/suggest_name.h"
#include "settings/parse_values.h"

namespace pertev {
namespace {

/// Returns the app, its verb and that verb's own verbs, as far as the line names them.
std::vector<const CLI::App*> verbs_of(const CLI::App& app) {
    std::vector<const CLI::App*> verbs = {&app};
    while (!verbs.back()->get_subcommands().empty()) verbs.push_back(verbs.back()->get_subcommands().front());
    return verbs;
}

/// Returns the flags of `verb`, such as "--output" and "-o".
std::vector<std::string> flags_of(const CLI::App& verb) {
    std::vector<std::string> names;
    for (const CLI::Option* option : verb.get_options()) {
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
        for (const std::string& name : option->get_snames()) names.push_back("-" + name);
    }
    return names;
}

std::vector<std::string> names_below(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
        names.push_back(verb->get_name());
    }
    return names;
}

std::string did_you_mean(const std::string& name) {
    return name.empty() ? "" : fmt::format(" (did you mean {}?)", name);
}

/// Returns whether a word is a flag; a number such as "-.5,1,2" is none.
bool is_flag(const std::string& word) {
    return word.size() > 1 && word[0] == '-' && (word[1] == '-' || std::isalpha(static_cast<unsigned char>(word[1])));
}

/// Describes a flag that the i-th of `verbs` does not have.
std::string describe_flag(const std::string& word, const std::vector<const CLI::App*>& verbs, std::size_t i) {
    const std::string flag = word.substr(0, word.find('='));
    for (std::size_t later = i + 1; later < verbs.size(); ++later) {
        const std::vector<std::string> flags = flags_of(*verbs[later]);
        if (std::ranges::find(flags, flag) != flags.end()) {
            return fmt::format("{0} is a flag of {1} and must come after that name", flag, verbs[later]->get_name());
        }
    }
    return fmt::format("{}: no such flag{}", flag, did_you_mean(suggest_name(flag, flags_of(*verbs[i]))));
}

bool takes(const CLI::App& verb, const char* flag) { return verb.get_option_no_throw(flag) != nullptr; }

/// Lists unexpected arguments of `verb`, each with suggestions.
std::string describe_words(const std::vector<std::string>& words, const CLI::App& verb) {
    std::string text = fmt::format("{}: not understood", fmt::join(words, ", "));
    const std::string meant = suggest_name(words.front(), names_below(verb));
    if (!meant.empty()) return text + did_you_mean(meant);
    if (std::ranges::all_of(words, [](const std::string& word) { return number_in(word).has_value(); })) {
        return text + "; components of a vector are joined by commas: 1,2,3";
    }
    if (takes(verb, "SCENE") && takes(verb, "--output")) {
        return text + "; only one SCENE is accepted, and each picture needs its own -o";
    }
    return takes(verb, "--scene") ? text + "; scenes are named by --scene" : text;
}

/// The words of the line that no verb accepts, in order; empty if there are none. Words that are no flags are listed
/// only if there is no unknown flag, because they may be values of that.
std::string describe_strangers(const std::vector<const CLI::App*>& verbs) {
    std::vector<std::string> flags, words;
    const CLI::App* verb_at = verbs.front(); // verb of the first word
    for (std::size_t i = 0; i < verbs.size(); ++i) {
        for (const std::string& word : verbs[i]->remaining()) {
            if (is_flag(word)) {
                flags.push_back(describe_flag(word, verbs, i));
            } else {
                if (words.empty()) verb_at = verbs[i];
                words.push_back(word);
            }
        }
    }
    if (verbs.size() == 1 && !words.empty())
        return describe_words({words.front()}, *verb_at); // a verb with its own words
    if (flags.empty() && !words.empty()) return describe_words(words, *verb_at);
    return fmt::format("{}", fmt::join(flags, "; "));
}

/// Names a flag that is repeated and accepted only once; empty if there is none.
std::string describe_repetition(const CLI::App& verb) {
    for (const CLI::Option* flag : verb.get_options()) {
        const int most = std::max(flag->get_items_expected_max(), 1);
        if (flag->get_multi_option_policy() == CLI::MultiOptionPolicy::Throw && int(flag->count()) > most) {
            return fmt::format("{}: given {} times; it is accepted once", flag->get_name(), flag->count());
        }
    }
    return "";
}

} // namespace

namespace {

/// Returns the text "--spp: why" as a remark about the setting `spp`, if that has this flag; else the text alone.
Remark by_setting(const std::string& text) {
    const std::size_t end = std::min(text.find(": "), text.size());
    const std::string flag = text.substr(0, end);
    std::string setting = flag.substr(std::min<std::size_t>(flag.size(), 2));
    std::ranges::replace(setting, '-', '_');
    return end < text.size() && shown_flag(setting) == flag ? Remark(setting, "", text.substr(end + 2)) : text;
}

} // namespace

UsageError describe_usage_error(const CLI::App& app, const CLI::ParseError& error) {
    const std::vector<const CLI::App*> verbs = verbs_of(app);
    std::vector<std::string> path;
    for (const CLI::App* verb : verbs) path.push_back(verb->get_name());
    std::string text = describe_strangers(verbs);
    if (verbs.size() == 1) { // the line names no known verb
        text += fmt::format("{}a verb is required: {}", text.empty() ? "" : "; ", fmt::join(names_below(app), ", "));
    }
    if (text.empty()) text = describe_repetition(*verbs.back());
    if (text.empty()) text = error.what();
    return {by_setting(text), fmt::format("{} --help", fmt::join(path, " "))};
}

} // namespace pertev
