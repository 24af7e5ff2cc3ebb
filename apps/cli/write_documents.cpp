// Writes the man page, shell completion and docs/settings.md from all flags.

#include <algorithm>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/cli/help.h"
#include "apps/cli/setting_flags.h"
#include "base/error.h"
#include "base/version.h"
#include "settings/check_settings.h"
#include "settings/parse_values.h"

namespace pertev {
namespace {

struct VerbWords {
    std::string path; // "bench rays"; empty: pertev itself
    const CLI::App* app;
};

std::vector<VerbWords> all_verbs(const CLI::App& app, const std::string& path = "") {
    std::vector<VerbWords> verbs = {{path, &app}};
    for (const CLI::App* below : app.get_subcommands([](const CLI::App*) { return true; })) {
        const std::vector<VerbWords> more =
            all_verbs(*below, path.empty() ? below->get_name() : path + ' ' + below->get_name());
        verbs.insert(verbs.end(), more.begin(), more.end());
    }
    return verbs;
}

std::vector<const CLI::Option*> all_flags_of(const CLI::App& verb) {
    return verb.get_options([](const CLI::Option* option) { return !option->get_positional(); });
}

std::vector<std::string> long_names(const CLI::App& verb) {
    std::vector<std::string> names;
    for (const CLI::Option* flag : all_flags_of(verb)) {
        if (!flag->get_lnames().empty()) names.push_back("--" + flag->get_lnames().front());
    }
    return names;
}

std::vector<std::string> verbs_below(const CLI::App& verb) {
    std::vector<std::string> names;
    for (const CLI::App* below : verb.get_subcommands([](const CLI::App*) { return true; }))
        names.push_back(below->get_name());
    return names;
}

/// Escapes what troff would take for more than text.
std::string in_man(std::string text) {
    for (std::size_t at = 0; (at = text.find_first_of("\\-", at)) != std::string::npos; at += 2)
        text.insert(at, 1, '\\');
    std::ranges::replace(text, '\n', ' ');
    return text.starts_with('.') || text.starts_with('\'') ? "\\&" + text : text;
}

/// The words of a verb, as a pattern of a shell's case.
std::string pattern_of(const std::string& path) { return fmt::format("\"{}\")", path); }

constexpr const char* kBash = R"bash(# Completion of pertev for bash: eval "$(pertev --completion bash)"
_pertev() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} verb= i words=
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case "${verb:+$verb }${COMP_WORDS[i]}" in
      @PATHS@) verb="${verb:+$verb }${COMP_WORDS[i]}" ;;
    esac
  done
  case "$before" in
@VALUES@    *) case "$verb" in
@VERBS@    esac ;;
  esac
  COMPREPLY=($(compgen -W "$words" -- "$word"))
  [[ $word == -* || ${#COMPREPLY[@]} -gt 0 ]] || COMPREPLY=($(compgen -f -- "$word"))
}
complete -o filenames -F _pertev pertev
)bash";

constexpr const char* kFish = R"fish(# Completion of pertev for fish: pertev --completion fish | source
function __pertev_verb_is
  set -l verb ''
  for word in (commandline -opc)[2..-1]
    set -l longer (string trim -- "$verb $word")
    contains -- "$longer" @PATHS@; and set verb "$longer"
  end
  test "$verb" = "$argv[1]"
end
)fish";

/// The words of all verbs, quoted.
std::string paths_of(const CLI::App& app, const char* separator) {
    std::string paths;
    for (const VerbWords& verb : all_verbs(app)) {
        if (!verb.path.empty()) paths += fmt::format("{}\"{}\"", paths.empty() ? "" : separator, verb.path);
    }
    return paths;
}

void replace_mark(std::string& script, std::string_view mark, const std::string& text) {
    script.replace(script.find(mark), mark.size(), text);
}

std::string bash_completion(const CLI::App& app) {
    std::string values, verbs;
    for (const VerbWords& verb : all_verbs(app)) {
        std::vector<std::string> words = long_names(*verb.app);
        const std::vector<std::string> below = verbs_below(*verb.app);
        words.insert(words.end(), below.begin(), below.end());
        verbs += fmt::format("    {} words=\"{}\" ;;\n", pattern_of(verb.path), fmt::join(words, " "));
    }
    for (const Setting& setting : all_settings()) {
        const std::vector<std::string> choices = choices_of(setting);
        if (!choices.empty())
            values += fmt::format("    {}) words=\"{}\" ;;\n", flag_of(setting.name), fmt::join(choices, " "));
    }
    std::string script = kBash;
    replace_mark(script, "@PATHS@", paths_of(app, "|"));
    replace_mark(script, "@VALUES@", values);
    replace_mark(script, "@VERBS@", verbs);
    return script;
}

std::string fish_completion(const CLI::App& app) {
    std::string script = kFish;
    replace_mark(script, "@PATHS@", paths_of(app, " "));
    for (const VerbWords& verb : all_verbs(app)) {
        const std::string condition = fmt::format("__pertev_verb_is \"{}\"", verb.path);
        for (const std::string& below : verbs_below(*verb.app)) {
            script += fmt::format("complete -c pertev -n '{}' -a {}\n", condition, below);
        }
        for (const CLI::Option* flag : all_flags_of(*verb.app)) {
            if (flag->get_lnames().empty()) continue;
            const Setting* const setting = setting_of(*flag);
            const std::vector<std::string> choices =
                setting != nullptr ? choices_of(*setting) : std::vector<std::string>();
            script += fmt::format("complete -c pertev -n '{}' -l {}{}\n", condition, flag->get_lnames().front(),
                                  choices.empty() ? "" : fmt::format(" -xa '{}'", fmt::join(choices, " ")));
        }
    }
    return script;
}

std::string verbs_with(const Setting& setting) {
    std::string names;
    for (const auto& [bit, verb] : kVerbNames) {
        if ((setting.verbs & bit) == 0) continue;
        if (verb.starts_with("bench ") && names.find("bench ") != std::string::npos) {
            names += fmt::format("/{}", verb.substr(6)); // bench noise/frames/sequence
        } else {
            names += fmt::format("{}{}", names.empty() ? "" : ", ", verb);
        }
    }
    return names;
}

/// The verbs that most settings of a group belong to.
std::string common_verbs(SettingGroup group) {
    std::map<std::string, int> counts;
    for (const Setting& setting : all_settings()) {
        if (group == setting.group) ++counts[verbs_with(setting)];
    }
    return std::ranges::max_element(counts, {}, &std::pair<const std::string, int>::second)->first;
}

/// The integrators of a group's settings, as bits, if these are the same ones and not all.
uint32_t common_integrators(SettingGroup group) {
    std::optional<uint32_t> common;
    for (const Setting& setting : all_settings()) {
        if (group == setting.group && common.value_or(setting.integrators) != setting.integrators) return 0;
        if (group == setting.group) common = setting.integrators;
    }
    return common.value_or(0);
}

std::string range_of(const Setting& setting) {
    const std::vector<std::string> choices = choices_of(setting);
    if (!choices.empty()) return fmt::format("{}{}", setting.is_by_ray ? "[KIND=]" : "", fmt::join(choices, ", "));
    const bool has_range = setting.high > 0 || setting.low != 0 || setting.above;
    if (!has_range) return setting.form;
    const std::string low = (setting.above ? "above " : "from ") + limit_text(setting.low);
    return setting.high > 0 ? fmt::format("{} to {}", low, limit_text(setting.high)) : low;
}

std::string default_of(const Setting& setting) {
    if (*setting.otherwise != '\0') return setting.otherwise;
    const std::vector<std::string> texts = texts_of({}, setting);
    return is_switch(setting) ? "off" : fmt::format("{}", fmt::join(texts, ", "));
}

/// Names the integrators that have the setting, or some of its values.
std::string integrators_text(const Setting& setting) {
    const std::string_view values = setting.integrators_of;
    const bool is_other = values.starts_with('!');
    return fmt::format(" Integrators{}{}: {}.",
                       values.empty() ? ""
                       : is_other     ? " with other values than "
                                      : " with ",
                       values.substr(is_other ? 1 : 0), fmt::join(integrators_with(setting), ", "));
}

/// Escapes text for a Markdown cell.
std::string cell(std::string text) {
    for (std::size_t at = 0; (at = text.find_first_of("|*<", at)) != std::string::npos; at += 2)
        text.insert(at, 1, '\\');
    return text;
}

} // namespace

std::string man_page(const CLI::App& app) {
    std::string page = fmt::format(
        ".TH PERTEV 1 \"\" \"pertev {}\"\n.SH NAME\npertev \\- {}\n.SH SYNOPSIS\n.B pertev\nVERB [OPTIONS]\n",
        version(), in_man(app.get_description()));
    for (const VerbWords& verb : all_verbs(app)) {
        page += fmt::format(".SH {}\n{}\n", verb.path.empty() ? "OPTIONS" : in_man("pertev " + verb.path),
                            in_man(verb.app->get_description()));
        for (const CLI::Option* option : verb.app->get_options([](const CLI::Option*) { return true; })) {
            page += fmt::format(".TP\n\\fB{}\\fR \\fI{}\\fR\n{}\n", in_man(shown_names(*option)),
                                in_man(option->get_type_name()), in_man(flag_description(*option, false)));
        }
    }
    return page + ".SH EXIT STATUS\n0 done, 2 bad input, 3 over a limit, 4 out of memory, 5 a device's fault, 6 a file "
                  "that could not be\n"
                  "written, 75 interrupted\n";
}

std::string completion(const CLI::App& app, const std::string& shell) {
    if (shell != "bash" && shell != "zsh" && shell != "fish") {
        throw Error(ErrorCode::BadInput, "completion", shell, "expected bash, zsh or fish");
    }
    if (shell == "fish") return fish_completion(app);
    const std::string bash = bash_completion(app);
    return shell == "zsh" ? "autoload -U +X bashcompinit && bashcompinit\n" + bash : bash;
}

std::string settings_document() {
    std::string text =
        "# Settings\n\n"
        "`pertev --settings-document` makes this file from the table of settings (`src/settings/`); a test compares "
        "them.\n\n"
        "A setting has one name: `max_depth` in C++, in JSON and in a picture's metadata "
        "(`pertev.max_depth`), `--max-depth` on\n"
        "the command line. A scene's file suggests some settings (its camera, its size); `--settings "
        "FILE` overrules it, and flags\n"
        "overrule both. `pertev info PICTURE.exr` says where each came from, `pertev info SCENE` what the file "
        "suggests,\n"
        "and `pertev info PICTURE.exr --settings` prints a file of settings with which `pertev render "
        "SCENE --settings FILE` makes the\nsame picture. "
        "Such a file is `{\"version\":1,\"scene\":{\"name\":...,\"hash\":...},\"settings\":{...}}`. "
        "Unknown entries are\n"
        "left out with a warning, and `--strict` refuses them. Settings marked \"not kept\" belong to the machine "
        "and the run, and\n"
        "are not stored there. \"Not with: A,B:fov\" is a rule for the values A and B, \"!A:fov\" for all "
        "others.\n";
    std::optional<SettingGroup> group;
    std::string verbs;
    for (const Setting& setting : all_settings()) {
        if (group != setting.group) {
            group = setting.group;
            verbs = common_verbs(*group);
            const uint32_t all_of = common_integrators(*group);
            text += fmt::format("\n## {}\n\nVerbs of most rows: {}.{}\n\n"
                                "| setting | values | default | |\n|---|---|---|---|\n",
                                name_of(*group), verbs, all_of != 0 ? integrators_text(setting) : "");
        }
        std::string says = setting.sentence;
        if (*setting.more != '\0') says += fmt::format(" {}", setting.more);
        if (setting.integrators != 0 && common_integrators(setting.group) == 0) says += integrators_text(setting);
        if (!setting.needs.empty())
            says += fmt::format(" Needs{}: {}.", setting.needs.find(' ') != setting.needs.npos ? " one of" : "",
                                setting.needs);
        if (!setting.excludes.empty()) says += fmt::format(" Not with: {}.", setting.excludes);
        if (verbs_with(setting) != verbs) says += fmt::format(" Verbs: {}.", verbs_with(setting));
        if (!setting.is_kept) says += " Not kept.";
        const std::string range = cell(range_of(setting));
        text += fmt::format("| `{}` | {}{}{} | {} | {} |\n", flag_of(setting.name), range,
                            range.empty() || *setting.unit == '\0' ? "" : " ", setting.unit, cell(default_of(setting)),
                            cell(says));
    }
    return text;
}

} // namespace pertev
