#pragma once

// Checks a tree: what every walk relies on. Used by tests, and on every tree that comes from a file.

#include <optional>
#include <string>

#include "accel/bvh/bvh.h"

namespace pertev {

/// Whether walking the tree stays within its arrays and within a stack of kMaxBvhDepth: every link in range, every node
/// and triangle reached exactly once, the depth as stated. Nothing when it is sound; else what is wrong.
std::optional<std::string> find_broken_link(const Bvh& bvh);

/// The same, and that every box holds what is beneath it.
std::optional<std::string> find_fault(const Bvh& bvh);

} // namespace pertev
