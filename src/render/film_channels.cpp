#include "render/film_channels.h"

#include <bit>

#include "base/error.h"

namespace pertev {

const AovGroup& aov_group(AovBits aov) {
    const auto index = static_cast<uint32_t>(std::countr_zero(static_cast<uint32_t>(aov)));
    PERTEV_CHECK(index < film_channels::kGroups);
    return kAovTable[index];
}

std::vector<std::string> channel_names(const AovGroup& group) {
    std::vector<std::string> names;
    for (const char* name : group.channels) {
        if (name != nullptr) names.emplace_back(name);
    }
    return names;
}

std::optional<AovBits> aov_named(std::string_view name) {
    for (const AovGroup& group : kAovTable) {
        if (name == group.name) return group.bit;
    }
    return std::nullopt;
}

std::vector<std::string> aov_names(uint32_t aovs) {
    std::vector<std::string> names;
    for (const AovGroup& group : kAovTable)
        if ((aovs & group.bit) != 0) names.emplace_back(group.name);
    return names;
}

} // namespace pertev
