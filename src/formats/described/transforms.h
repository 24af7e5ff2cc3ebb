#pragma once

// Transforms of the statements of scene files, in double.

#include <span>

#include "math/double_transform.h"

namespace pertev::described {

/// Returns the determinant of the linear part.
double determinant(const DoubleTransform& m);
/// Returns the inverse; of a singular map numbers that are not finite.
DoubleTransform inverse(const DoubleTransform& m);
bool is_finite(const DoubleTransform& m);

DoubleTransform translation_by(DoubleVec3 t);
DoubleTransform scale_by(DoubleVec3 s);
/// Returns the rotation by an angle around an axis of any length above 0.
DoubleTransform make_rotation(double degrees, DoubleVec3 axis);
/// Returns the map from the world to a camera that looks along its +z, with +x to the right and +y up.
DoubleTransform make_look_at(DoubleVec3 eye, DoubleVec3 target, DoubleVec3 up);
/// Returns the map of 16 numbers, column by column of points as columns; the last row is taken as (0, 0, 0, 1).
DoubleTransform transform_of(std::span<const double> numbers);

} // namespace pertev::described
