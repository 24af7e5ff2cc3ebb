#pragma once

// Counter-based random bits: each function hashes words (a pixel, a sample, a dimension) into bits that appear
// independent. There is no state, so numbers depend on their purpose and not on the order of draws.
//
// Source: Jarzynski, Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020: pcg, pcg3d and pcg4d, which pass the
// most of TestU01 at their cost. The high bits are the better ones.
//
// `Word`, here and in sampler.h, is uint32_t, or eight of them at once (math/words8.h) with the same bits in each.

#include <cstdint>
#include <type_traits>

#include "base/host_device.h"

namespace pertev {

template <class Word>
struct Hash3Of {
    Word x, y, z;
};
template <class Word>
struct Hash4Of {
    Word x, y, z, w;
};
using Hash3 = Hash3Of<uint32_t>;
using Hash4 = Hash4Of<uint32_t>;

/// A permutation of the 32-bit words.
template <class Word>
HD inline Word hash_word(Word x) {
    const Word state = x * 747796405u + 2891336453u;
    const Word word = ((state >> ((state >> 28) + 4)) ^ state) * 277803737u;
    return (word >> 22) ^ word;
}

/// A permutation of triples: three words in, three words out, each of which depends on all inputs.
template <class Word = uint32_t>
HD inline Hash3Of<Word> hash_words(std::type_identity_t<Word> x, std::type_identity_t<Word> y,
                                   std::type_identity_t<Word> z) {
    x = x * 1664525u + 1013904223u;
    y = y * 1664525u + 1013904223u;
    z = z * 1664525u + 1013904223u;
    x += y * z;
    y += z * x;
    z += x * y;
    x ^= x >> 16;
    y ^= y >> 16;
    z ^= z >> 16;
    x += y * z;
    y += z * x;
    z += x * y;
    return {x, y, z};
}

/// A permutation of four words, like that of three.
template <class Word = uint32_t>
HD inline Hash4Of<Word> hash_words(std::type_identity_t<Word> x, std::type_identity_t<Word> y,
                                   std::type_identity_t<Word> z, std::type_identity_t<Word> w) {
    x = x * 1664525u + 1013904223u;
    y = y * 1664525u + 1013904223u;
    z = z * 1664525u + 1013904223u;
    w = w * 1664525u + 1013904223u;
    x += y * w;
    y += z * x;
    z += x * y;
    w += y * z;
    x ^= x >> 16;
    y ^= y >> 16;
    z ^= z >> 16;
    w ^= w >> 16;
    x += y * w;
    y += z * x;
    z += x * y;
    w += y * z;
    return {x, y, z, w};
}

} // namespace pertev
