#pragma once

// Skies by formula, 256 x 128 pixels. A white surface that faces upwards sends about 1.5 W/(sr m2) under either.

#include "scene/light.h"

namespace pertev {

/// Radiance of the studio's floor: all directions that lie more than 6 degrees below the horizon, W/(sr m2).
inline constexpr Rgb kStudioFloor = {0.52f, 0.51f, 0.50f};

/// A photographer's studio: a large soft box to the upper left front, a tall one to the right, a wide one behind, and
/// grey walls that darken upwards. All edges are soft, so its light is drawn with little noise.
Environment make_studio();

/// Blue above, with a broad warm sun to the upper left front. Recorded figures of `bench` and `lab` were measured under
/// it, so it stays as it is.
Environment make_clear_sky();

} // namespace pertev
