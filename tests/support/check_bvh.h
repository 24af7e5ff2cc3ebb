#pragma once

// Validates binary trees for traversal.

#include <optional>
#include <string>
#include <vector>

#include "accel/bvh/bvh.h"

namespace pertev {

/// Checks links as find_broken_link does, and that every box holds its contents.
std::optional<std::string> find_fault(const Bvh& bvh);

/// Checks a tree over `mesh` with split triangles: links and depth as find_broken_link does, boxes within their
/// parents', no foreign triangle, none missing, and each covered by the boxes of the leaves that hold it. Coverage is
/// tested at the corners and on a lattice that is finer if more leaves hold the triangle, up to rounding in double.
std::optional<std::string> find_split_fault(const Bvh& bvh, const std::vector<BvhTriangle>& mesh);

} // namespace pertev
