#pragma once

// Boxes of positions that indices name, for whoever has no mesh yet or wants them quickly.

#include <cstddef>
#include <cstdint>
#include <span>

#include "math/double_bounds3.h"

namespace pertev {

/// Box of those positions that indices name, all of which are in range. By several threads.
Bounds3 bounds_of(std::span<const Vec3> positions, std::span<const uint32_t> indices);

/// Every so many of a file's corners are looked at first.
inline constexpr std::size_t kCornersApart = 61;
/// Whether origin_for() (scene/scene_origin.h) leaves every box where it is that holds the points of `sample`, and
/// perhaps others: the middle of such a box is at most 1.5 of its sides from any of these.
inline bool surely_stays(const Bounds3& sample) {
    return !sample.is_empty() && 62 * max_component(sample.size()) >= sample.max_abs();
}

/// `box` in double; what is infinite in it becomes the largest float.
DoubleBounds3 double_box_of(const Bounds3& box);

} // namespace pertev
