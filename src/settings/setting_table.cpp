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

uint32_t integrators_that(bool (*has)(IntegratorKind)) {
    uint32_t bits = 0;
    for (const IntegratorDescriptor& integrator : integrators()) {
        if (has(integrator.value)) bits |= 1u << static_cast<uint32_t>(integrator.value);
    }
    return bits;
}

} // namespace pertev
