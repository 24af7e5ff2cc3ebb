#pragma once

// Validates the links of trees that are read from files.

#include <optional>
#include <string>

#include "accel/bvh/bvh.h"
#include "base/sink.h"

namespace pertev {

/// Checks that traversal stays within the arrays and within a stack of kMaxBvhDepth: every link in range, every node
/// and triangle reached exactly once, the depth correct. Returns the first fault, or nothing. `sink`
/// may end it.
std::optional<std::string> find_broken_link(const Bvh& bvh, Sink& sink = nobody());

} // namespace pertev
