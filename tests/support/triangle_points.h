#pragma once

// Fixed points of a triangle, for checkers of structures that clip triangles: a lattice of 28 points that includes
// corners and edges. Its code is independent of the clipping.

#include "accel/bvh/bvh.h"

namespace pertev {

inline constexpr int kTrianglePoints = 28;

struct TrianglePoint {
    double at[3];
};

/// Returns point k of the lattice with 7 points per side, exact up to a few roundings of a double.
inline TrianglePoint triangle_point(const BvhTriangle& t, int k) {
    int row = 0;
    while (k > row) k -= ++row; // row r has r + 1 points
    const double b = (row - k) / 6.0, c = k / 6.0, a = (6 - row) / 6.0;
    const auto mix = [&](float x, float y, float z) {
        return a * static_cast<double>(x) + b * static_cast<double>(y) + c * static_cast<double>(z);
    };
    return {{mix(t.a.x, t.b.x, t.c.x), mix(t.a.y, t.b.y, t.c.y), mix(t.a.z, t.b.z, t.c.z)}};
}

} // namespace pertev
