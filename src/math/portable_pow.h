#pragma once

// pow of portable_math.h: log2 of the base in two floats (about 2^-36 off), times the exponent, then 2^that.

#include <cstdint>

#include "base/host_device.h"
#include "math/portable_exp_log.h"
#include "math/scalar.h"

namespace pertev {

namespace portable {

struct TwoFloats {
    float high, low; // the value is high + low
};

/// log2(x) for x positive and finite.
HD inline TwoFloats log2_in_two_floats(float x) {
    const BinaryScale scale = split_mantissa(x);
    const float m = scale.mantissa, e = static_cast<float>(scale.exponent);

    // g = 2 (m - 1) / (m + 1), so that log(m) = g + g^3/12 + g^5/80 + ...
    const float numerator = 2.0f * (m - 1.0f), sum = m + 1.0f, sum_low = m - (sum - 1.0f);
    const float reciprocal = 1.0f / sum, g = numerator * reciprocal;
    const float g_low = fma(-g, sum_low, fma(-g, sum, numerator)) * reciprocal;

    const float square = g * g, square_low = fma(2.0f * g, g_low, fma(g, g, -square));
    const float twelfth = 0x1.555556p-4f, twelfth_low = -0x1.555556p-29f;
    const float rest = square * fma(fma(0x1.dfa1b8p-12f, square, 0x1.24527ep-9f), square, 0x1.999ap-7f);
    const float factor = twelfth + rest, factor_low = ((twelfth - factor) + rest) + twelfth_low;
    const float cube = square * g, cube_low = fma(square, g, -cube) + fma(square, g_low, square_low * g);
    const float tail = cube * factor, tail_low = fma(cube, factor, -tail) + fma(cube, factor_low, cube_low * factor);
    const float log_m = g + tail, log_m_low = ((g - log_m) + tail) + (g_low + tail_low);

    const float kLog2E = 0x1.715476p0f, kLog2ELow = 0x1.4ae0cp-26f;
    const float high = log_m * kLog2E, low = fma(log_m, kLog2E, -high) + fma(log_m, kLog2ELow, log_m_low * kLog2E);
    const float total = e + high; // |high| <= 0.5, so e is the larger or 0
    return {total, ((e - total) + high) + low};
}

/// |x|^y where neither is 0, infinite or NaN.
HD inline float pow_of_finite(float x, float y) {
    const TwoFloats log2_x = log2_in_two_floats(x);
    const float product = y * log2_x.high;
    if (product >= 129.0f) return kInfinity;
    if (product <= -151.0f) return 0.0f;
    const float product_low = fma(y, log2_x.low, fma(y, log2_x.high, -product));
    const float n = round_to_integer(product);
    return scale_by_power_of_2(exp2_of_fraction((product - n) + product_low), static_cast<int>(n));
}

} // namespace portable

/// x^y, with C's special cases: pow(x, 0) = pow(1, y) = 1, NaN for x < 0 with y not an integer. At most 1 ulp off.
HD inline float pow(float x, float y) {
    if (y == 0 || x == 1) return 1.0f;
    if (x != x || y != y) return kNaN;
    const float size = abs(x);
    const bool integer = abs(y) >= 0x1p24f || floor(y) == y;
    const bool odd = integer && abs(y) < 0x1p24f && (static_cast<int>(y) & 1) != 0;
    float result;
    if (size == 0 || size == kInfinity) {
        result = (size == 0) == (y > 0) ? 0.0f : kInfinity;
    } else if (abs(y) == kInfinity) {
        result = size == 1 ? 1.0f : ((size > 1) == (y > 0) ? kInfinity : 0.0f);
    } else if (x < 0 && !integer) {
        return kNaN;
    } else {
        result = portable::pow_of_finite(size, y);
    }
    return odd ? copysign(result, x) : result;
}

} // namespace pertev
