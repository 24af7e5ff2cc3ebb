#pragma once

// Validates wide, compressed and linked trees for traversal.

#include <optional>
#include <string>

#include "accel/bvh/compressed_bvh.h"
#include "accel/bvh/skip_bvh.h"
#include "accel/bvh/wide_bvh.h"

namespace pertev {

/// Checks that links and counts are valid, each node and triangle is reached once, the depth is correct and every box
/// contains its contents. Returns the fault, if any. `clipped` means a tree with spatial splits, in which a
/// leaf's box holds only a part of each of its triangles.
template <int kWidth>
std::optional<std::string> find_fault(const WideBvh<kWidth>& bvh, bool clipped = false);

/// Checks that links are valid, each node and triangle is reached once, the depth is correct, and every decoded box,
/// in exact arithmetic, contains every triangle below it. Returns the fault, if any. `clipped` means a tree with
/// spatial splits, whose boxes need only overlap the triangles below.
std::optional<std::string> find_fault(const CompressedBvh& bvh, bool clipped = false);

/// Returns whether the decoded box of a slot holds a box, in exact arithmetic.
bool holds(const CompressedBvhNode& node, int slot, const Bounds3& box);

/// Checks for links that lead backwards or out of the tree, boxes that do not contain their contents, and triangles
/// that are not reached exactly once. Returns the fault, if any. `boxes_hold_triangles` is false for trees with spatial
/// splits, whose leaves have clipped boxes.
std::optional<std::string> find_fault(const SkipBvh& bvh, bool boxes_hold_triangles = true);

} // namespace pertev
