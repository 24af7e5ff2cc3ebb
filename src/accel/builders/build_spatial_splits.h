#pragma once

// The tree by spatial splits before its leaves are chosen: for builders that go on from it.

#include "accel/builders/binary_tree.h"
#include "accel/builders/builders.h"

namespace pertev {

/// One reference a leaf, nodes depth first, in boxes that hold but a part of a triangle where it was cut. `triangles`
/// are not none. Throws Error(OverLimit).
BinaryTree build_spatial_split_tree(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings,
                                    const SpatialSplitSettings& splits = {});

} // namespace pertev
