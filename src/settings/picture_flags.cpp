#include "settings/picture_flags.h"

#include <algorithm>

#include "base/shell_word.h"
#include "settings/settings_file.h"

namespace pertev {

std::string flag_of(std::string_view setting) {
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
        if ((setting.verbs & kRender) == 0 || setting.group == SettingGroup::Camera) continue;
        const std::vector<std::string> texts = texts_of(options, setting);
        const bool is_of_view = (view + ' ').find(flag_of(setting.name) + ' ') != std::string::npos;
        if (!is_of_view && is_written(options, setting) && texts != texts_of({}, setting)) {
            flags += flags_of(setting, texts);
        }
    }
    return flags + view;
}

} // namespace pertev
