#pragma once

// A piece of a triangle that is split into micropolygons. Edges that are too long in the picture are halved at their
// middle, so a piece becomes two, three or four. A piece without a long edge is a micropolygon.

#include <cstdint>

#include "base/host_device.h"
#include "math/vec2.h"

namespace pertev {

inline constexpr uint32_t kMaxLevels = 31; // levels of halving, two bits each in Piece::split_path
inline constexpr uint64_t kNoSplitPath = ~uint64_t(0);

struct Piece {
    Vec2 corners[3];     // weights of the triangle's second and third corner
    uint32_t triangle;   // number in the scene
    uint32_t level;      // number of splits
    uint64_t split_path; // index of the child at each split, from the top bits down; unique for each micropolygon of a
                         // triangle
};

HD inline Piece whole_triangle(uint32_t number) { return {{{0, 0}, {1, 0}, {0, 1}}, number, 0, 0}; }

/// Weights of the middle of a piece.
HD inline Vec2 middle_of(const Piece& piece) {
    constexpr float kThird = 1.0f / 3;
    return kThird * (piece.corners[0] + piece.corners[1] + piece.corners[2]);
}

/// Number of children. Bit k of `long_edges` means that the edge from corner k to the next one is halved.
HD inline uint32_t child_count(uint32_t long_edges) {
    const uint32_t edges = (long_edges & 1u) + (long_edges >> 1 & 1u) + (long_edges >> 2 & 1u);
    return edges == 0 ? 0 : edges + 1;
}

/// Child `number` of `piece`, with the same winding.
HD inline Piece child_of(const Piece& piece, uint32_t long_edges, uint32_t number) {
    const Vec2* c = piece.corners;
    const auto middle = [&](uint32_t edge) { return 0.5f * (c[edge] + c[(edge + 1) % 3]); };
    Piece child = piece;
    child.level = piece.level + 1;
    child.split_path = piece.split_path | uint64_t(number) << (2 * (kMaxLevels - 1 - piece.level));
    const auto set = [&](Vec2 x, Vec2 y, Vec2 z) { child.corners[0] = x, child.corners[1] = y, child.corners[2] = z; };
    if (long_edges == 7) {
        if (number < 3) {
            set(c[number], middle(number), middle((number + 2) % 3));
        } else {
            set(middle(0), middle(1), middle(2));
        }
        return child;
    }
    if ((long_edges & (long_edges - 1)) == 0) { // one long edge
        const uint32_t k = long_edges == 1 ? 0 : long_edges == 2 ? 1 : 2;
        const Vec2 p = c[k], q = c[(k + 1) % 3], r = c[(k + 2) % 3], m = middle(k);
        if (number == 0) {
            set(p, m, r);
        } else {
            set(m, q, r);
        }
        return child;
    }
    const uint32_t k = long_edges == 3 ? 0 : long_edges == 6 ? 1 : 2; // edges k and k + 1
    const Vec2 p = c[k], q = c[(k + 1) % 3], r = c[(k + 2) % 3], m = middle(k), n = middle((k + 1) % 3);
    if (number == 0) {
        set(m, q, n);
    } else if (number == 1) {
        set(p, m, n);
    } else {
        set(p, n, r);
    }
    return child;
}

/// The child on the path `split_path` below a piece at `level`.
HD inline uint32_t child_on_path(uint64_t split_path, uint32_t level) {
    return static_cast<uint32_t>(split_path >> (2 * (kMaxLevels - 1 - level))) & 3u;
}

} // namespace pertev
