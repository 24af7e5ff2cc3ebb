#pragma once

// Cuts a polygon of any shape into triangles by ear clipping in the plane of its Newell normal, as O'Rourke,
// "Computational Geometry in C", 2nd edition, section 1.4 has it. The work is bounded: a polygon that takes too many
// tests (or crosses itself, so that no ear is found) ends as a fan.

#include <cstdint>
#include <span>
#include <vector>

#include "math/vec3.h"

namespace pertev {

/// Appends 3 (n - 2) numbers in [0, n), corners of `polygon`, to `triangles`, each triangle in the polygon's own sense
/// of rotation. Fewer than 3 corners give nothing. A convex polygon is a fan about its first corner. Corners need not
/// be finite: then too it is a fan.
void triangulate_polygon(std::span<const Vec3> polygon, std::vector<uint32_t>& triangles);

} // namespace pertev
