#pragma once

// Names of a scene's lights, which light-path expressions and light groups choose among.

#include <vector>

#include "scene/names.h"

namespace pertev {

/// Returns the names of all lights: of instances that emit, without names for others, then of Scene::lights, then of
/// the environment. They live as long as the scene.
std::vector<Names> names_of_lights(const Scene& scene);

} // namespace pertev
