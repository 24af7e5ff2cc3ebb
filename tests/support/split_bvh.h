#pragma once

// A tree with spatial splits (Stich, Friedrich, Dietrich, HPG 2009) in the simplest form: each node cuts its cell in
// the middle, and a triangle whose box reaches into both halves lies in both. Boxes are the cells, so hits on a
// triangle lie outside of all but one of the leaves that hold it.

#include <vector>

#include "accel/bvh/bvh.h"

namespace pertev::test {

/// A tree with at most `max_depth` levels, and with 4 triangles per leaf if the levels suffice.
Bvh build_split_bvh(const std::vector<BvhTriangle>& triangles, int max_depth);

} // namespace pertev::test
