#pragma once

// Triangulates any polygon by ear clipping in the plane of its Newell normal, as in O'Rourke, "Computational Geometry
// in C", 2nd edition, section 1.4. The work is bounded: a polygon that needs too many tests (or crosses itself, so
// that no ear is found) becomes a fan.

#include <cstdint>
#include <span>
#include <vector>

#include "math/vec3.h"

namespace pertev {

/// Appends 3 (n - 2) numbers in [0, n), corners of `polygon`, to `triangles`, with the polygon's orientation. Fewer
/// than 3 corners give nothing. A convex polygon becomes a fan around its first corner, and so does one with corners
/// that are not finite.
void triangulate_polygon(std::span<const Vec3> polygon, std::vector<uint32_t>& triangles);

} // namespace pertev
