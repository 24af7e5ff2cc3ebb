#pragma once

// Validates an octree for traversal.

#include <optional>
#include <string>

#include "accel/octree/octree.h"

namespace pertev {

/// Returns the fault, if any. In a valid tree every node is reached exactly once and no deeper than the
/// stated depth. Cells are exact in floats and the root's holds the bounds. Each leaf has its own references, to
/// triangles that reach into its cell, none twice. Each of 28 points of every triangle, corners included, lies in the
/// cell of a leaf that lists the triangle.
std::optional<std::string> find_fault(const Octree& tree);

} // namespace pertev
