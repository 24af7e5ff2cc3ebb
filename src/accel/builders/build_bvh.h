#pragma once

// Builds the tree over a set of triangles: a mesh in its local space, or the baked ones of a scene in world space.

#include <vector>

#include "accel/bvh/build_tree.h"
#include "accel/bvh/bvh.h"

namespace pertev {

/// The tree over `triangles`, reordered, kLastInLeaf set and cleared in their flags. Vertices are finite,
/// |coordinate| <= kMaxCoordinate. The same for any number of threads.
Bvh build_bvh(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings = {});

/// The two halves of build_bvh, which the cache steps between.
BuiltTree build_triangle_tree(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings);
/// tree.order has each of the triangles' positions, that of one that is cut more than once.
Bvh make_bvh(BuiltTree tree, const std::vector<BvhTriangle>& triangles);

/// The box of each triangle, ids by position. No coordinate is -0.
std::vector<BuildReference> references_of(const std::vector<BvhTriangle>& triangles);

} // namespace pertev
