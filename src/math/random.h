#pragma once

// Counter-based random bits: each function hashes words of its own choice (a pixel, a sample, a dimension) into bits
// that look independent. No state, so the numbers depend on what they are for and not on when they are drawn.
//
// Source: Jarzynski, Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020: pcg, pcg3d and pcg4d, which pass the
// most of TestU01 at their cost. The high bits are the better ones.

#include <cstdint>

#include "base/host_device.h"

namespace pertev {

struct Hash3 {
    uint32_t x, y, z;
};
struct Hash4 {
    uint32_t x, y, z, w;
};

/// A permutation of the 32-bit words.
HD inline uint32_t hash_word(uint32_t x) {
    const uint32_t state = x * 747796405u + 2891336453u;
    const uint32_t word = ((state >> ((state >> 28) + 4)) ^ state) * 277803737u;
    return (word >> 22) ^ word;
}

/// A permutation of triples: three words in, three words out, each of which depends on all.
HD inline Hash3 hash_words(uint32_t x, uint32_t y, uint32_t z) {
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

/// The same of four words.
HD inline Hash4 hash_words(uint32_t x, uint32_t y, uint32_t z, uint32_t w) {
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
