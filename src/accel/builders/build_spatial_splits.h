#pragma once

// The spatial-split tree before its leaves are chosen, for builders that continue from it.

#include "accel/builders/binary_tree.h"
#include "accel/builders/builders.h"

namespace pertev {

/// Builds a tree with one reference per leaf and nodes in depth-first order. The box of a split triangle holds only a
/// part of it. `triangles` is not empty. Throws Error(OverLimit).
BinaryTree build_spatial_split_tree(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings,
                                    const SpatialSplitSettings& splits = {});

} // namespace pertev
