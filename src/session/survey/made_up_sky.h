#pragma once

// Generated skies of 256 x 128 pixels. A white surface that faces up sends 1.2 or 1.3 W/(sr m2) under either.

#include "scene/light.h"

namespace pertev {

/// Radiance of the studio's floor, in all directions more than 6 degrees below the horizon, W/(sr m2).
inline constexpr Rgb kStudioFloor = {0.49f, 0.48f, 0.47f};

/// Radiance of a white surface that faces up in the studio.
inline constexpr Rgb kStudioWhite = {1.275f, 1.289f, 1.308f};

/// Makes a photographer's studio: a bright soft box to the upper left front, a tall one to the right, a wide one
/// behind, in front of pale walls, above a grey floor.
Environment make_studio();

/// Makes a blue sky with a broad warm sun to the upper left front, for rooms that are open to it. Recorded figures of
/// `bench` and `lab` were measured under it, so it must not change.
Environment make_clear_sky();

} // namespace pertev
