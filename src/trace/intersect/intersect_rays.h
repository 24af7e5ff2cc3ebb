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

/// Shears of rays (RayShear) and their origins, each in the order of its own axes.
template <class F>
struct RayShearLanes {
    F sx, sy, sz;
    F ox, oy, oz;
};

/// Shears of rays with common axes.
template <class F>
struct RayShearOf : RayShearLanes<F> {
    int kx, ky, kz;
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
    return {{columns[4 + kx] / dz, columns[4 + ky] / dz, 1.0f / dz, columns[kx], columns[ky], columns[kz]}, kx, ky, kz};
}

/// A triangle as rays see it: its edge functions, the depths of its corners, and what the edges say. Rays that pass
/// neither inside nor outside for sure are to be tested alone, by intersect_alone, because an edge function is nearly 0
/// or not a number.
template <class F>
struct TriangleEdgesOf {
    F a, b, c;
    F depth_a, depth_b, depth_c;
    MaskOf<F> is_inside, is_outside;
};

/// Edges of a triangle for each ray. `corner(k)` returns corner k, with its coordinates in the order of the ray's axes.
template <class F, class CornerOf>
[[gnu::always_inline]] inline TriangleEdgesOf<F> edges_of_corners(const RayShearLanes<F>& ray, const CornerOf& corner) {
    const auto sheared = [&](int k) __attribute__((always_inline)) {
        const Vec3Of<F> p = corner(k);
        const F z = p.z - ray.oz;
        return Vec3Of<F>{fma(-ray.sx, z, p.x - ray.ox), fma(-ray.sy, z, p.y - ray.oy), z};
    };
    const Vec3Of<F> pa = sheared(0), pb = sheared(1), pc = sheared(2);
    const auto difference = [](F a, F b, F c, F d) __attribute__((always_inline)) {
        const F cd = c * d;
        return fma(a, b, -cd) + fma(-c, d, cd);
    };
    const F ea = difference(pc.x, pb.y, pc.y, pb.x);
    const F eb = difference(pa.x, pc.y, pa.y, pc.x);
    const F ec = difference(pb.x, pa.y, pb.y, pa.x);
    const F below = min(ea, min(eb, ec)), above = max(ea, max(eb, ec));
    return {ea, eb, ec, pa.z, pb.z, pc.z, max(below, -above) >= kSureEdge, min(-below, above) >= kSureEdge};
}

/// Edges of one triangle for rays with common axes.
template <class F>
[[gnu::always_inline]] inline TriangleEdgesOf<F> edges_of(const RayShearOf<F>& ray, const BvhTriangle& triangle) {
    const Vec3* const corners[] = {&triangle.a, &triangle.b, &triangle.c};
    return edges_of_corners<F>(
        ray, [&](int k) __attribute__((always_inline)) {
            const float* const p = &corners[k]->x;
            return Vec3Of<F>{F(p[ray.kx]), F(p[ray.ky]), F(p[ray.kz])};
        });
}

/// Hits of the triangle's plane by rays that pass inside.
template <class F>
struct PlaneHitOf {
    F t, u, v;
};
template <class F>
[[gnu::always_inline]] inline PlaneHitOf<F> hit_plane(const RayShearLanes<F>& ray, const TriangleEdgesOf<F>& edges) {
    const F inv = 1.0f / (edges.a + edges.b + edges.c); // the sum is not 0, because all have one sign and none is 0
    const F u = edges.b * inv, v = edges.c * inv;
    return {(edges.a * inv * edges.depth_a + u * edges.depth_b + v * edges.depth_c) * ray.sz, u, v};
}

/// Rays of a packet, and how far a hit may be: t_min < t < t_max and t <= t_limit.
template <class F>
struct RayRangeOf {
    F t_min, t_max, t_limit;
    MaskOf<F> holds(F t) const { return t > t_min && t < t_max && t <= t_limit; }
};

/// Results of intersect_rays; one bit for each lane, that of lane 0 first.
template <class F>
struct TriangleHitsOf {
    PlaneHitOf<F> at; // valid in lanes that are hit
    unsigned hit = 0;
    unsigned slow = 0; // to be tested alone
};

/// Tests the rays of `requested`.
template <class F>
[[gnu::always_inline]] inline TriangleHitsOf<F> intersect_rays(const RayShearOf<F>& ray, const RayRangeOf<F>& range,
                                                               const BvhTriangle& triangle, unsigned requested) {
    const TriangleEdgesOf<F> edges = edges_of(ray, triangle);
    TriangleHitsOf<F> hits;
    requested &= ~bit_mask(edges.is_outside);
    if (requested == 0) return hits;
    hits.slow = requested & ~bit_mask(edges.is_inside);
    hits.at = hit_plane(ray, edges);
    hits.hit = requested & ~hits.slow & bit_mask(range.holds(hits.at.t));
    return hits;
}

/// The test of one ray that is left out by intersect_rays.
inline bool intersect_alone(const Ray& ray, float t_limit, const BvhTriangle& triangle, TriangleHit& hit) {
    return intersect_triangle(ray.origin, make_ray_shear(ray.direction), ray.t_min, ray.t_max, triangle.a, triangle.b,
                              triangle.c, hit) &&
           hit.t <= t_limit;
}

} // namespace pertev
