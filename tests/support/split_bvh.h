#pragma once

// A tree with spatial splits (Stich, Friedrich, Dietrich, HPG 2009) in the simplest form: each node halves its cell,
// and a triangle whose box overlaps both halves is in both. Boxes are the cells, so a hit on a triangle lies outside
// all but one of the leaves that contain it.

#include <vector>

#include "accel/bvh/bvh.h"

namespace pertev::test {

/// A tree with at most `max_depth` levels, and with 4 triangles per leaf if the levels suffice.
Bvh build_split_bvh(const std::vector<BvhTriangle>& triangles, int max_depth);

} // namespace pertev::test
