#pragma once

// Validates a kd-tree for traversal.

#include <optional>
#include <string>

#include "accel/kd_tree/kd_tree.h"

namespace pertev {

/// Returns the fault, if any. In a valid tree every node is reached exactly once and no deeper than the
/// stated depth. Planes lie within their cells, so that the cells tile the bounds. Each leaf has its own references,
/// to triangles that reach into its cell, none twice. Each of 28 points of every triangle, corners included, lies in
/// the cell of a leaf that lists the triangle.
std::optional<std::string> find_fault(const KdTree& tree);

} // namespace pertev
