#include "session/writing/metadata_json.h"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <type_traits>

#include "base/json_text.h"

namespace pertev {
namespace {

/// Entries whose text is a list of numbers. Other texts may look like one by chance, such as the name of a camera.
constexpr std::string_view kVectors[] = {
    "pertev.eye",     "pertev.target",  "pertev.up",          "pertev.world_from_camera",
    "pertev.ambient", "pertev.shutter", "pertev.environment", "pertev.position_origin"};

} // namespace

std::string metadata_json(const ExrMetadata::value_type& entry) {
    const std::string& name = entry.first;
    return std::visit(
        [&](const auto& value) {
            if constexpr (std::is_same_v<std::decay_t<decltype(value)>, std::string>) {
                const bool is_vector = std::ranges::find(kVectors, name) != std::end(kVectors);
                const std::optional<std::string> vector = is_vector ? json_vector(value) : std::nullopt;
                return vector ? *vector : json_string(value);
            } else {
                return json_number(static_cast<double>(value));
            }
        },
        entry.second);
}

} // namespace pertev
