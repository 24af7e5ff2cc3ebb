#pragma once

// The coordinates that a mapping gives to a point of the file's world.

#include "formats/described/texture_mapping.h"

namespace pertev::described {

/// Coordinates of a point by pbrt's formulas, whose t points up.
struct Coordinates {
    double s = 0, t = 0;
    bool is_on_axis = false; // the angle around the axis is not defined
};

/// Returns the coordinate that goes around the axis, for which 0 and 1 are one place. A plane has none.
double Coordinates::*around_of(MappingKind kind);

Coordinates coordinates_at(const TextureMapping& by, DoubleVec3 world);

} // namespace pertev::described
