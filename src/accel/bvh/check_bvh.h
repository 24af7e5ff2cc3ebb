#pragma once

// Checks a tree: what every walk relies on. Used by tests, and on every tree that comes from a file.

#include <optional>
#include <string>
#include <vector>

#include "accel/bvh/bvh.h"

namespace pertev {

/// Whether walking the tree stays within its arrays and within a stack of kMaxBvhDepth: every link in range, every node
/// and triangle reached exactly once, the depth as stated. Nothing when it is sound; else what is wrong.
std::optional<std::string> find_broken_link(const Bvh& bvh);

/// The same, and that every box holds what is beneath it.
std::optional<std::string> find_fault(const Bvh& bvh);

/// For a tree over `mesh` that may hold a triangle more than once, in boxes that hold but a part of it: links and depth
/// as above, boxes within their parents', no triangle that is not the mesh's, none of the mesh's left out, and each
/// covered by the boxes of the leaves that hold it. That is tried at its corners and on a lattice of points that is
/// finer where the triangle is in more leaves; in exact arithmetic but for rounding in double.
std::optional<std::string> find_split_fault(const Bvh& bvh, const std::vector<BvhTriangle>& mesh);

} // namespace pertev
