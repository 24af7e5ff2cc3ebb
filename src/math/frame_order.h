#pragma once

// The order in which pixels of frames take points of one low-discrepancy sequence, so that errors are blue noise over
// space and time: what neighbours in the picture and in time get wrong cancels out, and a filter over either leaves
// less than of white noise.
//
// In a frame pixels take the sequence's points along the Morton curve, shuffled at every level: the pixels of each
// block of 2^k, aligned, have 2^k points of it that are stratified together (Ahmed and Wonka, "Screen-Space Blue-Noise
// Diffusion of Monte Carlo Sampling Error via Hierarchical Ordering of Pixels", SIGGRAPH Asia 2020). Time is added, bit
// for bit, as words that the index is changed by: kFrameWords. A block's index keeps all its values, so each frame
// stays as good. The words are found by search (as direction numbers are: Joe and Kuo, "Constructing Sobol Sequences
// with Better Two-Dimensional Projections", 2008), for the quality t of the nets that 2^b frames of a block of 2^a
// pixels make, in one number and in both pairs: it is mostly 1 or 2 for a <= 10 and b <= 6, and at most 1 for a pixel
// alone.

#include <cstdint>

#include "base/host_device.h"

namespace pertev {

/// Frames after which the sequence is scrambled anew: 2^6.
inline constexpr uint32_t kFrameBits = 6;

/// What the index of every pixel is changed by in frame `time` < 2^kFrameBits of the sequence.
template <class Word>
HD inline Word frame_word(Word time) {
    Word word = {};
    word ^= (0u - (time & 1u)) & 0x5ac592d7u;
    word ^= (0u - (time >> 1u & 1u)) & 0x48d263a5u;
    word ^= (0u - (time >> 2u & 1u)) & 0xd4d385ccu;
    word ^= (0u - (time >> 3u & 1u)) & 0xf7653742u;
    word ^= (0u - (time >> 4u & 1u)) & 0x1970ca1du;
    word ^= (0u - (time >> 5u & 1u)) & 0xab7a6738u;
    return word;
}

/// Place on the Morton curve through the picture. Both below 2^16.
HD inline uint32_t morton_code(uint32_t x, uint32_t y) {
    const auto spread = [](uint32_t v) {
        v = (v | v << 8) & 0x00ff00ffu;
        v = (v | v << 4) & 0x0f0f0f0fu;
        v = (v | v << 2) & 0x33333333u;
        return (v | v << 1) & 0x55555555u;
    };
    return spread(x) | spread(y) << 1;
}

} // namespace pertev
