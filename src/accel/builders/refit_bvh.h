#pragma once

// A tree after its triangles have moved: links, leaves and their order stay, boxes are made anew. That takes a small
// part of the time of building, and the tree is as good as the triangles stayed near each other: sah_cost says.
//
// Source: van den Bergen, "Efficient Collision Detection of Complex Deformable Models using AABB Trees", JGT 1997.

#include <optional>
#include <string>
#include <vector>

#include "accel/builders/builders.h"
#include "accel/bvh/build_tree.h"
#include "accel/bvh/bvh.h"

namespace pertev {

/// Why trees of this builder are not refitted; nothing when they are.
std::optional<std::string> why_no_refit(BvhBuilder builder);

/// `triangles` are those that the tree was built over, in the same order, each instance's primitives from 0 up, with
/// other corners: finite, |coordinate| <= kMaxCoordinate. A triangle that the tree holds more than once gets its whole
/// box in each place: sound, and slow. The same for any number of threads. Throws Error(BadInput) where the triangles
/// are others.
Bvh refit_bvh(const Bvh& bvh, const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings = {});

} // namespace pertev
