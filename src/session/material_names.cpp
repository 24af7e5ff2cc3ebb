#include "session/material_names.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/message_text.h"

namespace pertev {

std::string name_of_material(const Scene& scene, std::size_t index) {
    const std::string& name = scene.materials[index].name;
    return name.empty() ? fmt::format("{}", index) : name;
}

std::string names_of_materials(const Scene& scene, std::span<const std::size_t> indices) {
    constexpr std::size_t kMaxShown = 4;
    const std::size_t shown = std::min(indices.size(), kMaxShown);
    std::string text;
    for (const std::size_t index : indices.first(shown)) {
        text += fmt::format("{}'{}'", text.empty() ? "" : ", ", shortened(name_of_material(scene, index)));
    }
    return indices.size() > shown ? fmt::format("{} and {} more", text, indices.size() - shown) : text;
}

} // namespace pertev
