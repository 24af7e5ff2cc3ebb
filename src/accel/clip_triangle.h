#pragma once

// Bounds of the part of a triangle inside a cell; perfect splits of a kd-tree need them.
//
// Source: Sutherland, Hodgman, "Reentrant Polygon Clipping", 1974; its use for kd-trees: Havran, Bittner, "On Improving
// KD-Trees for Ray Shooting", 2002.
// Why no part is lost: it is cut in double, where the roundings of all six cuts together stay below 2^-46 of the
// largest coordinate. The cell is grown by `slack` first, 2^-44 of it, and the result by as much again before it is
// rounded outwards, so the triangle's part in the closed cell lies in the box returned.

#include "accel/bvh/bvh.h"
#include "math/bounds3.h"

namespace pertev {

/// Amount, in metres, by which clip_triangle grows a cell, for a tree whose largest |coordinate| is `max_abs`.
inline double clip_slack(float max_abs) { return 0x1p-44 * static_cast<double>(max_abs); }

inline Bounds3 bounds_of(const BvhTriangle& t) { return {min(t.a, min(t.b, t.c)), max(t.a, max(t.b, t.c))}; }

/// Returns a box within `cell` and the triangle's bounds that holds the whole part of the triangle in the closed
/// cell; an empty box if there is none.
Bounds3 clip_triangle(const BvhTriangle& triangle, const Bounds3& cell, double slack);

} // namespace pertev
