#pragma once

// Scalar functions with one meaning on both devices: every operation here rounds as IEEE 754 requires, or does not
// round. Unqualified sqrt, floor or abs on a float may be double (or int) on the host, so the renderer uses these
// names inside its namespace. Functions that need a polynomial are in math/portable_math.h.

#include <cmath>
#include <cstdint>
#include <cstring>

#include "base/host_device.h"

namespace pertev {

inline constexpr float kPi = 3.14159265358979323846f;
inline constexpr float kTwoPi = 6.28318530717958647692f;
inline constexpr float kInvPi = 0.31830988618379067154f;
inline constexpr float kInfinity = __builtin_huge_valf();

template <class T>
HD constexpr T min(T a, T b) {
    return b < a ? b : a;
}
template <class T>
HD constexpr T max(T a, T b) {
    return a < b ? b : a;
}
/// Returns `x` limited to [lo, hi]; `lo` for NaN.
template <class T>
HD constexpr T clamp(T x, T lo, T hi) {
    return x > lo ? (x < hi ? x : hi) : lo;
}

HD inline uint32_t bits_of(float x) {
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

/// Types that go with a number type, which is float, or eight floats at once on the host (math/lanes.h).
template <class T>
struct NumberTraits {
    using Mask = bool;
    using Word = uint32_t;
};
template <class T>
using MaskOf = typename NumberTraits<T>::Mask;
template <class T>
using WordOf = typename NumberTraits<T>::Word;

template <class T = float>
HD inline T float_of(WordOf<T> bits) {
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}
/// Conditions of code for any number type, where a mask has a truth value for each lane.
HD constexpr bool any(bool condition) { return condition; }
template <class T>
HD constexpr T select(bool condition, T a, T b) {
    return condition ? a : b;
}

HD inline float abs(float x) {
#if PERTEV_ON_DEVICE && !defined(PERTEV_EMULATED_WARPS)
    return ::fabsf(x); // folded into the instruction that uses it
#else
    return float_of(bits_of(x) & 0x7fffffffu);
#endif
}
HD inline float copysign(float magnitude, float sign) {
    return float_of((bits_of(magnitude) & 0x7fffffffu) | (bits_of(sign) & 0x80000000u));
}
/// Returns 1 / x, correctly rounded, for 2^-126 <= |x| < 2^126; beyond, devices differ. The device uses the three
/// instructions that the compiler uses for these x, without its branch for others.
HD inline float reciprocal_of_normal(float x) {
#if PERTEV_ON_DEVICE && !defined(PERTEV_EMULATED_WARPS)
    float r;
    asm("rcp.approx.ftz.f32 %0, %1;" : "=f"(r) : "f"(x));
    return ::fmaf(r, ::fmaf(-x, r, 1.0f), r);
#else
    return 1.0f / x;
#endif
}
HD inline bool is_finite(float x) { return (bits_of(x) & 0x7f800000u) != 0x7f800000u; }
HD inline float sqrt(float x) { return ::sqrtf(x); }
/// Square root of max(x, 0).
HD inline float safe_sqrt(float x) { return ::sqrtf(x > 0 ? x : 0.0f); }
HD inline float floor(float x) { return ::floorf(x); }
HD inline float fma(float a, float b, float c) { return ::fmaf(a, b, c); }
HD inline float square(float x) { return x * x; }
template <class T>
HD inline T lerp(T a, T b, T t) {
    return a + t * (b - a);
}

/// Returns of(x), for several numbers at once of each.
template <class Of>
HD inline float for_each_lane(float x, const Of& of) {
    return of(x);
}
/// Element of an array; for several indices at once, of each.
template <class T = float>
HD inline T gather(const float* from, WordOf<T> index) {
    return from[index];
}
/// Truncates to an integer, whose bits are the word; |x| < 2^31.
HD inline uint32_t truncate_to_word(float x) { return static_cast<uint32_t>(static_cast<int>(x)); }
/// Truncates a float to an integer, clamped to [lo, hi]; `lo` for NaN. lo and hi are within +-2^30.
HD inline int to_int(float x, int lo, int hi) {
    if (!(x > static_cast<float>(lo))) return lo;
    if (!(x < static_cast<float>(hi))) return hi;
    return static_cast<int>(x);
}

} // namespace pertev
