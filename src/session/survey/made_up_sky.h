#pragma once

// Skies by formula, 256 x 128 pixels. A white surface that faces upwards sends 1.2 or 1.3 W/(sr m2) under either.

#include "scene/light.h"

namespace pertev {

/// Radiance of the studio's floor: all directions that lie more than 6 degrees below the horizon, W/(sr m2).
inline constexpr Rgb kStudioFloor = {0.49f, 0.48f, 0.47f};

/// Radiance of a white surface that faces up in the studio.
inline constexpr Rgb kStudioWhite = {1.275f, 1.289f, 1.308f};

/// A photographer's studio: a bright soft box to the upper left front, a tall one to the right, a wide one behind,
/// before pale walls, over a grey floor. Their edges are soft.
Environment make_studio();

/// Blue above, with a broad warm sun to the upper left front: for rooms that are open to it. Recorded figures of
/// `bench` and `lab` were measured under it, so it stays as it is.
Environment make_clear_sky();

} // namespace pertev
