#pragma once

// asin, acos, atan, atan2 of portable_math.h. Angles in radians.

#include "base/host_device.h"
#include "math/portable_exp_log.h"
#include "math/scalar.h"

namespace pertev {

namespace portable {

// pi/2 as a sum of two floats.
inline constexpr float kHalfPi = 0x1.921fb6p0f, kHalfPiLow = -0x1.777a5cp-25f;

/// asin(x) - x for |x| <= 0.5, where square = x * x.
HD inline float asin_tail(float x, float square) {
    const float p = polynomial(square, 0x1.595c8cp-5f, 0x1.8c3e2ap-6f, 0x1.747bbap-5f, 0x1.330204p-4f, 0x1.5555c8p-3f);
    return p * (x * square);
}

/// atan(x) - x for |x| <= 1.
HD inline float atan_tail(float x) {
    const float square = x * x;
    const float p = polynomial(square, -0x1.d35742p-10f, 0x1.6423dep-7f, -0x1.fd7d9cp-6f, 0x1.da29f4p-5f,
                               -0x1.58091ap-4f, 0x1.c08c4ep-4f, -0x1.242086p-3f, 0x1.9991e4p-3f, -0x1.55553ep-2f);
    return p * (x * square);
}

} // namespace portable

/// Arc sine in [-pi/2, pi/2], radians; NaN for |x| > 1. At most 2 ulp off.
HD inline float asin(float x) {
    const float size = abs(x);
    if (!(size <= 1)) return kNaN;
    if (size <= 0.5f) return x + portable::asin_tail(x, x * x);
    const float half = fma(-0.5f, size, 0.5f), y = sqrt(half); // asin(x) = pi/2 - 2 asin(sqrt((1 - x) / 2))
    const float low = fma(-2.0f, portable::asin_tail(y, half), portable::kHalfPiLow);
    return copysign(portable::kHalfPi - fma(2.0f, y, -low), x);
}

/// Arc cosine in [0, pi], radians; NaN for |x| > 1. At most 2 ulp off.
HD inline float acos(float x) {
    const float size = abs(x);
    if (!(size <= 1)) return kNaN;
    if (size <= 0.5f) return portable::kHalfPi - (x - (portable::kHalfPiLow - portable::asin_tail(x, x * x)));
    const float half = fma(-0.5f, size, 0.5f), y = sqrt(half), tail = portable::asin_tail(y, half);
    if (x > 0) return 2.0f * (y + tail);
    return 2.0f * (portable::kHalfPi - (y + (tail - portable::kHalfPiLow)));
}

/// Arc tangent in [-pi/2, pi/2], radians. At most 2 ulp off.
HD inline float atan(float x) {
    if (x != x) return kNaN;
    const float size = abs(x);
    if (size <= 1) return copysign(size + portable::atan_tail(size), x);
    const float y = 1.0f / size;
    return copysign(portable::kHalfPi - (y - (portable::kHalfPiLow - portable::atan_tail(y))), x);
}

/// Angle of the point (x, y) in [-pi, pi], with C's values for zeros and infinities. At most 2 ulp off.
HD inline float atan2(float y, float x) {
    if (x != x || y != y) return kNaN;
    const float size_x = abs(x), size_y = abs(y);
    const float small = min(size_x, size_y), large = max(size_x, size_y);
    const float ratio = large == 0 ? 0.0f : (small == kInfinity ? 1.0f : small / large);
    const bool negative = bits_of(x) >> 31 != 0, steep = size_y > size_x;
    // angle = base + sign * atan(ratio)
    const float base = steep ? 1.0f : (negative ? 2.0f : 0.0f); // in quarter turns
    const float sign = steep != negative ? -1.0f : 1.0f;
    const float low = fma(sign, portable::atan_tail(ratio), base * portable::kHalfPiLow);
    return copysign(fma(base, portable::kHalfPi, fma(sign, ratio, low)), y);
}

} // namespace pertev
