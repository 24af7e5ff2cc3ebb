#pragma once

// How far records serve, once all of a round are there: neighbour clamping. Where a record has near walls, those near
// it cannot be much farther from them, whatever their own rays have met: by the triangle inequality a radius is at most
// a neighbour's plus the way there. Of all records at once, so no order matters.
//
// Source: Krivanek, Bouatouch, Pattanaik, Zara, "Making Radiance and Irradiance Caching Practical: Adaptive Caching and
// Neighbor Clamping", EGSR 2006, section 5.

#include <span>
#include <vector>

#include "accel/octree/point_octree.h"

namespace pertev {

/// Of spheres round records, of their own radii: the least of radius_j + distance to j over all j, themselves too.
std::vector<float> clamp_by_neighbours(std::span<const Sphere> records);

} // namespace pertev
