#pragma once

// What things of a scene are called by whoever names them: on the command line, in light-path expressions.

#include <string>
#include <string_view>
#include <vector>

#include "scene/scene.h"

namespace pertev {

/// The name of the scene's environment.
inline constexpr const char* kEnvironmentName = "environment";

using Names = std::vector<std::string_view>;

/// Of an object: its own name, its mesh's, its material's, and those of all nodes above it. They live as long as the
/// scene does.
Names names_of(const Scene& scene, const Instance& instance);
/// Of a point, spot or directional light: its own name and those of the nodes above it.
Names names_of(const Scene& scene, const Light& light);

/// Whether `pattern` stands for all of `name`: * for any letters, ? for one, \ takes the next as it is.
bool matches_name(std::string_view pattern, std::string_view name);
bool has_name(const Names& names, std::string_view pattern);

/// A few of the names that there are, for a message: "there are 'a', 'b', ...".
std::string some_names(const std::vector<Names>& things);

} // namespace pertev
