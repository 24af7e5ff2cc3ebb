#pragma once

// Names of a scene's objects, as users refer to them on the command line and in light-path expressions.

#include <string>
#include <string_view>
#include <vector>

#include "scene/scene.h"

namespace pertev {

/// The name of the scene's environment.
inline constexpr const char* kEnvironmentName = "environment";

using Names = std::vector<std::string_view>;

/// Names of an object: its own, its mesh's, its material's, and those of all ancestor nodes. They live as long as the
/// scene.
Names names_of(const Scene& scene, const Instance& instance);
/// Names of a point, spot or directional light: its own and those of its ancestor nodes.
Names names_of(const Scene& scene, const Light& light);

/// Returns whether `pattern` matches all of `name`: * matches any letters, ? one letter, and \ quotes the next letter.
bool matches_name(std::string_view pattern, std::string_view name);
bool has_name(const Names& names, std::string_view pattern);

/// Some of the existing names, for a message: "there are 'a', 'b', ...".
std::string some_names(const std::vector<Names>& things);

} // namespace pertev
