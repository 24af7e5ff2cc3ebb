#pragma once

// The film's number: a 128-bit two's complement integer in units of 2^-64. Samples are shifted in, bits below the unit
// are cut (towards zero). Integer addition is associative, so a sum does not depend on order, split, device or resume,
// and 10^6 samples lose nothing. docs/conventions.md, "The film adds exactly".

#include <cstdint>

#include "base/host_device.h"
#include "base/limits.h"
#include "device/atomic_add.h"
#include "math/scalar.h"

namespace pertev {

struct FixedSum {
    uint64_t low = 0, high = 0;
    bool operator==(const FixedSum&) const = default;
};
static_assert(static_cast<double>(kMaxSamplesPerPixel) * static_cast<double>(kMaxSampleValue) < 0x1p63);

/// x in fixed point. |x| <= kMaxSampleValue (2^40), finite.
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
    if ((bits >> 31) != 0) { // two's complement negation
        sum.low = ~sum.low + 1;
        sum.high = ~sum.high + (sum.low == 0 ? 1 : 0);
    }
    return sum;
}

HD inline FixedSum operator+(FixedSum a, FixedSum b) {
    const uint64_t low = a.low + b.low;
    return {low, a.high + b.high + (low < b.low ? 1u : 0u)};
}

/// target += value, safe against other threads' additions to the same target.
HD inline void atomic_add(FixedSum* target, FixedSum value) {
    if (value.low != 0) {
        const uint64_t old = atomic_add(&target->low, value.low);
        value.high += old + value.low < old ? 1 : 0;
    }
    if (value.high != 0) atomic_add(&target->high, value.high);
}

/// sum / count, rounded once to the nearest float (ties to even). count > 0. Host only.
float mean_of(FixedSum sum, uint64_t count);

} // namespace pertev
