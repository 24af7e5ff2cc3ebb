#pragma once

// Random numbers of a path: a pure function of (stream, sample index, group, number in the group, seed), each strictly
// inside (0, 1). The stream of a camera ray is its pixel in the whole picture. A group is four numbers that are
// stratified together, for decisions that belong together.
//
// Sobol: each (stream, group, seed) has its own random shuffle and scrambling of one four-dimensional sequence. Of the
// first 2^k samples of a stream one falls into each of the 2^k equal intervals of any number, and into each box 2^-a x
// 2^-(k-a) of the first two numbers and of the last two; of the first 4^k one falls into each four-dimensional box
// whose sides are powers of 1/4 and whose volume is 4^-k. Different groups are independent.
//
// Sources: the sequence is Faure's over the field of four elements (Niederreiter, "Point sets and sequences with small
// discrepancy", 1987), whose digits here are pairs of bits; that pairs of it can be (0,2)-sequences in base 2 as well
// is in Ahmed et al., "SZ Sequences: Binary-Based (0, 2^q)-Sequences", 2025. Scrambling: Burley, "Practical Hash-based
// Owen Scrambling", JCGT 9(4), 2020, sections 3-5; the hash's later constants by Vegdahl, "Building a Better LK Hash",
// 2021. No tables: a generator matrix is a few shifts and masks (pascal_transform).

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

/// Key of the random numbers of a sample; `Word` is for one path, or for eight (math/random.h).
template <class Word>
struct SampleKeyOf {
    Word stream = {}; // a pixel of the picture, a photon, ...: its samples are stratified
    Word sample = {}; // index among the samples of the stream
    Word seed = {};   // another seed gives another picture with the same expectation
};
using SampleKey = SampleKeyOf<uint32_t>;

/// The value ((bits >> 9) + 0.5) 2^-23: the middles of 2^23 equal parts of (0, 1), exact.
template <class T = float>
HD inline T unit_interval(WordOf<T> bits) {
    return float_of<T>((bits >> 9) | 0x3f800000u) - 0x1.fffffep-1f;
}

template <class Word>
HD inline Word reverse_bits(Word x) {
    static_assert(std::is_same_v<Word, uint32_t>); // math/words8.h has the overload for eight words
#if PERTEV_ON_DEVICE
    return __brev(x);
#else
    x = (x >> 1 & 0x55555555u) | (x & 0x55555555u) << 1;
    x = (x >> 2 & 0x33333333u) | (x & 0x33333333u) << 2;
    x = (x >> 4 & 0x0f0f0f0fu) | (x & 0x0f0f0f0fu) << 4;
    return __builtin_bswap32(x);
#endif
}

/// A random permutation in which bit k of the result depends only on the bits 0 to k of x: Owen's nested scrambling
/// of a fraction whose first digit is bit 0.
template <class Word>
HD inline Word owen_scramble_reversed(Word x, Word key) {
    x ^= x * 0x3d20adeau; // even factors: each bit depends only on lower ones
    x += key;
    x *= (key >> 16) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

/// Elements of the field of four: 0, 1, w and w + 1 = w^2.
enum class FieldElement : uint8_t { One, W, WSquared };

/// Multiplies each of sixteen digits in base 4 by `factor`. A digit is two bits, of which the first is the more
/// significant.
template <class Word>
HD inline Word multiply_digits(FieldElement factor, Word x) {
    const Word first = x & 0x55555555u, second = x >> 1 & 0x55555555u;
    switch (factor) {
    case FieldElement::One:
        break;
    case FieldElement::W:
        return second | (first ^ second) << 1;
    case FieldElement::WSquared:
        return (first ^ second) | first << 1;
    }
    return x;
}

/// Component of Faure's sequence, first digit in the lowest bits: digit k is the sum over j of C(j, k) a^(j-k) times
/// digit j of the index, a = `factor`. C(j, k) is odd if j has every bit of k (Lucas), so there is one step per bit
/// of k.
template <class Word>
HD inline Word pascal_transform(FieldElement factor, Word x) {
    const bool is_w = factor == FieldElement::W;
    const FieldElement squared = factor == FieldElement::One ? factor : is_w ? FieldElement::WSquared : FieldElement::W;
    x ^= multiply_digits(factor, x >> 2 & 0x33333333u); // a, a^2, a^4 = a, a^8 = a^2
    x ^= multiply_digits(squared, x >> 4 & 0x0f0f0f0fu);
    x ^= multiply_digits(factor, x >> 8 & 0x00ff00ffu);
    x ^= multiply_digits(squared, x >> 16);
    return x;
}

/// Component `number` of the sequence's point `index`, unscrambled, first digit in bit 0. Adding a digit's bits in
/// the first one's position makes the pairs (0, 1) and (2, 3) nets in base 2 as well, and does not affect base 4.
template <class Word>
HD inline Word sequence_component(Word index, uint32_t number) {
    switch (number) {
    case 0:
        return index;
    case 1: {
        const Word x = pascal_transform(FieldElement::One, index);
        return x ^ (x >> 1 & 0x55555555u);
    }
    case 2:
        return pascal_transform(FieldElement::W, index);
    default: {
        const Word x = pascal_transform(FieldElement::WSquared, index);
        return x ^ (x >> 1 & 0x55555555u);
    }
    }
}

/// Two numbers in [0, 1) by their first 32 binary digits.
template <class Word>
struct SampleBitsOf {
    Word x, y;
};
using SampleBits = SampleBitsOf<uint32_t>;

/// The first or the last two numbers of a group.
enum class Pair : uint8_t { First, Last };

/// Values shared by the four numbers of a group.
template <class Word>
struct GroupKeys {
    Word index; // shuffled index of the point, first digit in bit 0
    Hash3Of<Word> keys;
};

template <class Word>
HD inline GroupKeys<Word> group_keys(SampleKeyOf<Word> key, std::type_identity_t<Word> group) {
    const Hash3Of<Word> keys = hash_words<Word>(key.stream, group, key.seed);
    // Scrambling the index shuffles the order of the points.
    return {reverse_bits(owen_scramble_reversed(reverse_bits(key.sample), keys.x)), keys};
}

/// Component `number` of a group, scrambled. It is inlined, like sample_bits, so that `number` is a constant: a switch
/// at run time costs 2 % of a render on the CPU.
template <class Word>
[[gnu::always_inline]] HD inline Word scrambled_component(const GroupKeys<Word>& group, uint32_t number) {
    const Word key = number % 2 == 0 ? group.keys.y : group.keys.z;
    return reverse_bits(
        owen_scramble_reversed(sequence_component(group.index, number), number < 2 ? key : hash_word(key)));
}

/// 32 bits each of two numbers of a group.
template <class Word = uint32_t>
[[gnu::always_inline]] HD inline SampleBitsOf<Word>
sample_bits(SamplerKind kind, std::type_identity_t<SampleKeyOf<Word>> key, std::type_identity_t<Word> group,
            Pair pair = Pair::First) {
    switch (kind) {
    case SamplerKind::Sobol: {
        const GroupKeys<Word> keys = group_keys(key, group);
        const uint32_t first = pair == Pair::First ? 0 : 2;
        return {scrambled_component(keys, first), scrambled_component(keys, first + 1)};
    }
    case SamplerKind::Independent:
        break;
    }
    const Hash4Of<Word> bits = hash_words<Word>(key.stream, key.sample, group, key.seed);
    return pair == Pair::First ? SampleBitsOf<Word>{bits.x, bits.y} : SampleBitsOf<Word>{bits.z, bits.w};
}

/// A point of (0, 1)^2.
HD inline Vec2 sample_2d(SamplerKind kind, SampleKey key, uint32_t group, Pair pair = Pair::First) {
    const SampleBits bits = sample_bits(kind, key, group, pair);
    return {unit_interval(bits.x), unit_interval(bits.y)};
}

/// Returns number 0 to 3 of the group, in (0, 1).
HD inline float sample_1d(SamplerKind kind, SampleKey key, uint32_t group, uint32_t number = 0) {
    switch (kind) {
    case SamplerKind::Sobol:
        return unit_interval(scrambled_component(group_keys(key, group), number));
    case SamplerKind::Independent:
        break;
    }
    const Hash4 bits = hash_words(key.stream, key.sample, group, key.seed);
    return unit_interval(number == 0 ? bits.x : number == 1 ? bits.y : number == 2 ? bits.z : bits.w);
}

} // namespace pertev
