#pragma once

// Eight 32-bit words at once, for random numbers of eight paths (math/random.h, math/sampler.h). Host only.

#include <immintrin.h>

#include "math/sampler.h"

namespace pertev {

inline constexpr uint32_t kWords = 8;

/// Eight words with element-wise operators; a scalar operand is broadcast.
using Words8 = uint32_t __attribute__((vector_size(32)));

template <>
inline Words8 reverse_bits(Words8 x) {
    // Reverses the bytes of each word, then the bits of each half byte by a table of sixteen, and swaps the halves.
    const __m128i word = _mm_setr_epi8(3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12);
    const __m128i half = _mm_setr_epi8(0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15);
    const __m256i table = _mm256_broadcastsi128_si256(half), low = _mm256_set1_epi8(15);
    const __m256i bytes = _mm256_shuffle_epi8(reinterpret_cast<__m256i>(x), _mm256_broadcastsi128_si256(word));
    const __m256i first = _mm256_shuffle_epi8(table, _mm256_and_si256(bytes, low));
    const __m256i second = _mm256_shuffle_epi8(table, _mm256_and_si256(_mm256_srli_epi32(bytes, 4), low));
    return reinterpret_cast<Words8>(_mm256_or_si256(_mm256_slli_epi32(first, 4), second));
}

} // namespace pertev
