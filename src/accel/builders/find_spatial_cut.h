#pragma once

// Finds the plane at which splitting triangles costs least, among those between equal bins along each axis.
//
// Source: Stich, Friedrich, Dietrich, "Spatial Splits in Bounding Volume Hierarchies", HPG 2009, section 4.1. The
// parts of a triangle in bins are computed in float without a margin. They only decide where to split; no box of the
// tree is made from them.

#include <span>
#include <vector>

#include "accel/bvh/build_tree.h"
#include "accel/bvh/bvh.h"

namespace pertev {

struct SpatialCut {
    float cost = kInfinity; // sum of half area times count over both sides; infinite if no plane is usable
    int axis = 0;
    float plane = 0;
    Bounds3 left, right; // boxes of the parts on either side, as the bins have them
    uint64_t left_size = 0, right_size = 0;
};

/// Finds the cheapest spatial cut of a set. `chunks` hold its references, by position, to parts of `triangles` that lie
/// in `box`; they are processed in parallel. A cut that splits more than `allowance` of them is not considered.
SpatialCut find_spatial_cut(std::span<const std::span<const BuildReference>> chunks,
                            const std::vector<BvhTriangle>& triangles, const Bounds3& box, uint64_t allowance);

} // namespace pertev
