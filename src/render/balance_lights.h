#pragma once

// How near lights (emissive surfaces, point and spot lights) and far ones (directional lights, the environment) share
// the draws of next-event estimation. Powers cannot tell: a sky lights a closed room not at all, a torch a field
// hardly.

#include "render/prepare_scene.h"

namespace pertev {

/// Where there are both kinds, sets their shares of `prepared.lights` to those with the least relative variance of the
/// light that arrives, shadows included, at points spread over the surfaces; neither gets under kLeastShare. The trees
/// of `prepared` are built. A function of the scene alone: the same numbers on every machine.
void balance_lights(PreparedScene& prepared, const float* linear_from_srgb);

inline constexpr double kLeastShare = 1.0 / 32;

} // namespace pertev
