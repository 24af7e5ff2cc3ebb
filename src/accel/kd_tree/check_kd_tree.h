#pragma once

// Checks a kd-tree: what its walk relies on. Used by tests, and by the laboratory before it times anything.

#include <optional>
#include <string>

#include "accel/kd_tree/kd_tree.h"

namespace pertev {

/// Nothing when the tree is sound; else what is wrong. Sound: every node is reached exactly once and no deeper than
/// stated; planes lie within their cells, so that the cells tile the bounds; each leaf has its own references, of
/// triangles that reach into its cell, none twice; and each of 28 points of every triangle, corners among them, lies in
/// the cell of a leaf that lists the triangle.
std::optional<std::string> find_fault(const KdTree& tree);

} // namespace pertev
