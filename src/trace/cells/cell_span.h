#pragma once

// The part of a ray inside a cell of a kd-tree or an octree, grown as boxes are.
//
// Why no hit is lost: planes move out by the e of ray_boxes.h, with the same products. So the span that a traversal
// reaches by clipping equals, to the bit, what enters_child would find for the cell's own box, because min and max
// are exact. It contains every t whose point lies within e of the cell, including errors of the triangle test. A hit
// is such a t for every cell that contains the point of the triangle that it stands for, and a leaf that contains
// this point lists the triangle. At a plane the spans of both sides overlap by the effect of e, so if rounding could
// decide the side, both are visited. For a ray along the plane (|d| under 2^-80 counts as 2^-80) the same rule makes
// spans whole or empty.

#include "base/host_device.h"
#include "math/bounds3.h"
#include "trace/intersect/fast_min_max.h"
#include "trace/intersect/ray_boxes.h"

namespace pertev {

struct CellSpan {
    float entry, exit; // ray parameters; entry > exit: the ray misses the cell
};

/// The span of the whole bounds within t_min <= t <= t_max.
HD inline CellSpan span_of_bounds(const RayBoxes& r, const Bounds3& bounds, float t_min, float t_max) {
    const float x0 = fma(bounds.lo.x, r.inv.x, r.lo.x), x1 = fma(bounds.hi.x, r.inv.x, r.hi.x);
    const float y0 = fma(bounds.lo.y, r.inv.y, r.lo.y), y1 = fma(bounds.hi.y, r.inv.y, r.hi.y);
    const float z0 = fma(bounds.lo.z, r.inv.z, r.lo.z), z1 = fma(bounds.hi.z, r.inv.z, r.hi.z);
    return {fast_max(fast_max(fast_min(x0, x1), fast_min(y0, y1)), fast_max(fast_min(z0, z1), t_min)),
            fast_min(fast_min(fast_max(x0, x1), fast_max(y0, y1)), fast_min(fast_max(z0, z1), t_max))};
}

/// The parameters at which a ray crosses a plane that has moved out of the cell below it, and out of the one above.
struct PlaneCrossing {
    float below, above;
    bool forward; // the ray comes from below
};

HD inline PlaneCrossing cross_plane(const RayBoxes& r, int axis, float plane) {
    const float inv = component(r.inv, axis);
    return {fma(plane, inv, component(r.hi, axis)), fma(plane, inv, component(r.lo, axis)), inv > 0};
}

HD inline CellSpan span_below(CellSpan s, const PlaneCrossing& p) {
    return p.forward ? CellSpan{s.entry, fast_min(s.exit, p.below)} : CellSpan{fast_max(s.entry, p.below), s.exit};
}
HD inline CellSpan span_above(CellSpan s, const PlaneCrossing& p) {
    return p.forward ? CellSpan{fast_max(s.entry, p.above), s.exit} : CellSpan{s.entry, fast_min(s.exit, p.above)};
}

/// Returns whether the cell may hold a relevant hit.
HD inline bool is_entered(CellSpan s, float t_limit) { return s.entry <= s.exit && s.entry <= t_limit; }

} // namespace pertev
