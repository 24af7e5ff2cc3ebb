#include "apps/cli/setting_flags.h"

#include <algorithm>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/cli/flag_checks.h"
#include "settings/settings_file.h"

namespace pertev {
namespace {

std::string described(const Setting& setting) {
    std::string text = setting.sentence;
    const std::vector<std::string> choices = choices_of(setting);
    if (!choices.empty() && std::string_view(setting.form).find('|') == std::string_view::npos) {
        text += fmt::format(" One of {}.", fmt::join(choices, ", "));
    }
    return text;
}

/// Returns the letter and all names of a setting's flag, such as "--traversal,--walk". Help and documents show only the
/// first name, and not the letter.
std::string flag_names(const Setting& setting) {
    const std::string letter = *setting.letter != '\0' ? fmt::format("-{},", setting.letter) : "";
    return letter + flag_of(setting.name) + (*setting.old_name != '\0' ? "," + flag_of(setting.old_name) : "");
}

} // namespace

const Setting* setting_of(const CLI::Option& flag) {
    std::string name = flag.get_lnames().empty() ? "" : flag.get_lnames().front();
    std::ranges::replace(name, '-', '_');
    const Setting* const setting = find_setting(name);
    return setting != nullptr && flag.get_group() == name_of(setting->group) ? setting : nullptr;
}

void SettingFlags::add(CLI::App& verb, uint32_t verbs, const PictureOptions& options, std::span<const Setting> table,
                       const std::map<std::string_view, std::string>& own) {
    const PictureOptions defaults;
    verbs_ = verbs;
    for (const Setting& setting : table) {
        if ((setting.verbs & verbs) == 0) continue;
        Flag& flag = flags_.emplace_back(Flag{.setting = &setting});
        const std::vector<std::string> now = texts_of(options, setting);
        const auto said = own.find(setting.name);
        const std::string otherwise = said != own.end()                    ? said->second
                                      : now == texts_of(defaults, setting) ? setting.otherwise
                                                                           : "";
        const std::string name = flag_names(setting), text = described(setting);
        if (is_switch(setting)) {
            flag.option = verb.add_flag(name, flag.is_on, text);
        } else if (is_list(setting)) {
            flag.option = verb.add_option(name, flag.texts, text)->allow_extra_args(false);
            if (std::string_view(setting.form).ends_with(",...")) flag.option->delimiter(',');
        } else {
            flag.option = verb.add_option(name, flag.text, text);
        }
        flag.option->group(std::string(name_of(setting.group)));
        flag.option->default_str(otherwise);
        if (is_switch(setting)) continue;
        flag.option->type_name(setting.form); // set_value checks the text
        if (otherwise.empty() && !is_list(setting) && !now.empty()) flag.option->default_str(now.front());
    }
}

void SettingFlags::add_file(CLI::App& verb) {
    verb.add_option("--settings", file_, "A file of settings (info X.exr --settings); flags overrule it.")
        ->type_name("FILE")
        ->check(file_name());
}

void SettingFlags::read(PictureOptions& options, Sink& sink) const {
    combine_settings(
        file_, verbs_, [&](PictureOptions& others) { read_flags(others); }, options, sink);
}

void SettingFlags::read_flags(PictureOptions& options) const {
    for (const Flag& flag : flags_) {
        if (flag.option->count() == 0) continue;
        const Setting& setting = *flag.setting;
        const std::vector<std::string> texts = is_switch(setting)
                                                   ? std::vector<std::string>{flag.is_on ? "true" : "false"}
                                               : is_list(setting) ? flag.texts
                                                                  : std::vector{flag.text};
        set_value(options, setting, texts);
    }
}

} // namespace pertev
