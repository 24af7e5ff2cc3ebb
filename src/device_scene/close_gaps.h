#pragma once

// Solids of glass or water that touch, such as water in a glass, overlap afterwards, so that no interface with air is
// between them (nest_solids.h): of two solids the later one grows where it is near the other. A gap counts as touching
// if it is below kTouching of the growing solid's size.

#include "scene/scene.h"

namespace pertev {

inline constexpr float kTouching = 1e-4f; // share of the longest side of its box

/// Moves vertices that touch an earlier solid outwards by twice the gap that counts. A mesh that other instances use,
/// too, is copied for that; meshes whose vertices move are left as they are. Returns the number of solids that grew.
uint32_t close_gaps(Scene& scene);

} // namespace pertev
