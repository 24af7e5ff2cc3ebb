#include "session/writing/metadata_json.h"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <type_traits>

#include "base/json_text.h"
#include "settings/setting_table.h"

namespace pertev {
namespace {

/// Entries that are lists of numbers and no settings.
constexpr std::string_view kLists[] = {"pertev.world_from_camera", "pertev.position_origin"};

/// Returns whether the text may be a list of numbers. Others may look like one by chance, such as a camera's name.
bool may_be_list(std::string_view name) {
    constexpr std::string_view kPrefix = "pertev.";
    const Setting* const setting = name.starts_with(kPrefix) ? find_setting(name.substr(kPrefix.size())) : nullptr;
    if (setting == nullptr) return std::ranges::find(kLists, name) != std::end(kLists);
    return is_vector(*setting) || setting->may_be_numbers;
}

} // namespace

std::string metadata_json(const ExrMetadata::value_type& entry) {
    const std::string& name = entry.first;
    return std::visit(
        [&](const auto& value) {
            if constexpr (std::is_same_v<std::decay_t<decltype(value)>, std::string>) {
                const std::optional<std::string> list = may_be_list(name) ? json_vector(value) : std::nullopt;
                return list ? *list : json_string(value);
            } else {
                return json_number(static_cast<double>(value));
            }
        },
        entry.second);
}

} // namespace pertev
