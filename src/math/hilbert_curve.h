#pragma once

// Position of a point on Hilbert's curve through a cube: neighbours on the curve are neighbours in space, so an even
// split of the curve splits the points into compact parts.
//
// Source: Skilling, "Programming the Hilbert curve", AIP Conference Proceedings 707, 2004.

#include <array>
#include <cstdint>

#include "math/bounds3.h"

namespace pertev {

/// Position on the curve, 30 bits, of a cell of the cube with 2^10 cells per side.
inline uint32_t hilbert_position(std::array<uint32_t, 3> cell) {
    constexpr uint32_t top = 1u << 9;
    for (uint32_t q = top; q > 1; q >>= 1) { // undoes the rotations of each level
        const uint32_t p = q - 1;
        for (uint32_t& c : cell) {
            if ((c & q) != 0) {
                cell[0] ^= p;
            } else {
                const uint32_t t = (cell[0] ^ c) & p;
                cell[0] ^= t;
                c ^= t;
            }
        }
    }
    cell[1] ^= cell[0]; // Gray code
    cell[2] ^= cell[1];
    uint32_t t = 0;
    for (uint32_t q = top; q > 1; q >>= 1) {
        if ((cell[2] & q) != 0) t ^= q - 1;
    }
    uint32_t position = 0;
    for (uint32_t bit = 10; bit-- > 0;) {
        for (const uint32_t c : cell) position = position << 1 | ((c ^ t) >> bit & 1);
    }
    return position;
}

/// Position of `point` on the curve through the cube around `bounds`, whose longest side is the cube's.
inline uint32_t hilbert_position(Vec3 point, const Bounds3& bounds) {
    const float side = max_component(bounds.size());
    const float scale = side > 0 ? 1024.0f / side : 0.0f;
    const Vec3 cell = scale * (point - bounds.lo);
    const auto index = [](float x) { return static_cast<uint32_t>(to_int(x, 0, 1023)); };
    return hilbert_position({index(cell.x), index(cell.y), index(cell.z)});
}

} // namespace pertev
