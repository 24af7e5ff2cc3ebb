#pragma once

// Refits a tree to moved triangles: links, leaves and their order stay, and boxes are recomputed. That takes a small
// part of the build time. The tree stays good while neighbouring triangles stay near each other; sah_cost measures
// it.
//
// Source: van den Bergen, "Efficient Collision Detection of Complex Deformable Models using AABB Trees", JGT 1997.

#include <optional>
#include <string>
#include <vector>

#include "accel/builders/builders.h"
#include "accel/bvh/build_tree.h"
#include "accel/bvh/bvh.h"

namespace pertev {

/// Returns why trees of this builder cannot be refitted; nothing if they can.
std::optional<std::string> why_no_refit(BvhBuilder builder);

/// Updates the boxes of a tree whose triangles have moved. `triangles` are those that the tree was built over, in the
/// same order, each instance's primitives from 0 up, with other vertices: finite, |coordinate| <= kMaxCoordinate. A
/// triangle that the tree holds several times gets its whole box each time, which is correct but slow. The result does
/// not depend on the number of threads. Throws Error(BadInput) if the triangles are others.
Bvh refit_bvh(const Bvh& bvh, const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings = {});

} // namespace pertev
