#include "apps/viewer/picture_flags.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/shell_word.h"
#include "settings/settings_file.h"

namespace pertev {

std::string picture_flags(const PictureOptions& options, const std::string& view) {
    std::string flags;
    for (const Setting& setting : all_settings()) {
        if ((setting.verbs & kRender) == 0 || setting.group == std::string_view("Camera")) continue;
        std::string flag = fmt::format("--{} ", setting.name);
        std::ranges::replace(flag, '_', '-');
        const std::vector<std::string> texts = texts_of(options, setting);
        const bool is_of_view = (view + ' ').find(flag) != std::string::npos;
        if (is_of_view || !is_written(options, setting) || texts == texts_of({}, setting)) continue;
        for (const std::string& text : texts) flags += flag + (is_switch(setting) ? "" : shell_word(text) + ' ');
    }
    return flags + view;
}

} // namespace pertev
