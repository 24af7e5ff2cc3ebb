#pragma once

// The plane at which cutting triangles in two costs least, out of those between equal bins along each axis.
//
// Source: Stich, Friedrich, Dietrich, "Spatial Splits in Bounding Volume Hierarchies", HPG 2009, section 4.1. What the
// bins hold of a triangle is computed in float without a margin: it decides where to cut, and no box of the tree is
// made of it.

#include <span>
#include <vector>

#include "accel/bvh/build_tree.h"
#include "accel/bvh/bvh.h"

namespace pertev {

struct SpatialCut {
    float cost = kInfinity; // sum of half area times count over both sides; infinite: no plane will do
    int axis = 0;
    float plane = 0;
    Bounds3 left, right; // of the parts on either side, as the bins see it
    uint64_t left_size = 0, right_size = 0;
};

/// `chunks` hold parts of `triangles`, named by position, that lie in `box`; they are looked at at once. At most
/// `allowance` of them are cut.
SpatialCut find_spatial_cut(std::span<const std::span<const BuildReference>> chunks,
                            const std::vector<BvhTriangle>& triangles, const Bounds3& box, uint64_t allowance);

} // namespace pertev
