#pragma once

// exp, exp2, log, log2 of portable_math.h: reduction to one octave, one polynomial.

#include <cstdint>
#include <type_traits>

#include "base/host_device.h"
#include "math/scalar.h"

namespace pertev {

inline constexpr float kNaN = __builtin_nanf("");

/// Horner's rule by fused multiply-adds, from the coefficient of the highest power of `x` down.
template <class T, class... Floats>
HD inline T polynomial(T x, std::type_identity_t<T> highest, Floats... others) {
    T p = highest;
    ((p = fma(p, x, T(others))), ...);
    return p;
}

namespace portable {

// Adding and subtracting 1.5 * 2^23 rounds |x| < 2^22 to the nearest integer, ties to even.
inline constexpr float kRoundingShift = 0x1.8p23f;

template <class T>
HD inline T round_to_integer(T x) {
    return (x + kRoundingShift) - kRoundingShift;
}

/// x * 2^n, rounded once when the product is subnormal; n in [-250, 254], x in [0.5, 2].
HD inline float scale_by_power_of_2(float x, int n) {
    const int half = n >> 1; // one factor alone could leave float's range
    return x * float_of(static_cast<uint32_t>(half + 127) << 23) *
           float_of(static_cast<uint32_t>(n - half + 127) << 23);
}

/// 2^f for |f| <= 0.5 (a little more does no harm); at most 0.9 ulp off.
HD inline float exp2_of_fraction(float f) {
    const float p =
        polynomial(f, 0x1.416b5p-13f, 0x1.5f082ep-10f, 0x1.3b2dep-7f, 0x1.c6af7cp-5f, 0x1.ebfbdcp-3f, 0x1.62e43p-1f);
    return fma(p, f, 1.0f);
}

struct BinaryScale {
    float mantissa; // in [sqrt(1/2), sqrt(2))
    int exponent;
};

/// x = mantissa * 2^exponent, for x positive and finite, subnormal or not.
HD inline BinaryScale split_mantissa(float x) {
    const bool subnormal = x < 0x1p-126f;
    const uint32_t sqrt_half = 0x3f3504f3u;
    const uint32_t bits = bits_of(subnormal ? x * 0x1p23f : x) - sqrt_half;
    const int exponent = static_cast<int32_t>(bits) >> 23;
    return {float_of((bits & 0x7fffffu) + sqrt_half), exponent - (subnormal ? 23 : 0)};
}

/// Returns true if log and log2 have no finite value; `result` is their result then.
HD inline bool log_is_special(float x, float& result) {
    if (x > 0 && x < kInfinity) return false;
    result = x == 0 ? -kInfinity : (x > 0 ? kInfinity : kNaN);
    return true;
}

} // namespace portable

/// e^x. At most 1 ulp off.
HD inline float exp(float x) {
    if (x != x) return kNaN;
    x = clamp(x, -104.0f, 89.0f); // e^-104 rounds to 0, e^89 to infinity
    const float n = portable::round_to_integer(x * 0x1.715476p0f);
    const float a = fma(n, -0x1.62e43p-1f, x);                                        // exact
    const float r = fma(n, 0x1.05c61p-29f, a), r_low = fma(n, 0x1.05c61p-29f, a - r); // x - n ln 2
    const float p = polynomial(r, 0x1.6a493ap-10f, 0x1.12399ep-7f, 0x1.5558b4p-5f, 0x1.555492p-3f, 0x1.fffffcp-2f);
    return portable::scale_by_power_of_2((r + fma(r * r, p, r_low)) + 1.0f, static_cast<int>(n));
}

/// 2^x. At most 1 ulp off; exact for integers.
HD inline float exp2(float x) {
    if (x != x) return kNaN;
    x = clamp(x, -151.0f, 129.0f);
    const float n = portable::round_to_integer(x);
    return portable::scale_by_power_of_2(portable::exp2_of_fraction(x - n), static_cast<int>(n));
}

/// Natural logarithm; -infinity at 0, NaN below. At most 1 ulp off.
HD inline float log(float x) {
    float special;
    if (portable::log_is_special(x, special)) return special;
    const portable::BinaryScale scale = portable::split_mantissa(x);
    const float f = scale.mantissa - 1.0f, e = static_cast<float>(scale.exponent);
    const float p = polynomial(f, 0x1.14730ap-4f, -0x1.de01cap-4f, 0x1.e6c01p-4f, -0x1.fc28ccp-4f, 0x1.233ba2p-3f,
                               -0x1.555c44p-3f, 0x1.99a476p-3f, -0x1.000006p-2f, 0x1.555548p-2f, -0.5f);
    const float low = fma(p, f * f, e * -0x1.05c61p-29f); // includes the low part of e ln 2
    return fma(e, 0x1.62e43p-1f, f + low);
}

/// Logarithm to base 2; -infinity at 0, NaN below. At most 1 ulp off; exact for powers of 2.
HD inline float log2(float x) {
    float special;
    if (portable::log_is_special(x, special)) return special;
    const portable::BinaryScale scale = portable::split_mantissa(x);
    const float f = scale.mantissa - 1.0f;
    const float p = polynomial(f, 0x1.8af57p-4f, -0x1.574d52p-3f, 0x1.5f5b38p-3f, -0x1.6eeef4p-3f, 0x1.a42aa4p-3f,
                               -0x1.ec71d4p-3f, 0x1.277e66p-2f, -0x1.7154acp-2f, 0x1.ec708cp-2f, -0x1.715476p-1f);
    const float low = f * fma(p, f, 0x1.4ae0cp-26f); // 1 / ln 2 in two floats
    return static_cast<float>(scale.exponent) + fma(f, 0x1.715476p0f, low);
}

} // namespace pertev
