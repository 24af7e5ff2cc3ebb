#include "settings/setting_table.h"

#include <algorithm>

namespace pertev {

const std::vector<Setting>& all_settings() {
    static const std::vector<Setting> all = [] {
        std::vector<Setting> rows;
        for (const auto& part : {scene_settings(), picture_settings(), integrator_settings(), frame_settings()}) {
            rows.insert(rows.end(), part.begin(), part.end());
        }
        return rows;
    }();
    return all;
}

const Setting* find_setting(std::string_view name) {
    const auto found = std::ranges::find_if(all_settings(), [&](const Setting& setting) {
        return name == setting.name || (!name.empty() && name == setting.old_name);
    });
    return found != all_settings().end() ? &*found : nullptr;
}

} // namespace pertev
