#pragma once

// A ray prepared for the box tests of one tree. The tests are conservative: no box that holds a hit is ever missed.
//
// Every plane moves out by e = 2^-20 (|origin|max + |bounds|max), which is 16 units of 2^-24 of that sum S. The
// parameter of a plane p is computed as fma(p, 1/d, -((o +- e) (1/d))). In terms of shifts of the plane, its rounding
// errors are at most: one unit of |o| + e for o +- e, one for its product, one of |p - o| + e for the fma, one for
// 1/d itself; in total slightly more than 4 S units. The triangle test's own error is at most 6, so 16 cover both,
// and an entry parameter computed here is never greater than the t of a hit inside the box. |1/d| <= 2^80 and |p|,
// |o| <= 2^40 keep everything finite.

#include "accel/bvh/bvh.h"
#include "base/host_device.h"
#include "trace/intersect/fast_min_max.h"
#include "trace/intersect/ray.h"

namespace pertev {

// Operands of fast_min and fast_max are never NaN here, and no picture depends on the sign of a zero entry.

// Least and greatest of three from their bits as integers, in one device instruction. That is exact for non-negative
// numbers. The order of negative ones is reversed, so an entry may be too small and an exit too large: a box is then
// entered unnecessarily, but never missed.
HD inline float greatest_bits(float a, float b, float c) {
    const int x = static_cast<int>(bits_of(a)), y = static_cast<int>(bits_of(b)), z = static_cast<int>(bits_of(c));
    return float_of(static_cast<uint32_t>(max(max(x, y), z)));
}
HD inline float min_bits(float a, float b, float c) {
    const int x = static_cast<int>(bits_of(a)), y = static_cast<int>(bits_of(b)), z = static_cast<int>(bits_of(c));
    return float_of(static_cast<uint32_t>(min(min(x, y), z)));
}

/// The greatest |component|; a NaN may be ignored.
HD inline float greatest_size(Vec3 v) { return fast_max(abs(v.x), fast_max(abs(v.y), abs(v.z))); }

struct RayBoxes {
    Vec3 inv; // 1 / direction; a component near 0 counts as +-2^-80
    Vec3 lo;  // -(origin + e) / direction: maps a lower plane, moved out, to its parameter
    Vec3 hi;  // -(origin - e) / direction
};

HD inline float guard_direction(float d) { return abs(d) < 0x1p-80f ? copysign(0x1p-80f, d) : d; }

/// Distance e by which planes move out.
HD inline float box_growth(Vec3 origin, float bounds_max_abs) {
    return 0x1p-20f * (greatest_size(origin) + bounds_max_abs);
}

/// Makes the data of a ray for box tests. `bounds_max_abs` belongs to the whole tree; `growth` multiplies e (1 within a
/// mesh).
HD inline RayBoxes make_ray_boxes(Vec3 origin, Vec3 direction, float bounds_max_abs, float growth = 1.0f) {
    const float e = box_growth(origin, bounds_max_abs) * growth;
    RayBoxes r;
    r.inv = {1.0f / guard_direction(direction.x), 1.0f / guard_direction(direction.y),
             1.0f / guard_direction(direction.z)};
    r.lo = {-((origin.x + e) * r.inv.x), -((origin.y + e) * r.inv.y), -((origin.z + e) * r.inv.z)};
    r.hi = {-((origin.x - e) * r.inv.x), -((origin.y - e) * r.inv.y), -((origin.z - e) * r.inv.z)};
    return r;
}

/// Returns whether a box may hold a hit with t_min < t <= t_limit; writes its entry parameter to `entry`.
HD inline bool enters_box(const RayBoxes& r, Vec3 lower, Vec3 upper, float t_min, float t_limit, float& entry) {
    const float x0 = fma(lower.x, r.inv.x, r.lo.x), x1 = fma(upper.x, r.inv.x, r.hi.x);
    const float y0 = fma(lower.y, r.inv.y, r.lo.y), y1 = fma(upper.y, r.inv.y, r.hi.y);
    const float z0 = fma(lower.z, r.inv.z, r.lo.z), z1 = fma(upper.z, r.inv.z, r.hi.z);
#if PERTEV_ON_DEVICE
    entry = fast_max(greatest_bits(fast_min(x0, x1), fast_min(y0, y1), fast_min(z0, z1)), t_min);
    const float exit = fast_min(min_bits(fast_max(x0, x1), fast_max(y0, y1), fast_max(z0, z1)), t_limit);
#else
    entry = fast_max(fast_max(fast_min(x0, x1), fast_min(y0, y1)), fast_max(fast_min(z0, z1), t_min));
    const float exit = fast_min(fast_min(fast_max(x0, x1), fast_max(y0, y1)), fast_min(fast_max(z0, z1), t_limit));
#endif
    return entry <= exit;
}

/// Returns whether the box of child k may hold a hit, like enters_box.
HD inline bool enters_child(const RayBoxes& r, const BvhNode& node, int k, float t_min, float t_limit, float& entry) {
    return enters_box(r, {node.x[k], node.y[k], node.z[k]}, {node.x[k + 2], node.y[k + 2], node.z[k + 2]}, t_min,
                      t_limit, entry);
}

} // namespace pertev
