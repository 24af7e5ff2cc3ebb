#pragma once

// Transforms as sixteen numbers, row by row, in the coordinates of the file.

#include <span>
#include <vector>

#include "math/double_transform.h"

namespace pertev {

/// Returns the transform relative to `origin`, which is subtracted in double. The last row counts as 0, 0, 0, 1.
inline Transform transform_of(std::span<const double> rows, DoubleVec3 origin) {
    const auto row = [&](std::size_t i) { return DoubleVec3{rows[4 * i], rows[4 * i + 1], rows[4 * i + 2]}; };
    return to_float(DoubleTransform{row(0), row(1), row(2), DoubleVec3{rows[3], rows[7], rows[11]} - origin});
}

inline std::vector<double> values_of(const Transform& transform, DoubleVec3 origin) {
    const auto [x, y, z, t] = to_double(transform);
    const DoubleVec3 at = t + origin;
    return {x.x, x.y, x.z, at.x, y.x, y.y, y.z, at.y, z.x, z.y, z.z, at.z, 0, 0, 0, 1};
}

} // namespace pertev
