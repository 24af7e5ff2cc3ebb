#pragma once

// Boxes of positions that indices name, for whoever has no mesh yet or wants them quickly.

#include <cstdint>
#include <span>

#include "math/double_bounds3.h"

namespace pertev {

/// Box of those positions that indices name, all of which are in range. By several threads.
Bounds3 bounds_of(std::span<const Vec3> positions, std::span<const uint32_t> indices);

/// `box` in double; what is infinite in it becomes the largest float.
DoubleBounds3 double_box_of(const Bounds3& box);

} // namespace pertev
