#pragma once

// Angles in degrees for people. Not every angle in radians has degrees that convert back to the same bits, so they are
// searched for.

#include <bit>
#include <cstdint>
#include <initializer_list>

#include "math/scalar.h"

namespace pertev {

inline constexpr float kRadiansPerDegree = kPi / 180.0f;

/// Returns degrees in (0, 360) that choose_camera() converts to `radians`, to the bit if there are such.
inline float degrees_for(float radians) {
    const float near = radians * (180 / kPi);
    const auto bits = std::bit_cast<uint32_t>(near); // adding or subtracting one gives the adjacent floats
    for (uint32_t i = 0; i < 16; ++i) {
        for (const uint32_t candidate : {bits - i, bits + i}) {
            const auto degrees = std::bit_cast<float>(candidate);
            if (degrees * kRadiansPerDegree == radians) return degrees;
        }
    }
    return near;
}

} // namespace pertev
