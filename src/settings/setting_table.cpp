#include "settings/setting_table.h"

#include <algorithm>

#include "base/error.h"

namespace pertev {

const std::vector<Setting>& all_settings() {
    static const std::vector<Setting> all = [] {
        std::vector<Setting> rows;
        for (const auto& part : {scene_settings(), picture_settings(), integrator_settings(), frame_settings()}) {
            rows.insert(rows.end(), part.begin(), part.end());
        }
        for (const IntegratorDescriptor& integrator : integrators()) {
            for (const std::string& name : words_of(integrator.settings)) {
                const auto own =
                    std::ranges::find(rows, name, [](const Setting& s) { return std::string_view(s.name); });
                PERTEV_CHECK(own != rows.end());
                own->integrators |= 1u << static_cast<uint32_t>(integrator.value);
            }
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
