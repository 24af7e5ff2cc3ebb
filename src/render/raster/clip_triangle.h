#pragma once

// Clips a triangle by planes in the homogeneous space of a Pinhole, before any division.
//
// Source: Sutherland, Hodgman, "Reentrant Polygon Clipping", CACM 17(1), 1974.

#include "render/raster/pinhole.h"

namespace pertev {

inline constexpr int kMaxCorners = 12; // eight after five planes, plus corners that rounding puts on both sides

struct ClippedTriangle {
    PinholePoint corners[kMaxCorners];
    int count;
};

/// Clips a polygon to the part with a . p + constant >= 0; it does not change if that has too many corners.
HD inline void clip(ClippedTriangle& polygon, PinholePoint a, double constant) {
    const auto side = [&](const PinholePoint& p) {
        return a.x * p.x + a.y * p.y + a.w * p.w + a.depth * p.depth + constant;
    };
    ClippedTriangle kept;
    kept.count = 0;
    if (polygon.count == 0) return;
    PinholePoint before = polygon.corners[polygon.count - 1];
    double side_before = side(before);
    for (int i = 0; i < polygon.count; ++i) {
        const PinholePoint p = polygon.corners[i];
        const double side_p = side(p);
        if (kept.count > kMaxCorners - 2) return;
        if ((side_p < 0) != (side_before < 0)) {
            // Computed from the point that is kept, in either direction, so that neighbours get the same point on
            // their edge.
            const bool leaves = side_p < 0;
            const PinholePoint from = leaves ? before : p, to = leaves ? p : before;
            const double t = leaves ? side_before / (side_before - side_p) : side_p / (side_p - side_before);
            kept.corners[kept.count++] = {from.x + t * (to.x - from.x), from.y + t * (to.y - from.y),
                                          from.w + t * (to.w - from.w), from.depth + t * (to.depth - from.depth)};
        }
        if (!(side_p < 0)) kept.corners[kept.count++] = p;
        before = p;
        side_before = side_p;
    }
    polygon = kept;
}

} // namespace pertev
