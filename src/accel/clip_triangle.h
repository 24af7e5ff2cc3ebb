#pragma once

// The bounds of what a cell sees of a triangle: what makes the splits of a kd-tree perfect.
//
// Source: Sutherland, Hodgman, "Reentrant Polygon Clipping", 1974; its use for kd-trees: Havran, Bittner, "On Improving
// KD-Trees for Ray Shooting", 2002.
// Why no part is lost: it is cut in double, where the roundings of all six cuts together stay below 2^-46 of the
// largest coordinate. The cell is grown by `slack` first, 2^-44 of it, and the result by as much again before it is
// rounded outwards, so the triangle's part in the closed cell lies in the box returned.

#include "accel/bvh/bvh.h"
#include "math/bounds3.h"

namespace pertev {

/// What clip_triangle grows a cell by, for a tree whose largest |coordinate| is `max_abs`.
inline double clip_slack(float max_abs) { return 0x1p-44 * static_cast<double>(max_abs); }

inline Bounds3 bounds_of(const BvhTriangle& t) { return {min(t.a, min(t.b, t.c)), max(t.a, max(t.b, t.c))}; }

/// A box within `cell` and the triangle's bounds that holds all of the triangle that lies in the closed cell; empty
/// where nothing does.
Bounds3 clip_triangle(const BvhTriangle& triangle, const Bounds3& cell, double slack);

} // namespace pertev
