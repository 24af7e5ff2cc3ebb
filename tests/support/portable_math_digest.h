#pragma once

// One number per function of portable_math.h or scalar.h and 32-bit input, on host and device. A sum or hash of these
// over all 2^32 inputs shows whether two compilers or devices compute the same function.

#include <cstdint>

#include "base/host_device.h"
#include "math/portable_math.h"

namespace pertev::test {

inline constexpr int kPortableFunctionCount = 17;

HD inline const char* portable_function_name(int function) {
    switch (function) {
    case 0:
        return "sin";
    case 1:
        return "cos";
    case 2:
        return "tan";
    case 3:
        return "asin";
    case 4:
        return "acos";
    case 5:
        return "atan";
    case 6:
        return "exp";
    case 7:
        return "exp2";
    case 8:
        return "log";
    case 9:
        return "log2";
    case 10:
        return "sin_cos, sine";
    case 11:
        return "sin_cos, cosine";
    case 12:
        return "sin_cos_2pi, sine";
    case 13:
        return "sin_cos_2pi, cosine";
    case 14:
        return "pow";
    case 15:
        return "atan2";
    case 16:
        return "reciprocal_of_normal";
    }
    return "";
}

/// Returns the second argument for functions of two: another float of similar size for every fourth input, arbitrary
/// bits otherwise.
HD inline float portable_second_argument(uint32_t input) {
    uint32_t h = input * 0x9e3779b1u;
    h = (h ^ (h >> 15)) * 0x85ebca77u;
    h ^= h >> 13;
    if ((h & 3) != 0) return float_of(h * 0xc2b2ae3du);
    return float_of((h & 0x80ffffffu) + 0x3f000000u); // +-[0.5, 2^1.99]
}

/// Returns whether reciprocal_of_normal accepts x; for other inputs its value counts as 0.
HD inline bool has_reciprocal(float x) { return abs(x) >= 0x1p-126f && abs(x) < 0x1p126f; }

/// Returns the bits of function(input as a float). sin_cos_2pi takes the input as a fraction of 2^32; its results are
/// in
/// [-1, 1]. The functions of two arguments take portable_second_argument() as the second.
HD inline uint32_t portable_math_value(int function, uint32_t input) {
    const float x = float_of(input);
    float s = 0, c = 0;
    switch (function) {
    case 0:
        return bits_of(sin(x));
    case 1:
        return bits_of(cos(x));
    case 2:
        return bits_of(tan(x));
    case 3:
        return bits_of(asin(x));
    case 4:
        return bits_of(acos(x));
    case 5:
        return bits_of(atan(x));
    case 6:
        return bits_of(exp(x));
    case 7:
        return bits_of(exp2(x));
    case 8:
        return bits_of(log(x));
    case 9:
        return bits_of(log2(x));
    case 10:
        sin_cos(x, s, c);
        return bits_of(s);
    case 11:
        sin_cos(x, s, c);
        return bits_of(c);
    case 12:
        sin_cos_2pi(static_cast<float>(input) * 0x1p-32f, s, c);
        return bits_of(s);
    case 13:
        sin_cos_2pi(static_cast<float>(input) * 0x1p-32f, s, c);
        return bits_of(c);
    case 14:
        return bits_of(pow(x, portable_second_argument(input)));
    case 15:
        return bits_of(atan2(x, portable_second_argument(input)));
    case 16:
        return has_reciprocal(x) ? bits_of(reciprocal_of_normal(x)) : 0;
    }
    return 0;
}

/// A sum that depends on every value but not on their order, so it can be computed over any split of the inputs.
HD inline uint64_t portable_math_term(uint32_t input, uint32_t value) {
    uint64_t h = (static_cast<uint64_t>(input) << 32 | value) * 0x9e3779b97f4a7c15u;
    h = (h ^ (h >> 29)) * 0xbf58476d1ce4e5b9u;
    return h ^ (h >> 32);
}

} // namespace pertev::test
