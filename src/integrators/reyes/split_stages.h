#pragma once

// Bound, split and dice: pieces of triangles are taken off a stack. Those in the picture are either micropolygons,
// which are sampled at once and discarded, or push their children on the stack. Thus the stack limits the number of
// pieces, however many micropolygons the scene has.
//
// Source: Cook, Carpenter, Catmull, "The Reyes Image Rendering Architecture", SIGGRAPH 1987.

#include "device/atomics.h"
#include "integrators/reyes/hide_micropolygon.h"

namespace pertev {

// Culling of pieces that cannot be visible: hidden backs, and pieces behind everything that the samples there show
// already. Such a piece has no nearest micropolygon, so the time of its culling does not change the picture.

/// Returns whether a piece is behind everything visible in all pixels that it may cover. Only tested if these are few;
/// otherwise its children will be.
HD inline bool is_behind(const ReyesPass& pass, const DicedTriangle& triangle, const DicedPoint (&p)[3]) {
    constexpr int32_t kMaxSamplesOnce = 64;
    const Pinhole& camera = pass.camera;
    const double reach = triangle.reach, per_w = camera.is_perspective ? reach : 0;
    const double off_x = reach + per_w * camera.x_of(camera.width + camera.filter_radius + 2);
    const double off_y = reach + per_w * camera.y_of(camera.height + camera.filter_radius + 2);
    double left = 0, right = 0, up = 0, down = 0, nearest = 0;
    for (int i = 0; i < 3; ++i) {
        const PinholePoint& q = p[i].base;
        if (q.depth < kNearest || (camera.is_perspective && !(q.w > 4 * reach))) return false;
        const double inv = 1 / q.w, x_lo = (q.x - off_x) * inv, x_hi = (q.x + off_x) * inv;
        const double y_lo = (q.y - off_y) * inv, y_hi = (q.y + off_y) * inv;
        left = i == 0 ? x_lo : min(left, x_lo), right = i == 0 ? x_hi : max(right, x_hi);
        up = i == 0 ? y_lo : min(up, y_lo), down = i == 0 ? y_hi : max(down, y_hi);
        nearest = i == 0 ? q.depth : min(nearest, q.depth);
    }
    const SampleLists& samples = pass.samples;
    const int32_t first_column = samples.column_of(to_subpixels(camera.column_of(left)) - 1);
    const int32_t last_column = samples.column_of(to_subpixels(camera.column_of(right)) + 1);
    const int32_t first_row = samples.row_of(to_subpixels(camera.row_of(up)) - 1);
    const int32_t last_row = samples.row_of(to_subpixels(camera.row_of(down)) + 1);
    if (int64_t(last_column - first_column + 1) * (last_row - first_row + 1) > kMaxSamplesOnce) return false;
    const auto depth = static_cast<float>((nearest - reach) * (1 - 0x1p-20)); // margin for rounding
    for (int32_t row = first_row; row <= last_row; ++row) {
        for (int32_t column = first_column; column <= last_column; ++column) {
            if (!(depth > samples.far_of(column, row))) return false;
        }
    }
    return true;
}

HD inline bool is_hidden_piece(const ReyesPass& pass, const DicedTriangle& triangle, const DicedPoint (&p)[3]) {
    if (triangle.placed->hides_back != 0 && triangle.displacement == nullptr) {
        const PinholePoint corners[3] = {p[0].base, p[1].base, p[2].base};
        if (is_hidden_back(*triangle.placed, plane_of(corners, pass.camera.is_perspective))) return true;
    }
    return is_behind(pass, triangle, p);
}

struct PiecesView {
    Piece* stack;    // [capacity]
    Piece* current;  // pieces of the current round
    uint32_t* count; // pieces on the stack
    uint32_t capacity;
};

/// The stage that takes piece i of a round: `from_stack` pieces from the top of the stack, then triangles from
/// `first_triangle` on.
struct TakePieces {
    PiecesView pieces;
    uint32_t height, from_stack; // `height` of the stack before the round
    uint32_t first_triangle;

    HD void operator()(uint32_t i) const {
        if (i == 0) *pieces.count = height - from_stack;
        pieces.current[i] =
            i < from_stack ? pieces.stack[height - from_stack + i] : whole_triangle(first_triangle + (i - from_stack));
    }
};

/// Edges that must be halved: bit k means the edge from point k to the next one.
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
        const Piece piece = pieces.current[i];
        DicedTriangle triangle;
        if (!triangle.begin(pass.camera, pass.picture.scene, pass.displacements, piece.triangle)) return;
        DicedPoint points[3];
        for (int k = 0; k < 3; ++k) points[k] = triangle.point(pass.camera.is_perspective, piece.corners[k]);
        if (triangle.is_outside(pass.camera, points) || is_hidden_piece(pass, triangle, points)) return;
        const uint32_t edges = piece.level < kMaxLevels ? long_edges(pass, triangle, points) : 0;
        if (edges == 0) return hide_micropolygon<kPass>(pass, triangle, piece, points);
        const uint32_t children = child_count(edges), first = atomic_add(pieces.count, children);
        for (uint32_t k = 0; k < children && first + k < pieces.capacity; ++k) {
            pieces.stack[first + k] = child_of(piece, edges, k);
        }
    }
};

} // namespace pertev
