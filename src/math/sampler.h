#pragma once

// The random numbers of a path: a pure function of (pixel, sample index, dimension, seed), each strictly inside (0, 1).
// A dimension is one draw, of one number or of a pair: a path uses each dimension once, and in one of the two ways.
//
// Sobol: for each (pixel, dimension, seed) its own random shuffle of the (0,2)-sequence of Sobol, so that the first 2^k
// samples of a pixel, in any dimension, have one point in each box 2^-a x 2^-(k-a), and any two dimensions are
// independent. Source: Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4), 2020, sections 3-5; the hash's later
// constants by Vegdahl, "Building a Better LK Hash", 2021. No tables: the two generator matrices are the bit reversal
// and the Pascal triangle modulo 2. About 70 integer instructions a pair on a GPU.

#include <cstdint>

#include "base/host_device.h"
#include "math/random.h"
#include "math/scalar.h"
#include "math/vec2.h"

namespace pertev {

enum class SamplerKind : uint8_t {
    Sobol,       // low discrepancy over the samples of a pixel
    Independent, // white noise: for tests and comparisons
};

struct SampleKey {
    uint32_t pixel = 0;  // any numbering of the pixels
    uint32_t sample = 0; // index among the samples of the pixel
    uint32_t seed = 0;   // another seed, another picture of the same expectation
};

/// ((bits >> 9) + 0.5) 2^-23: the middles of 2^23 equal parts of (0, 1), exact.
HD inline float unit_interval(uint32_t bits) { return float_of((bits >> 9) | 0x3f800000u) - 0x1.fffffep-1f; }

HD inline uint32_t reverse_bits(uint32_t x) {
#if PERTEV_ON_DEVICE
    return __brev(x);
#else
    x = (x >> 1 & 0x55555555u) | (x & 0x55555555u) << 1;
    x = (x >> 2 & 0x33333333u) | (x & 0x33333333u) << 2;
    x = (x >> 4 & 0x0f0f0f0fu) | (x & 0x0f0f0f0fu) << 4;
    return __builtin_bswap32(x);
#endif
}

/// A random permutation in which bit k of the result depends on the bits 0 to k of x alone: Owen's nested scrambling of
/// a fraction whose first digit is bit 0.
HD inline uint32_t owen_scramble_reversed(uint32_t x, uint32_t key) {
    x ^= x * 0x3d20adeau; // even factors: each bit is changed by lower ones only
    x += key;
    x *= (key >> 16) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

/// Second component of the Sobol sequence, first digit in bit 0: digit k is the sum modulo 2 of C(j, k) times bit j of
/// the index. C(j, k) is odd where j has every bit of k (Lucas), hence one exclusive-or step a bit of k.
HD inline uint32_t pascal_transform(uint32_t x) {
    x ^= x >> 1 & 0x55555555u;
    x ^= x >> 2 & 0x33333333u;
    x ^= x >> 4 & 0x0f0f0f0fu;
    x ^= x >> 8 & 0x00ff00ffu;
    x ^= x >> 16;
    return x;
}

/// 32 bits, the first digits of a number in [0, 1).
HD inline uint32_t sample_bits(SamplerKind kind, SampleKey key, uint32_t dimension) {
    switch (kind) {
    case SamplerKind::Sobol: {
        const Hash3 keys = hash_words(key.pixel, dimension, key.seed);
        // The order of the points is shuffled by scrambling the index; the first component is the index reversed.
        const uint32_t index = reverse_bits(owen_scramble_reversed(reverse_bits(key.sample), keys.x));
        return reverse_bits(owen_scramble_reversed(index, keys.y));
    }
    case SamplerKind::Independent:
        break;
    }
    return hash_words(key.pixel, key.sample, dimension, key.seed).x;
}

/// One number in (0, 1).
HD inline float sample_1d(SamplerKind kind, SampleKey key, uint32_t dimension) {
    return unit_interval(sample_bits(kind, key, dimension));
}

/// A point of (0, 1)^2.
HD inline Vec2 sample_2d(SamplerKind kind, SampleKey key, uint32_t dimension) {
    switch (kind) {
    case SamplerKind::Sobol: {
        const Hash3 keys = hash_words(key.pixel, dimension, key.seed);
        const uint32_t index = reverse_bits(owen_scramble_reversed(reverse_bits(key.sample), keys.x));
        const uint32_t x = owen_scramble_reversed(index, keys.y);
        const uint32_t y = owen_scramble_reversed(pascal_transform(index), keys.z);
        return {unit_interval(reverse_bits(x)), unit_interval(reverse_bits(y))};
    }
    case SamplerKind::Independent:
        break;
    }
    const Hash4 bits = hash_words(key.pixel, key.sample, dimension, key.seed);
    return {unit_interval(bits.x), unit_interval(bits.y)};
}

} // namespace pertev
