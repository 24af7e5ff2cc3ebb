#pragma once

// The plane across one axis at which cutting triangles in two costs least, out of those between equal bins.
//
// Source: Stich, Friedrich, Dietrich, "Spatial Splits in Bounding Volume Hierarchies", HPG 2009, section 4.1.

#include <span>
#include <vector>

#include "accel/bvh/build_tree.h"
#include "accel/bvh/bvh.h"

namespace pertev {

struct SpatialCut {
    float cost = kInfinity; // sum of half area times count over both sides; infinite: no plane will do
    float plane = 0;
    Bounds3 left, right; // of the parts on either side, as the bins see it
    uint64_t left_size = 0, right_size = 0;
};

/// `references` are parts of `triangles`, by position, and lie in `box`. At most `allowance` of them are cut.
SpatialCut find_spatial_cut(std::span<const BuildReference> references, const std::vector<BvhTriangle>& triangles,
                            const Bounds3& box, int axis, uint64_t allowance);

} // namespace pertev
