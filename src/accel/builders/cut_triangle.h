#pragma once

// Bounds of the two parts into which an axis-aligned plane cuts a triangle, rounded outwards. However often a
// triangle is cut, the boxes of its parts together hold every point of it, so no ray slips between them.
//
// Source: Stich, Friedrich, Dietrich, "Spatial Splits in Bounding Volume Hierarchies", HPG 2009, section 4.1 (edges
// are cut, and the results are intersected with the previous bounds).

#include "accel/bvh/bvh.h"
#include "math/bounds3.h"

namespace pertev {

struct ClippedBoxes {
    Bounds3 left, right; // left: where the coordinate is at most the plane's; empty if the triangle has no part there
};

inline Bounds3 intersection(const Bounds3& a, const Bounds3& b) { return {max(a.lo, b.lo), min(a.hi, b.hi)}; }

inline double magnitude(double x) { return x < 0 ? -x : x; }

/// Bounds of the point where the edge from a to b meets the plane. In double, (b - a) t is off by at most 5 units of
/// 2^-53 of |a| + |b|, and the sum by one more; rounding to float moves it by at most 2^-24 of itself, or by 2^-150
/// near 0.
inline Bounds3 box_of_crossing(Vec3 a, Vec3 b, int axis, float plane) {
    float lo[3], hi[3];
    const double pa = static_cast<double>(component(a, axis)), pb = static_cast<double>(component(b, axis));
    const double t = (static_cast<double>(plane) - pa) / (pb - pa);
    for (int k = 0; k < 3; ++k) {
        if (k == axis) {
            lo[k] = hi[k] = plane;
            continue;
        }
        const double from = static_cast<double>(component(a, k)), to = static_cast<double>(component(b, k));
        const double at = from + (to - from) * t;
        const double off = 0x1p-50 * (magnitude(from) + magnitude(to)) + 0x1p-23 * magnitude(at) + 0x1p-148;
        lo[k] = static_cast<float>(at - off), hi[k] = static_cast<float>(at + off);
    }
    return {{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}};
}

/// Returns the boxes of the triangle's parts on either side of the plane, clipped to `box`.
inline ClippedBoxes cut_triangle(const BvhTriangle& triangle, const Bounds3& box, int axis, float plane) {
    ClippedBoxes boxes;
    const Vec3 corners[3] = {triangle.a, triangle.b, triangle.c};
    for (int k = 0; k < 3; ++k) {
        const Vec3 a = corners[k], b = corners[(k + 1) % 3];
        const float pa = component(a, axis), pb = component(b, axis);
        if (pa <= plane) boxes.left.extend(a);
        if (pa >= plane) boxes.right.extend(a);
        if ((pa < plane && plane < pb) || (pb < plane && plane < pa)) {
            const Bounds3 crossing = box_of_crossing(a, b, axis, plane);
            boxes.left.extend(crossing);
            boxes.right.extend(crossing);
        }
    }
    boxes.left = intersection(boxes.left, box);
    boxes.right = intersection(boxes.right, box);
    return boxes;
}

} // namespace pertev
