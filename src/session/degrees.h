#pragma once

// Angles as people say them, in degrees. What holds radians has not always degrees that lead back to the same bits,
// unless these are looked for.

#include <bit>
#include <cstdint>
#include <initializer_list>

#include "math/scalar.h"

namespace pertev {

inline constexpr float kRadiansPerDegree = kPi / 180.0f;

/// Returns the degrees, in (0, 360), that choose_camera() makes `radians` of, to the bit where there are such.
inline float degrees_for(float radians) {
    const float near = radians * (180 / kPi);
    const auto bits = std::bit_cast<uint32_t>(near); // those of the next floats are one more and one less
    for (uint32_t i = 0; i < 16; ++i) {
        for (const uint32_t candidate : {bits - i, bits + i}) {
            const auto degrees = std::bit_cast<float>(candidate);
            if (degrees * kRadiansPerDegree == radians) return degrees;
        }
    }
    return near;
}

} // namespace pertev
