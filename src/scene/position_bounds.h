#pragma once

// Boxes of indexed positions, for use before a mesh exists or when they are needed quickly.

#include <cstddef>
#include <cstdint>
#include <span>

#include "math/double_bounds3.h"

namespace pertev {

/// Box of the positions that indices refer to, all in range. Runs on several threads.
Bounds3 bounds_of(std::span<const Vec3> positions, std::span<const uint32_t> indices);

/// Stride of the corners of a file that are sampled first.
inline constexpr std::size_t kCornersApart = 61;
/// Returns whether origin_for() (scene/scene_origin.h) returns 0 for every box that contains the points of `sample`:
/// the middle of such a box is at most 1.5 of its sides from any of these.
inline bool surely_stays(const Bounds3& sample) {
    return !sample.is_empty() && 62 * max_component(sample.size()) >= sample.max_abs();
}

/// `box` in double; infinite values become the largest float.
DoubleBounds3 double_box_of(const Bounds3& box);

} // namespace pertev
