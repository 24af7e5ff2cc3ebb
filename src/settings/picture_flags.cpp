#include "settings/picture_flags.h"

#include <algorithm>
#include <utility>

#include "base/shell_word.h"
#include "settings/settings_file.h"

namespace pertev {
namespace {

/// Settings whose flags are not made of their names.
constexpr std::pair<std::string_view, std::string_view> kOtherFlags[] = {{"output", "-o"}, {"scene", "SCENE"}};

} // namespace

std::string flag_of(std::string_view setting) {
    for (const auto& [name, flag] : kOtherFlags) {
        if (setting == name) return std::string(flag);
    }
    std::string flag = "--" + std::string(setting);
    std::ranges::replace(flag, '_', '-');
    return flag;
}

std::string flags_of(const Setting& setting, const std::vector<std::string>& texts) {
    std::string flags;
    for (const std::string& text : texts) {
        flags += flag_of(setting.name) + (is_switch(setting) ? "" : ' ' + shell_word(text)) + ' ';
    }
    return flags;
}

std::string picture_flags(const PictureOptions& options, const std::string& view) {
    std::string flags;
    for (const Setting& setting : all_settings()) {
        if ((setting.verbs & kRender) == 0 || setting.group == std::string_view("Camera")) continue;
        const std::vector<std::string> texts = texts_of(options, setting);
        const bool is_of_view = (view + ' ').find(flag_of(setting.name) + ' ') != std::string::npos;
        if (!is_of_view && is_written(options, setting) && texts != texts_of({}, setting)) {
            flags += flags_of(setting, texts);
        }
    }
    return flags + view;
}

} // namespace pertev
