#include "apps/cli/describe_usage_error.h"

#include <algorithm>
#include <cctype>
#include <span>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "apps/cli/flag_phrases.h"
#include "settings/parse_values.h"

namespace pertev {
namespace {

std::string plain(std::string_view name) {
    std::string text(name.substr(std::min(name.find_first_not_of('-'), name.size())));
    for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c == '_' ? '-' : c;
    return text;
}

/// Letters to change, add, take away or swap with their neighbour (optimal string alignment).
std::size_t distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        before.swap(last);
        last.swap(row);
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
            const bool is_swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
            if (is_swapped) row[j] = std::min(row[j], before[j - 2] + 1);
        }
    }
    return row[b.size()];
}

bool has_word(std::string_view name, std::string_view word) {
    return ('-' + std::string(name) + '-').find('-' + std::string(word) + '-') != std::string::npos;
}

/// The one of `names` that is nearest to `name`; empty if none is near. Near means one letter in three wrong,
/// missing, added or swapped with its neighbour, the beginning of a name, or one of its words (`--depth`,
/// `--max-depth`). Case, leading dashes, and - versus _ are ignored. Among equally near names, one with the same
/// first letter is preferred, then the first.
std::string suggest_name(std::string_view name, std::span<const std::string> names) {
    const std::string wanted = plain(name);
    std::string best;
    if (wanted.empty()) return "";
    const std::size_t most = std::max<std::size_t>(wanted.size() / 3, wanted.size() > 1 ? 1 : 0);
    std::size_t least = 2 * most + 2;
    for (const std::string& known : names) {
        const std::string candidate = plain(known);
        if (candidate.empty()) continue;
        const bool is_part = wanted.size() > 2 && (candidate.starts_with(wanted) || has_word(candidate, wanted));
        std::size_t far = distance(wanted, candidate);
        if (candidate.size() == 1 && far > 0) continue; // one letter is near to everything short
        if (is_part) far = std::min<std::size_t>(far, 1);
        if (far > most) continue;
        const std::size_t score =
            2 * far + (candidate.front() == wanted.front() ? 0 : 1); // first letters are seldom wrong
        if (score < least) {
            least = score;
            best = known;
        }
    }
    return best;
}

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
