#pragma once

// Finds how next-event estimation divides its samples between near lights (emissive surfaces, point and spot lights)
// and far ones (directional lights, the environment). Powers do not suffice: a sky does not light a closed room, and
// a torch hardly lights a field.

#include "render/prepare_scene.h"

namespace pertev {

/// Balances near and far lights: if a scene has both kinds, sets their shares of `prepared.lights` to those with the
/// least relative variance of the light, shadows included, at points on the surfaces. Each kind gets at least
/// kMinShare. The trees of `prepared` must be built. The result depends only on the scene and is the same on every
/// machine.
void balance_lights(PreparedScene& prepared, const float* linear_from_srgb);

inline constexpr double kMinShare = 1.0 / 32;

} // namespace pertev
