#pragma once

// sin, cos, tan of portable_math.h: the angle less a multiple of pi/2, then one polynomial on [-pi/4, pi/4]. Up to 2^16
// radians the multiple is subtracted in three floats (Cody, Waite, "Software Manual for the Elementary Functions",
// 1980); above, it is found in integers from the bits of 2/pi (Payne, Hanek, SIGNUM Newsletter 18, 1983).

#include <cstdint>

#include "base/host_device.h"
#include "math/portable_exp_log.h"
#include "math/scalar.h"

namespace pertev {

namespace portable {

struct ReducedAngle {
    float high, low; // radians; the angle is high + low, |high| < 0.79
    int quadrant;    // quarter turns taken off; only the last two bits count
};

/// Word `k` of 32 zero bits and then the fraction of 2/pi; k in [0, 7].
HD inline uint32_t two_over_pi_word(uint32_t k) {
    static constexpr uint32_t words[] = {0,           0xa2f9836eu, 0x4e441529u, 0xfc2757d1u,
                                         0xf534ddc0u, 0xdb629599u, 0x3c439041u, 0xfe5163abu};
    return words[k];
}

/// Reduces an angle with 2^16 <= |x| < infinity to a quadrant and a rest. Only those bits of 2/pi whose product with m
/// 2^s is below 4 affect the quadrant of |x| 2/pi = m 2^s 2/pi, with m an integer of 24 bits; 96 of them leave at least
/// 30 good bits in the worst case.
HD inline ReducedAngle reduce_large_angle(float x) {
    const uint32_t bits = bits_of(x) & 0x7fffffffu;
    const uint64_t m = (bits & 0x7fffffu) | 0x800000u;
    const uint32_t first = (bits >> 23) - 127 - 23 + 30; // s + 30
    const uint32_t word = first >> 5, shift = first & 31;
    uint32_t window[3];
    for (uint32_t k = 0; k < 3; k++) {
        const uint64_t pair = static_cast<uint64_t>(two_over_pi_word(word + k)) << 32 | two_over_pi_word(word + k + 1);
        window[k] = static_cast<uint32_t>(pair >> (32 - shift));
    }
    const uint64_t p2 = m * window[2], p1 = m * window[1] + (p2 >> 32), p0 = m * window[0] + (p1 >> 32);
    const uint64_t product = p0 << 32 | (p1 & 0xffffffffu); // quarter turns, 62 bits after the point, modulo 4
    const uint64_t quadrant = (product + (uint64_t{1} << 61)) >> 62;
    const int64_t fraction = static_cast<int64_t>(product - (quadrant << 62));
    double angle = static_cast<double>(fraction) * 0x1.921fb54442d18p-62; // pi/2 * 2^-62
    int turns = static_cast<int>(quadrant);
    if (x < 0) angle = -angle, turns = -turns;
    const float high = static_cast<float>(angle);
    return {high, static_cast<float>(angle - static_cast<double>(high)), turns};
}

/// Reduces a finite angle to a quadrant and a rest, whose high + low is good to about 2^-45.
HD inline ReducedAngle reduce_angle(float x) {
    const bool large = (bits_of(x) & 0x7fffffffu) >= 0x47800000u; // 2^16
    if (large) return reduce_large_angle(x);
    const float q = round_to_integer(x * 0x1.45f306p-1f);
    const float a = fma(q, -0x1.921fb6p0f, x); // exact
    const float b = q * 0x1.777a5cp-25f, b_low = fma(q, 0x1.777a5cp-25f, -b);
    const float sum = a + b, b_part = sum - a; // Knuth's two-sum
    const float error = (a - (sum - b_part)) + (b - b_part);
    const float low = error + fma(q, 0x1.ee59dap-50f, b_low);
    const float high = sum + low;
    return {high, (sum - high) + low, static_cast<int>(q)};
}

/// sin(r + low) and cos(r + low), |r| <= 0.79.
HD inline float sin_near_0(float r, float low) {
    const float s = r * r;
    const float p = polynomial(s, -0x1.991c22p-13f, 0x1.1106c6p-7f, -0x1.555544p-3f);
    return r + fma(r * s, p, low);
}
HD inline float cos_near_0(float r, float low) {
    const float s = r * r;
    const float p = polynomial(s, 0x1.99e528p-16f, -0x1.6c0c22p-10f, 0x1.55554ap-5f);
    const float half = 0.5f * s, most = 1.0f - half;
    return most + (((1.0f - most) - half) + fma(s * s, p, -r * low));
}

} // namespace portable

/// Sine and cosine of x radians; NaN for infinity. At most 1 ulp off for every float.
HD inline void sin_cos(float x, float& s, float& c) {
    s = c = kNaN;
    if (!is_finite(x)) return;
    const portable::ReducedAngle angle = portable::reduce_angle(x);
    const float a = portable::sin_near_0(angle.high, angle.low), b = portable::cos_near_0(angle.high, angle.low);
    const bool swap = (angle.quadrant & 1) != 0;
    s = swap ? b : a;
    c = swap ? a : b;
    if ((angle.quadrant & 2) != 0) s = -s;
    if (((angle.quadrant + 1) & 2) != 0) c = -c;
    if (x == 0) s = x; // the reduction loses the sign of zero
}

/// Sine of x radians; NaN for infinity. At most 1 ulp off for every float.
HD inline float sin(float x) {
    if (!is_finite(x)) return kNaN;
    const portable::ReducedAngle angle = portable::reduce_angle(x);
    const float s = (angle.quadrant & 1) != 0 ? portable::cos_near_0(angle.high, angle.low)
                                              : portable::sin_near_0(angle.high, angle.low);
    return x == 0 ? x : ((angle.quadrant & 2) != 0 ? -s : s);
}

/// Cosine of x radians; NaN for infinity. At most 1 ulp off for every float.
HD inline float cos(float x) {
    if (!is_finite(x)) return kNaN;
    const portable::ReducedAngle angle = portable::reduce_angle(x);
    const float c = (angle.quadrant & 1) != 0 ? portable::sin_near_0(angle.high, angle.low)
                                              : portable::cos_near_0(angle.high, angle.low);
    return ((angle.quadrant + 1) & 2) != 0 ? -c : c;
}

/// Tangent of x radians; NaN for infinity. At most 2 ulp off for every float.
HD inline float tan(float x) {
    if (!is_finite(x)) return kNaN;
    if (x == 0) return x;
    const portable::ReducedAngle angle = portable::reduce_angle(x);
    const float r = angle.high, s = r * r, cube = r * s;
    const float p = polynomial(s, 0x1.24a82ap-8f, -0x1.74ac5ap-14f, 0x1.679abap-7f, 0x1.5bd3e2p-6f, 0x1.baf0c6p-5f,
                               0x1.110d1ap-3f, 0x1.555562p-2f);
    const float rough = fma(cube, p, r);
    const float t = r + fma(cube, p, angle.low * fma(rough, rough, 1.0f)); // tan' = 1 + tan^2
    return (angle.quadrant & 1) != 0 ? -1.0f / t : t;
}

/// Sine and cosine of 2 pi u, for |u| <= 2^20: the turn is taken off exactly. At most 1 ulp off; exact at quarters.
template <class T = float>
HD inline void sin_cos_2pi(T u, T& s, T& c) {
    const T q = portable::round_to_integer(4.0f * u);
    const T f = fma(q, T(-0.25f), u), square = f * f; // |f| <= 1/8
    // The last coefficient of sin is the low part of 2 pi.
    const T p = polynomial(square, 0x1.443a72p5f, -0x1.32adaap6f, 0x1.466b78p6f, -0x1.4abbcep5f, -0x1.777a5cp-23f);
    const T a = fma(f, T(0x1.921fb6p2f), f * p);
    const T r = polynomial(square, 0x1.846342p6f, 0x1.bb9a7ap5f, -0x1.5591aep6f, 0x1.03c196p6f, -0x1.3bd3ccp4f);
    const T b = fma(r, square, T(1.0f));
    const WordOf<T> quadrant = truncate_to_word(q);
    const MaskOf<T> swap = (quadrant & 1u) != 0u, turns_s = (quadrant & 2u) != 0u,
                    turns_c = ((quadrant + 1u) & 2u) != 0u;
    s = select(swap, b, a);
    c = select(swap, a, b);
    s = select(turns_s, -s, s);
    c = select(turns_c, -c, c);
}

} // namespace pertev
