#pragma once

// Builds the tree over a set of triangles: a mesh in its local space, or the baked ones of a scene in world space.

#include <vector>

#include "accel/bvh/build_tree.h"
#include "accel/bvh/bvh.h"

namespace pertev {

/// The tree over `triangles`, which it reorders; sets and clears kLastInLeaf in their flags. Vertices are finite,
/// |coordinate| <= kMaxCoordinate. The same for any number of threads.
Bvh build_bvh(std::vector<BvhTriangle> triangles, const BvhBuildSettings& settings = {});

} // namespace pertev
