#pragma once

// intersect_triangle of one triangle for several rays with the same dominant axis, host only: the same operations in
// the same order give the same bits. `F` is Floats8 (math/lanes.h).

#include <array>
#include <cstdint>

#include "accel/bvh/bvh.h"
#include "math/lanes.h"
#include "trace/intersect/intersect_triangle.h"
#include "trace/intersect/ray.h"

namespace pertev {

template <class F>
struct RayShearOf {
    int kx, ky, kz; // common to all rays
    F sx, sy, sz;
    F ox, oy, oz; // origins, in that order of axes
};

/// Loads F::kLanes rays: origin, t_min, direction, t_max.
template <class F>
[[gnu::always_inline]] inline void load_rays(const Ray* rays, F (&columns)[8]) {
    static_assert(sizeof(Ray) == 8 * sizeof(float));
    std::array<const float*, F::kLanes> rows;
    for (uint32_t k = 0; k < F::kLanes; ++k) rows[k] = &rays[k].origin.x;
    load_columns(rows, columns);
}

/// Makes the shear of rays, as load_rays loads them, whose directions have their largest component along axis `kz`, as
/// make_ray_shear does for each.
template <class F>
[[gnu::always_inline]] inline RayShearOf<F> make_shear_of_rays(const F (&columns)[8], int kz) {
    const int kx = kz == 2 ? 0 : kz + 1, ky = kz == 0 ? 2 : kz - 1;
    const F dz = columns[4 + kz];
    return {kx, ky, kz, columns[4 + kx] / dz, columns[4 + ky] / dz, 1.0f / dz, columns[kx], columns[ky], columns[kz]};
}

/// Rays of a packet, and how far a hit may be: t_min < t < t_max and t <= t_limit.
template <class F>
struct RayRangeOf {
    F t_min, t_max, t_limit;
};

/// Results of intersect_rays; one bit for each lane, that of lane 0 first.
template <class F>
struct TriangleHitsOf {
    F t, u, v; // valid in lanes that are hit
    unsigned hit = 0;
    unsigned slow = 0; // to be tested alone, by intersect_alone, because an edge function is nearly 0
};

/// Tests the rays of `requested`.
template <class F>
[[gnu::always_inline]] inline TriangleHitsOf<F> intersect_rays(const RayShearOf<F>& ray, const RayRangeOf<F>& range,
                                                               const BvhTriangle& triangle, unsigned requested) {
    const auto sheared = [&](const Vec3& corner) __attribute__((always_inline)) {
        const float* const p = &corner.x;
        const F z = F(p[ray.kz]) - ray.oz;
        return Vec3Of<F>{fma(-ray.sx, z, F(p[ray.kx]) - ray.ox), fma(-ray.sy, z, F(p[ray.ky]) - ray.oy), z};
    };
    const Vec3Of<F> pa = sheared(triangle.a), pb = sheared(triangle.b), pc = sheared(triangle.c);
    const auto difference = [](F a, F b, F c, F d) __attribute__((always_inline)) {
        const F cd = c * d;
        return fma(a, b, -cd) + fma(-c, d, cd);
    };
    const F ea = difference(pc.x, pb.y, pc.y, pb.x);
    const F eb = difference(pa.x, pc.y, pa.y, pc.x);
    const F ec = difference(pb.x, pa.y, pb.y, pa.x);
    const F below = min(ea, min(eb, ec)), above = max(ea, max(eb, ec));
    TriangleHitsOf<F> hits;
    requested &= ~bit_mask(min(-below, above) >= kSureEdge);
    if (requested == 0) return hits;
    // Not "less than", so that NaN takes the slow path too, where it is a miss.
    hits.slow = requested & bit_mask(!(min(abs(ea), min(abs(eb), abs(ec))) >= kSureEdge));
    const F inv = 1.0f / (ea + eb + ec); // the sum is not 0, because all have one sign and none is 0
    hits.u = eb * inv, hits.v = ec * inv;
    hits.t = (ea * inv * pa.z + hits.u * pb.z + hits.v * pc.z) * ray.sz;
    hits.hit =
        requested & ~hits.slow & bit_mask(hits.t > range.t_min && hits.t < range.t_max && hits.t <= range.t_limit);
    return hits;
}

/// The test of one ray that is left out by intersect_rays.
inline bool intersect_alone(const Ray& ray, float t_limit, const BvhTriangle& triangle, TriangleHit& hit) {
    return intersect_triangle(ray.origin, make_ray_shear(ray.direction), ray.t_min, ray.t_max, triangle.a, triangle.b,
                              triangle.c, hit) &&
           hit.t <= t_limit;
}

} // namespace pertev
