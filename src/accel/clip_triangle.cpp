#include "accel/clip_triangle.h"

namespace pertev {
namespace {

struct Point {
    double at[3];
};

struct Polygon {
    Point points[10]; // a triangle has at most 3 + 6 after six cuts
    int count = 0;
};

/// Clips a polygon to the points with sign * at[axis] <= sign * plane.
void cut(Polygon& polygon, int axis, double plane, double sign) {
    bool all = true;
    for (int i = 0; i < polygon.count; ++i) all = all && sign * (polygon.points[i].at[axis] - plane) <= 0;
    if (all) return;
    Polygon kept;
    for (int i = 0; i < polygon.count; ++i) {
        const Point &a = polygon.points[i], &b = polygon.points[i + 1 < polygon.count ? i + 1 : 0];
        const double da = sign * (a.at[axis] - plane), db = sign * (b.at[axis] - plane);
        if (da <= 0) kept.points[kept.count++] = a;
        if ((da < 0 && db > 0) || (da > 0 && db < 0)) {
            const double s = da / (da - db);
            Point& p = kept.points[kept.count++];
            for (int k = 0; k < 3; ++k) p.at[k] = a.at[k] + s * (b.at[k] - a.at[k]);
            p.at[axis] = plane;
        }
    }
    polygon = kept;
}

float step_down(float x) {
    if (x == 0) return float_of(0x80000001u);
    return float_of(x > 0 ? bits_of(x) - 1 : bits_of(x) + 1);
}
float round_down(double x) {
    const float f = static_cast<float>(x);
    return static_cast<double>(f) > x ? step_down(f) : f;
}
float round_up(double x) { return -round_down(-x); }

Point to_point(Vec3 p) { return {{static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)}}; }

} // namespace

Bounds3 clip_triangle(const BvhTriangle& triangle, const Bounds3& cell, double slack) {
    Polygon polygon;
    polygon.points[0] = to_point(triangle.a);
    polygon.points[1] = to_point(triangle.b);
    polygon.points[2] = to_point(triangle.c);
    polygon.count = 3;
    for (int axis = 0; axis < 3; ++axis) {
        cut(polygon, axis, static_cast<double>(component(cell.lo, axis)) - slack, -1);
        cut(polygon, axis, static_cast<double>(component(cell.hi, axis)) + slack, 1);
        if (polygon.count == 0) return {};
    }
    Point lo = polygon.points[0], hi = lo;
    for (int i = 1; i < polygon.count; ++i) {
        for (int k = 0; k < 3; ++k) {
            lo.at[k] = min(lo.at[k], polygon.points[i].at[k]);
            hi.at[k] = max(hi.at[k], polygon.points[i].at[k]);
        }
    }
    const Bounds3 whole = bounds_of(triangle);
    const Vec3 low = {round_down(lo.at[0] - slack), round_down(lo.at[1] - slack), round_down(lo.at[2] - slack)};
    const Vec3 high = {round_up(hi.at[0] + slack), round_up(hi.at[1] + slack), round_up(hi.at[2] + slack)};
    const Bounds3 part = {max(low, max(whole.lo, cell.lo)), min(high, min(whole.hi, cell.hi))};
    return part.is_empty() ? Bounds3{} : part;
}

} // namespace pertev
