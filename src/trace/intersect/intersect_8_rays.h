#pragma once

// intersect_triangle of one triangle for eight rays with the same dominant axis, host only: the same operations in
// the same order give the same bits.

#include <immintrin.h>

#include "accel/bvh/bvh.h"
#include "trace/intersect/intersect_triangle.h"
#include "trace/intersect/ray.h"

namespace pertev {

struct RayShear8 {
    int kx, ky, kz; // common to all eight
    __m256 sx, sy, sz;
    __m256 ox, oy, oz; // origins, in that order of axes
};

struct TriangleHit8 {
    alignas(32) float t[8], u[8], v[8];
};

/// Tests eight rays against a triangle. Bit k of the result is set if ray k of `requested` hits it with t_min < t <
/// t_max and t <= t_limit; its hit is in `hits`.
[[gnu::always_inline]] inline unsigned intersect_8_rays(const Ray* rays, const RayShear8& ray, __m256 t_min,
                                                        __m256 t_max, __m256 t_limit, const BvhTriangle& triangle,
                                                        unsigned requested, TriangleHit8& hits) {
    struct Vertex {
        __m256 x, y, z;
    };
    const auto sheared = [&](const Vec3& corner) {
        const float* const p = &corner.x;
        const __m256 z = _mm256_sub_ps(_mm256_broadcast_ss(p + ray.kz), ray.oz);
        return Vertex{_mm256_fnmadd_ps(ray.sx, z, _mm256_sub_ps(_mm256_broadcast_ss(p + ray.kx), ray.ox)),
                      _mm256_fnmadd_ps(ray.sy, z, _mm256_sub_ps(_mm256_broadcast_ss(p + ray.ky), ray.oy)), z};
    };
    const Vertex pa = sheared(triangle.a), pb = sheared(triangle.b), pc = sheared(triangle.c);
    const auto difference = [](__m256 a, __m256 b, __m256 c, __m256 d) {
        const __m256 cd = _mm256_mul_ps(c, d);
        return _mm256_add_ps(_mm256_fmsub_ps(a, b, cd), _mm256_fnmadd_ps(c, d, cd));
    };
    const __m256 ea = difference(pc.x, pb.y, pc.y, pb.x);
    const __m256 eb = difference(pa.x, pc.y, pa.y, pc.x);
    const __m256 ec = difference(pb.x, pa.y, pb.y, pa.x);
    const auto mask_of = [](__m256 lanes) { return static_cast<unsigned>(_mm256_movemask_ps(lanes)); };
    const __m256 sign = _mm256_set1_ps(-0.0f), sure = _mm256_set1_ps(kSureEdge);
    const __m256 below = _mm256_min_ps(ea, _mm256_min_ps(eb, ec)), above = _mm256_max_ps(ea, _mm256_max_ps(eb, ec));
    requested &= ~mask_of(_mm256_cmp_ps(_mm256_min_ps(_mm256_xor_ps(below, sign), above), sure, _CMP_GE_OQ));
    const __m256 least = _mm256_min_ps(_mm256_andnot_ps(sign, ea),
                                       _mm256_min_ps(_mm256_andnot_ps(sign, eb), _mm256_andnot_ps(sign, ec)));
    // Not "less than", so that NaN takes the slow path too, where it is a miss.
    unsigned slow = requested & mask_of(_mm256_cmp_ps(least, sure, _CMP_NGE_UQ));
    unsigned hit = requested & ~slow;
    if (hit != 0) {
        const __m256 det = _mm256_add_ps(_mm256_add_ps(ea, eb), ec); // not 0, because all have one sign and none is 0
        const __m256 inv = _mm256_div_ps(_mm256_set1_ps(1.0f), det);
        const __m256 u = _mm256_mul_ps(eb, inv), v = _mm256_mul_ps(ec, inv);
        const __m256 z = _mm256_add_ps(
            _mm256_add_ps(_mm256_mul_ps(_mm256_mul_ps(ea, inv), pa.z), _mm256_mul_ps(u, pb.z)), _mm256_mul_ps(v, pc.z));
        const __m256 at = _mm256_mul_ps(z, ray.sz);
        const __m256 in_range =
            _mm256_and_ps(_mm256_and_ps(_mm256_cmp_ps(at, t_min, _CMP_GT_OQ), _mm256_cmp_ps(at, t_max, _CMP_LT_OQ)),
                          _mm256_cmp_ps(at, t_limit, _CMP_LE_OQ));
        hit &= mask_of(in_range);
        _mm256_store_ps(hits.t, at);
        _mm256_store_ps(hits.u, u);
        _mm256_store_ps(hits.v, v);
    }
    for (; slow != 0; slow &= slow - 1) {
        const int k = __builtin_ctz(slow);
        TriangleHit one;
        if (!intersect_triangle(rays[k].origin, make_ray_shear(rays[k].direction), rays[k].t_min, rays[k].t_max,
                                triangle.a, triangle.b, triangle.c, one)) {
            continue;
        }
        alignas(32) float limits[8];
        _mm256_store_ps(limits, t_limit);
        if (one.t > limits[k]) continue;
        hits.t[k] = one.t, hits.u[k] = one.u, hits.v[k] = one.v;
        hit |= 1u << k;
    }
    return hit;
}

} // namespace pertev
