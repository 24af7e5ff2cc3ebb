#pragma once

// Lists the lights of a scene that have a position, for build_light_tree.

#include <span>

#include "scene/scene.h"
#include "shading/build_light_set.h"
#include "shading/light_tree/build_light_tree.h"

namespace pertev {

/// Returns the lights in the order of their numbers: triangles, then punctual lights. `data` has both, in a world with
/// its origin at `centre`. Two or more instances of one mesh and material share a subtree if it has 64 triangles or
/// more and they are not stretched. The powers in W are those of all triangles, and of punctual lights with a position.
TreeLights list_tree_lights(const Scene& scene, Vec3 centre, const LightSetData& data,
                            std::span<const double> of_triangles, std::span<const double> of_punctual);

} // namespace pertev
