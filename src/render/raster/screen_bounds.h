#pragma once

// Conservative bounds of the part of the picture where rays may hit a triangle. The triangle is clipped in
// homogeneous coordinates to the cone of rays only, so that triangles behind, across or through the camera need no
// special case.
//
// Proof that it covers all rays that the ray-triangle test accepts: that test (trace/intersect/intersect_triangle.h)
// decides as an exact test of a triangle whose corners have moved by less than e in each coordinate. So a point q of
// the original triangle lies within e of a point q' of the ray, and q' lies in the cone of the ray's pixels.
// Therefore every clipping plane of the cone is moved out by e in its own measure, and so are the bounds of the
// result. Doubles round by 2^-53 of the sizes involved; e is 2^-18 of them (triangle_error), four times what boxes
// need.

#include "render/raster/clip_triangle.h"

namespace pertev {

struct PinholeTriangle {
    PinholePoint corners[3];
    double error; // e, in camera space, metres
};

/// Columns and rows of pixels, and the least depth.
struct ScreenBounds {
    int32_t left, right, top, bottom; // inclusive
    double depth;                     // lower bound of the depth of any hit, metres
};

/// Clamps `x` to [lo, hi], NaN to lo, and rounds down.
HD inline int32_t pixel_of(double x, int32_t lo, int32_t hi) {
    if (!(x > static_cast<double>(lo))) return lo;
    if (!(x < static_cast<double>(hi))) return hi;
    const auto i = static_cast<int32_t>(x);
    return static_cast<double>(i) > x ? i - 1 : i;
}

/// Bounds where rays of pixels in rows [top, bottom] may hit the triangle. Returns false if none may.
HD inline bool screen_bounds(const Pinhole& camera, const PinholeTriangle& triangle, uint32_t top, uint32_t bottom,
                             ScreenBounds& bounds) {
    const double reach_x = camera.filter_radius + camera.margin_x, reach_y = camera.filter_radius + camera.margin_y;
    const double x_lo = camera.x_of(0.5 - reach_x), x_hi = camera.x_of(camera.width - 0.5 + reach_x);
    const double y_lo = camera.y_of(top + 0.5 - reach_y), y_hi = camera.y_of(bottom + 0.5 + reach_y);
    const double e = triangle.error;
    // Size of e across a plane x = s w: e (1 + |s|), and e if w is 1.
    const double per_w = camera.is_perspective ? e : 0.0;
    const double e_x = e + per_w * x_hi, e_y = e + per_w * max(::fabs(y_lo), ::fabs(y_hi));

    ClippedTriangle seen;
    seen.count = 3;
    for (int i = 0; i < 3; ++i) seen.corners[i] = triangle.corners[i];
    clip(seen, {0, 0, 0, 1}, e);
    clip(seen, {1, 0, -x_lo, 0}, e_x);
    clip(seen, {-1, 0, x_hi, 0}, e_x);
    clip(seen, {0, 1, -y_lo, 0}, e_y);
    clip(seen, {0, -1, y_hi, 0}, e_y);
    if (seen.count == 0) return false;

    double left = x_hi, right = x_lo, up = y_hi, down = y_lo, depth = seen.corners[0].depth;
    for (int i = 0; i < seen.count; ++i) {
        const PinholePoint& p = seen.corners[i];
        depth = p.depth < depth ? p.depth : depth;
        if (!(p.w > 4 * e) && camera.is_perspective) { // so near to the eye that it may appear anywhere
            left = x_lo, right = x_hi, up = y_lo, down = y_hi;
            continue;
        }
        const double inv = 1 / p.w;
        left = min(left, (p.x - e_x) * inv), right = max(right, (p.x + e_x) * inv);
        up = min(up, (p.y - e_y) * inv), down = max(down, (p.y + e_y) * inv);
    }
    const auto columns = static_cast<int32_t>(camera.width), first = static_cast<int32_t>(top),
               last = static_cast<int32_t>(bottom);
    const double from_x = camera.column_of(left) - 0.5 - reach_x, to_x = camera.column_of(right) - 0.5 + reach_x;
    const double from_y = camera.row_of(up) - 0.5 - reach_y, to_y = camera.row_of(down) - 0.5 + reach_y;
    if (!(to_x >= 0 && from_x < columns && to_y >= first && from_y < last + 1)) return false;
    bounds.left = pixel_of(from_x, 0, columns - 1), bounds.right = pixel_of(to_x, 0, columns - 1);
    bounds.top = pixel_of(from_y, first, last), bounds.bottom = pixel_of(to_y, first, last);
    bounds.depth = depth - 2 * e; // one e for the position, one for the rounding of t
    return true;
}

} // namespace pertev
