#pragma once

// Builds the tree over a set of triangles: a mesh in its local space, or a scene's baked triangles in world space.

#include <vector>

#include "accel/bvh/build_tree.h"
#include "accel/bvh/bvh.h"

namespace pertev {

/// Builds the tree over `triangles`, which it reorders and whose kLastInLeaf flags it sets. Vertices are finite,
/// |coordinate| <= kMaxCoordinate. The result does not depend on the number of threads.
Bvh build_bvh(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings = {});

/// Builds the tree alone, the first half of build_bvh; the cache stores its result.
BuiltTree build_triangle_tree(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings);
/// Orders the triangles by the tree, the second half of build_bvh. tree.order lists the position of each triangle, more
/// than once if it is split. `sink` may end it.
Bvh make_bvh(BuiltTree tree, const std::vector<BvhTriangle>& triangles, Sink& sink = nobody());

/// Box of each triangle, with its position as id. No coordinate is -0.
std::vector<BuildReference> references_of(const std::vector<BvhTriangle>& triangles);

} // namespace pertev
