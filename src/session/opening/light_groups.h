#pragma once

// Light groups: a layer for the light of some lights, in any number of scatterings. A group is the light-path
// expression L<names>.*E, so groups that share out all lights add up to the picture.

#include <span>
#include <string>

#include "render/light_paths/light_path_expression.h"
#include "scene/scene.h"

namespace pertev {

/// Parses NAME=LIGHT,LIGHT,..., or NAME=^LIGHT,... for all other lights. LIGHT is a name as in light-path expressions
/// (scene/names.h), where `\,` stands for a comma. Throws Error(BadInput).
LightPathExpression parse_light_group(const std::string& text);

/// Throws Error(BadInput), with the closest name, if a group names a light that the scene does not have.
void check_light_groups(std::span<const std::string> groups, const Scene& scene);

} // namespace pertev
