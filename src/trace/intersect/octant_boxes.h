#pragma once

// Box tests of a binary node for a ray whose octant is known at compile time: the order in which an axis's planes are
// crossed is fixed, and the ray is a segment (ray_segment.h), so nothing needs clamping. A box takes 9 instructions
// instead of the 17 of ray_boxes.h, and the test is as conservative.
//
// Rounding errors as shifts of a plane (u, S: ray_segment.h): three u S for 1/d, one for o +- e, one for its product,
// one for the fma; in total slightly more than 6 u S, which with the triangle test's 6 leaves 4 of 16.

#include "accel/bvh/bvh.h"
#include "base/host_device.h"
#include "trace/intersect/fast_min_max.h"
#include "trace/intersect/ray_boxes.h"
#include "trace/intersect/ray_segment.h"

namespace pertev {

/// Number of an unknown octant.
inline constexpr int kAnyOctant = 8;

struct RayOctantBoxes {
    RaySegment segment;
    Vec3 lo; // -(origin + e) / d: maps a lower plane, moved out, to the ray's crossing
    Vec3 hi; // -(origin - e) / d

    /// Computes the planes from the segment, after each of its changes; `origin` is the ray's.
    HD void set_planes(Vec3 origin) {
        const Vec3 inv = segment.inv;
        const float e = segment.grow;
        lo = {-((origin.x + e) * inv.x), -((origin.y + e) * inv.y), -((origin.z + e) * inv.z)};
        hi = {-((origin.x - e) * inv.x), -((origin.y - e) * inv.y), -((origin.z - e) * inv.z)};
    }
};

template <class Tests>
HD inline RayOctantBoxes make_ray_octant_boxes(const Ray& ray, float bounds_max_abs, float limit) {
    RayOctantBoxes r;
    r.segment = make_ray_segment<Tests>(ray, bounds_max_abs, limit);
    r.set_planes(ray.origin);
    return r;
}

/// Octant of a ray's direction: bit a is set if it is negative along axis a.
HD inline int octant_of(Vec3 inv) { return (inv.x < 0 ? 1 : 0) | (inv.y < 0 ? 2 : 0) | (inv.z < 0 ? 4 : 0); }

/// Returns whether the box of child k may hold a hit with 0 < t <= r.segment.end; it is entered at entry *
/// r.segment.end or later. kOctant is the ray's, or kAnyOctant.
template <int kOctant>
HD inline bool enters_child(const RayOctantBoxes& r, const BvhNode& node, int k, float& entry) {
    const auto cross = [k](int axis, const float(&planes)[4], float inv, float lo, float hi, float& near, float& far) {
        const float a = fma_saturated(planes[k], inv, lo), b = fma_saturated(planes[k + 2], inv, hi);
        const bool backwards = (kOctant >> axis & 1) != 0;
        near = kOctant == kAnyOctant ? fast_min(a, b) : backwards ? b : a;
        far = kOctant == kAnyOctant ? fast_max(a, b) : backwards ? a : b;
    };
    const Vec3 inv = r.segment.inv;
    float near_x, near_y, near_z, far_x, far_y, far_z;
    cross(0, node.x, inv.x, r.lo.x, r.hi.x, near_x, far_x);
    cross(1, node.y, inv.y, r.lo.y, r.hi.y, near_y, far_y);
    cross(2, node.z, inv.z, r.lo.z, r.hi.z, near_z, far_z);
    entry = greatest_bits(near_x, near_y, near_z);
    return entry < min_bits(far_x, far_y, far_z);
}

} // namespace pertev
