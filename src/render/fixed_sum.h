#pragma once

// The film's number type: a 128-bit two's complement integer in units of 2^-64. Samples are shifted in, and bits
// below the unit are truncated towards zero. Integer addition is associative, so a sum does not depend on order,
// partition, device or interruption, and 10^6 samples lose nothing. See docs/conventions.md, "The film adds exactly".

#include <cstdint>
#include <cstring>

#include "base/host_device.h"
#include "base/limits.h"
#include "device/atomics.h"
#include "math/bits.h"
#include "math/scalar.h"

namespace pertev {

struct FixedSum {
    uint64_t low = 0, high = 0;
    bool operator==(const FixedSum&) const = default;
};
static_assert(static_cast<double>(kMaxSamplesPerPixel) * static_cast<double>(kMaxSampleValue) < 0x1p63);

HD inline FixedSum operator-(FixedSum x) {
    x.low = ~x.low + 1;
    x.high = ~x.high + (x.low == 0 ? 1 : 0);
    return x;
}

/// Converts x to fixed point. |x| <= kMaxSampleValue (2^40), finite.
HD inline FixedSum to_fixed(float x) {
    const uint32_t bits = bits_of(x);
    const uint32_t exponent = (bits >> 23) & 0xff;
    const uint64_t mantissa = (bits & 0x7fffffu) | (exponent != 0 ? 0x800000u : 0u);
    // x = mantissa * 2^(e - 150), e = max(exponent, 1); in units of 2^-64 that is mantissa * 2^(e - 86).
    const int shift = static_cast<int>(exponent != 0 ? exponent : 1u) - 86;
    FixedSum sum;
    if (shift <= -24) {
        sum = {0, 0};
    } else if (shift < 0) {
        sum = {mantissa >> -shift, 0};
    } else if (shift == 0) {
        sum = {mantissa, 0};
    } else if (shift < 64) {
        sum = {mantissa << shift, mantissa >> (64 - shift)};
    } else {
        sum = {0, mantissa << (shift - 64)};
    }
    return (bits >> 31) != 0 ? -sum : sum;
}

HD inline FixedSum operator+(FixedSum a, FixedSum b) {
    const uint64_t low = a.low + b.low;
    return {low, a.high + b.high + (low < b.low ? 1u : 0u)};
}

/// Adds atomically with respect to other additions to the same target.
HD inline void atomic_add(FixedSum* target, FixedSum value) {
    if (value.low != 0) {
        const uint64_t old = atomic_add(&target->low, value.low);
        value.high += old + value.low < old ? 1 : 0;
    }
    if (value.high != 0) atomic_add(&target->high, value.high);
}

/// A sum in parts of 27 bits, lowest first, of which 32 can be added without overflow.
struct FixedSumLimbs {
    uint32_t limbs[5];
};
HD inline FixedSumLimbs limbs_of(FixedSum x) {
    constexpr uint64_t kLimb = (uint64_t(1) << 27) - 1;
    return {{uint32_t(x.low & kLimb), uint32_t(x.low >> 27 & kLimb), uint32_t((x.low >> 54 | x.high << 10) & kLimb),
             uint32_t(x.high >> 17 & kLimb), uint32_t(x.high >> 44)}};
}
HD inline FixedSum sum_of(const FixedSumLimbs& sums) {
    const auto limb = [&](int i) { return uint64_t(sums.limbs[i]); };
    return FixedSum{limb(0) + (limb(1) << 27), 0} + FixedSum{limb(2) << 54, limb(2) >> 10} +
           FixedSum{0, (limb(3) << 17) + (limb(4) << 44)};
}

#if PERTEV_ON_DEVICE
/// Sums over the lanes that call it together, if all of them have the same `target`: then one lane gets the sums and
/// true, and the others false. Otherwise each lane keeps its values and gets true. Samples of a pixel begin side by
/// side, and many end together; additions to one address would wait for each other.
__device__ inline bool sum_of_warp(uint32_t target, FixedSum& a, FixedSum& b, FixedSum& c) {
#if __CUDA_ARCH__ >= 800
    const unsigned lanes = __activemask();
    int is_same;
    __match_all_sync(lanes, target, &is_same);
    if (!is_same || (lanes & (lanes - 1)) == 0) return true;
    for (FixedSum* const x : {&a, &b, &c}) {
        FixedSumLimbs sums = limbs_of(*x);
        for (uint32_t& limb : sums.limbs) limb = __reduce_add_sync(lanes, limb);
        *x = sum_of(sums);
    }
    return threadIdx.x % 32 == static_cast<unsigned>(__ffs(int(lanes)) - 1);
#else
    return true;
#endif
}
#endif

/// Returns sum / count, rounded once to the nearest float (ties to even). `count` is 1 to 2^37, far more than
/// kMaxSamplesPerPixel.
HD inline float mean_of(FixedSum sum, uint64_t count) {
    const bool negative = (sum.high >> 63) != 0;
    const auto [low, high] = negative ? -sum : sum;
    if ((low | high) == 0) return 0;

    // The leading 64 bits in units of 2^exponent, and whether any lower bit is set.
    const uint32_t zeros = 63 - highest_bit(high != 0 ? high : low);
    const uint64_t leading = high == 0 ? low << zeros : zeros == 0 ? high : high << zeros | low >> (64 - zeros);
    bool sticky = high != 0 && low << zeros != 0;
    int exponent = (high != 0 ? 0 : -64) - static_cast<int>(zeros);

    // The quotient has at least 26 bits, enough for one correct rounding. The bits below the leading ones are less
    // than one of them, so they only affect the remainder.
    uint64_t quotient = leading;
    if ((count & (count - 1)) == 0) {
        exponent -= static_cast<int>(highest_bit(count));
    } else {
        quotient = leading / count;
        sticky = sticky || quotient * count != leading;
    }
    const uint32_t cut = highest_bit(quotient) - 25; // reduces to 26 bits: 24 of the float, one to round by, one for
                                                     // the rest
    sticky = sticky || (quotient & ((uint64_t(1) << cut) - 1)) != 0;
    quotient >>= cut;
    exponent += static_cast<int>(cut);
    // An odd last bit below the rounding bit stands for everything cut off. The double is exact, and so is its
    // product with a power of two; its conversion rounds once. Neither is subnormal: the least mean is 2^-101.
    const double digits = static_cast<double>((quotient << 1) | (sticky ? 1 : 0));
    const uint64_t scale_bits = static_cast<uint64_t>(1023 + exponent - 1) << 52; // 2^(exponent - 1)
    double scale;
    memcpy(&scale, &scale_bits, sizeof scale);
    const float mean = static_cast<float>(digits * scale);
    return negative ? -mean : mean;
}

} // namespace pertev
