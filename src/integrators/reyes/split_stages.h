#pragma once

// Bound, split and dice: pieces of triangles are taken off a stack, and what is in the picture either is a
// micropolygon, which goes into the samples at once and is forgotten, or leaves its children on the stack. So there are
// never more pieces than the stack holds, however many micropolygons the scene has.
//
// Source: Cook, Carpenter, Catmull, "The Reyes Image Rendering Architecture", SIGGRAPH 1987.

#include "device/atomic_add.h"
#include "integrators/reyes/hidden_piece.h"

namespace pertev {

struct PiecesView {
    Piece* stack;     // [capacity]
    Piece* under_way; // of the present round
    uint32_t* count;  // on the stack
    uint32_t capacity;
};

/// Piece i of a round: of `from_stack` those on top of the stack, then triangles `first_triangle` and on.
struct TakePieces {
    PiecesView pieces;
    uint32_t height, from_stack; // of the stack, before
    uint32_t first_triangle;

    HD void operator()(uint32_t i) const {
        if (i == 0) *pieces.count = height - from_stack;
        pieces.under_way[i] =
            i < from_stack ? pieces.stack[height - from_stack + i] : whole_triangle(first_triangle + (i - from_stack));
    }
};

/// Bit k: the edge from point k to the next one is to be halved.
HD inline uint32_t long_edges(const ReyesPass& pass, const DicedTriangle& triangle, const DicedPoint (&p)[3]) {
    uint32_t edges = 0;
    for (uint32_t k = 0; k < 3; ++k) {
        if (triangle.is_long(pass.camera, pass.rate, p[k], p[(k + 1) % 3])) edges |= 1u << k;
    }
    return edges;
}

template <HidingPass kPass>
struct SplitPieces {
    ReyesPass pass;
    PiecesView pieces;

    HD void operator()(uint32_t i) const {
        const Piece piece = pieces.under_way[i];
        DicedTriangle triangle;
        if (!triangle.begin(pass.camera, pass.picture.scene, pass.displacements, piece.triangle)) return;
        DicedPoint points[3];
        for (int k = 0; k < 3; ++k) points[k] = triangle.point(pass.camera.is_perspective, piece.corners[k]);
        if (triangle.is_outside(pass.camera, points) || is_hidden_piece(pass, triangle, points)) return;
        const uint32_t edges = piece.level < kMostLevels ? long_edges(pass, triangle, points) : 0;
        if (edges == 0) return hide_micropolygon<kPass>(pass, triangle, piece, points);
        const uint32_t children = child_count(edges), first = atomic_add(pieces.count, children);
        for (uint32_t k = 0; k < children && first + k < pieces.capacity; ++k) {
            pieces.stack[first + k] = child_of(piece, edges, k);
        }
    }
};

} // namespace pertev
