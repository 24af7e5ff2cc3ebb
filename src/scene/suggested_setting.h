#pragma once

// Names of the settings that a scene's file suggests (Scene::suggested). A setting for the pictures of one camera has
// the camera's name after it: size@left.

#include <string>
#include <string_view>

namespace pertev {

struct SuggestedFor {
    std::string_view setting;
    std::string_view camera; // empty: all cameras
};

/// Splits a name; the names of settings have no @.
inline SuggestedFor parts_of_suggested(std::string_view name) {
    const std::size_t at = name.find('@');
    if (at == std::string_view::npos) return {name, {}};
    return {name.substr(0, at), name.substr(at + 1)};
}

inline std::string suggested_for_camera(std::string_view setting, std::string_view camera) {
    return std::string(setting) + "@" + std::string(camera);
}

} // namespace pertev
