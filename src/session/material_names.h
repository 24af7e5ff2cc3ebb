#pragma once

// Names of materials in messages and changes.

#include <cstddef>
#include <span>
#include <string>

#include "scene/scene.h"

namespace pertev {

/// Returns the name of a material, or its number if it has none.
std::string name_of_material(const Scene& scene, std::size_t index);

/// Returns the names of some materials for a message: "'a', 'b' and 3 more".
std::string names_of_materials(const Scene& scene, std::span<const std::size_t> indices);

} // namespace pertev
