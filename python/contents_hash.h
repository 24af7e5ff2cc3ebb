#pragma once

// The hash of a scene without a file.

#include <string>

#include "scene/scene.h"

namespace pertev {

/// Returns the hash of all that a scene of arrays has: geometry, materials with their textures, instances, lights,
/// cameras, the environment, names.
std::string hash_of_contents(const Scene& scene);

} // namespace pertev
