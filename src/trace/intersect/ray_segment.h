#pragma once

// A ray as a segment for box tests: from its origin to the parameter `end`, beyond which nothing is relevant,
// parametrized from 0 to 1. So the multiply-add that computes the crossing of a plane clamps for free (it saturates
// to [0, 1]): crossings behind the origin become 0 on both sides, those beyond the end 1, and a box is entered if and
// only if its exit is later than its entry. t_min is ignored: a box before it is entered unnecessarily. A hit
// shortens the segment.
//
// Box tests move planes out by e = 16 u S, u = 2^-24, S = |origin|max + |bounds|max, as ray_boxes.h does, and count
// rounding errors as shifts of a plane. The error of 1/d, d = direction * end, is at most three u S: one for d, two
// for its reciprocal (the device's is approximate).
//
// Why strictly later is enough: to its end the ray moves by at most slightly more than S, so u S of its length is
// about u of 1. If a test's own rounding and the triangle test's (6 u S) leave 3 of the 16, a hit at 1 or before is
// later than the entry and earlier than the exit by more than 2 u, before both are clamped and thus afterwards.
//
// The guard: |d_i| < 2^-40 S (and 2^-100 m) counts as that much, so that everything is finite. Along such an axis the
// ray moves, to its end, by less than 2^-40 S, far less than e. (The 2^-100 m are, for S from 2^-76 m on.) Shortening
// multiplies 1/d by the ratio of the ends: four roundings more, at most 4 u S, by which e grows each time.
//
// The arithmetic was developed for this file.

#include <cstdint>

#include "base/host_device.h"
#include "math/scalar.h"
#include "math/vec3.h"
#include "trace/intersect/fast_min_max.h"
#include "trace/intersect/ray.h"
#include "trace/intersect/ray_boxes.h"
#include "trace/intersect/ray_tests.h"

namespace pertev {

/// fma(a, b, c) clamped to [0, 1]; one instruction on the device.
HD inline float fma_saturated(float a, float b, float c) {
#if PERTEV_ON_DEVICE && !defined(PERTEV_EMULATED_WARPS)
    float r;
    asm("fma.rn.sat.f32 %0, %1, %2, %3;" : "=f"(r) : "f"(a), "f"(b), "f"(c));
    return r;
#else
    return clamp(fma(a, b, c), 0.0f, 1.0f);
#endif
}

/// Data of a ray for box tests, besides its origin.
struct RaySegment {
    Vec3 inv;   // 1 / (direction * end), guarded
    float grow; // distance by which planes move out, metres
    float end;  // the ray's parameter where the segment ends

    /// Makes parameters beyond t irrelevant; t >= 0. The segment stays at least 2^-24 S long, so that 1/d stays
    /// finite. (It takes few instructions, because only lanes that hit something run it.)
    HD void shorten(float t) {
        const float slowest = fast_min(fast_min(abs(inv.x), abs(inv.y)), abs(inv.z));
        const float now = fast_max(t, 0x1p-4f * grow * slowest * end); // 1 / (slowest * end) is |direction|max
        if (!(now < end)) return;
        inv = inv * (end * fast_reciprocal(now));
        grow *= 1.25f;
        end = now;
    }
};

/// Makes the segment of the ray up to `limit`, clipped to bounds that reach to bounds_max_abs from the coordinates'
/// origin.
template <class Tests>
HD inline RaySegment make_ray_segment(const Ray& ray, float bounds_max_abs, float limit) {
    RaySegment r;
    r.grow = Tests::box_growth(ray, bounds_max_abs);
    const float reach = greatest_size(ray.origin) + bounds_max_abs;
    const float last = reach * fast_reciprocal(greatest_size(ray.direction)) * (1 + 0x1p-10f);
    r.end = fast_max(fast_min(limit, last), 0x1p-100f);
    const float least = fast_max(0x1p-20f * r.grow, 0x1p-100f);
    const auto invert = [&](float d) {
        const float move = d * r.end;
        return fast_reciprocal(abs(move) < least ? copysign(least, move) : move);
    };
    r.inv = {invert(ray.direction.x), invert(ray.direction.y), invert(ray.direction.z)};
    return r;
}

} // namespace pertev
