#pragma once

// intersect_triangle for four triangles at once, host only: the same operations in the same order give the same bits,
// which tests/consistency/traversals_test.cpp checks.

#include <immintrin.h>

#include <type_traits>

#include "accel/bvh/bvh.h"
#include "trace/intersect/intersect_triangle.h"
#include "trace/intersect/ray.h"

namespace pertev {

struct RayShear4 {
    __m128i order; // kx, ky, kz; the fourth stays
    __m128 sx, sy, sz;
    __m128 ox, oy, oz; // origin, in that order of axes
};

/// Returns the axis along which a direction has its largest component, kz of make_ray_shear. It does not branch,
/// because that axis is unpredictable, and a misprediction costs a quarter of a node.
inline int dominant_axis(Vec3 direction) {
    const Vec3 size = abs(direction);
    const int x_y = size.x >= size.y, x_z = size.x >= size.z, y_z = size.y >= size.z;
    return 2 - 2 * (x_y & x_z) - ((x_y ^ 1) & y_z);
}

/// Makes the shear of make_ray_shear, also as vectors, without a branch.
inline RayShear4 make_ray_shear_4(const Ray& ray, RayShear& shear) {
    const int kz = dominant_axis(ray.direction);
    const int kx = (0b00'10'01 >> 2 * kz) & 3, ky = (0b01'00'10 >> 2 * kz) & 3; // the next two axes in cyclic order
    const __m128i order = _mm_setr_epi32(kx, ky, kz, 3);
    const __m128 direction = _mm_permutevar_ps(_mm_loadu_ps(&ray.direction.x), order);
    const __m128 dz = _mm_shuffle_ps(direction, direction, 0xaa);
    const __m128 slopes = _mm_div_ps(_mm_blend_ps(direction, _mm_set1_ps(1.0f), 4), dz);
    const __m128 origin = _mm_permutevar_ps(_mm_loadu_ps(&ray.origin.x), order);
    const auto lane = [](__m128 v, auto k) { return _mm_shuffle_ps(v, v, k * 0x55); };
    using std::integral_constant;
    constexpr integral_constant<int, 0> k0;
    constexpr integral_constant<int, 1> k1;
    constexpr integral_constant<int, 2> k2;
    const RayShear4 four = {
        order,           lane(slopes, k0), lane(slopes, k1), lane(slopes, k2), lane(origin, k0), lane(origin, k1),
        lane(origin, k2)};
    shear = {kx, ky, kz, _mm_cvtss_f32(four.sx), _mm_cvtss_f32(four.sy), _mm_cvtss_f32(four.sz)};
    return four;
}

struct TriangleHit4 {
    alignas(16) float t[4], u[4], v[4];
};

/// Tests `count` triangles from `first` on, at most 4. Bit k of the result is set if triangle k is hit with t_min < t <
/// t_max and t <= t_limit; its hit is in `hits`.
inline unsigned intersect_4_triangles(Vec3 origin, const RayShear& shear, const RayShear4& ray, float t_min,
                                      float t_max, float t_limit, const BvhTriangle* first, uint32_t count,
                                      TriangleHit4& hits) {
    struct Vertex {
        __m128 x, y, z;
    };
    const BvhTriangle* t[4] = {first, first + (count > 1 ? 1 : 0), first + (count > 2 ? 2 : 0),
                               first + (count > 3 ? 3 : 0)};
    // Inlined, because its vectors would otherwise go through memory three times.
    const auto sheared = [&](const Vec3 BvhTriangle::*corner) __attribute__((always_inline)) {
        const auto load = [&](int k) { return _mm_permutevar_ps(_mm_load_ps(&(t[k]->*corner).x), ray.order); };
        __m128 r0 = load(0), r1 = load(1), r2 = load(2), r3 = load(3);
        _MM_TRANSPOSE4_PS(r0, r1, r2, r3);
        const __m128 z = _mm_sub_ps(r2, ray.oz);
        return Vertex{_mm_fnmadd_ps(ray.sx, z, _mm_sub_ps(r0, ray.ox)),
                      _mm_fnmadd_ps(ray.sy, z, _mm_sub_ps(r1, ray.oy)), z};
    };
    const Vertex pa = sheared(&BvhTriangle::a), pb = sheared(&BvhTriangle::b), pc = sheared(&BvhTriangle::c);

    const auto difference = [](__m128 a, __m128 b, __m128 c, __m128 d) {
        const __m128 cd = _mm_mul_ps(c, d);
        return _mm_add_ps(_mm_fmsub_ps(a, b, cd), _mm_fnmadd_ps(c, d, cd));
    };
    const __m128 ea = difference(pc.x, pb.y, pc.y, pb.x);
    const __m128 eb = difference(pa.x, pc.y, pa.y, pc.x);
    const __m128 ec = difference(pb.x, pa.y, pb.y, pa.x);
    const __m128 sign = _mm_set1_ps(-0.0f), sure = _mm_set1_ps(kSureEdge);
    const auto mask_of = [](__m128 lanes) { return static_cast<unsigned>(_mm_movemask_ps(lanes)); };
    const __m128 below = _mm_min_ps(ea, _mm_min_ps(eb, ec)), above = _mm_max_ps(ea, _mm_max_ps(eb, ec));
    const unsigned missed = mask_of(_mm_cmpge_ps(_mm_min_ps(_mm_xor_ps(below, sign), above), sure));
    const unsigned requested = ((1u << count) - 1) & ~missed;
    const __m128 least =
        _mm_min_ps(_mm_andnot_ps(sign, ea), _mm_min_ps(_mm_andnot_ps(sign, eb), _mm_andnot_ps(sign, ec)));
    // Not "less than", so that NaN takes the slow path too, where it is a miss.
    unsigned slow = requested & mask_of(_mm_cmpnge_ps(least, sure));
    unsigned hit = requested & ~slow;
    if ((hit | slow) == 0) return 0;
    if (hit != 0) {
        const __m128 det = _mm_add_ps(_mm_add_ps(ea, eb), ec); // not 0, because all have one sign and none is 0
        const __m128 inv = _mm_div_ps(_mm_set1_ps(1.0f), det);
        const __m128 u = _mm_mul_ps(eb, inv), v = _mm_mul_ps(ec, inv);
        const __m128 z =
            _mm_add_ps(_mm_add_ps(_mm_mul_ps(_mm_mul_ps(ea, inv), pa.z), _mm_mul_ps(u, pb.z)), _mm_mul_ps(v, pc.z));
        const __m128 at = _mm_mul_ps(z, ray.sz);
        const __m128 in_range =
            _mm_and_ps(_mm_and_ps(_mm_cmpgt_ps(at, _mm_set1_ps(t_min)), _mm_cmplt_ps(at, _mm_set1_ps(t_max))),
                       _mm_cmple_ps(at, _mm_set1_ps(t_limit)));
        hit &= mask_of(in_range);
        _mm_store_ps(hits.t, at);
        _mm_store_ps(hits.u, u);
        _mm_store_ps(hits.v, v);
    }
    for (; slow != 0; slow &= slow - 1) {
        const int k = __builtin_ctz(slow);
        TriangleHit one;
        if (!intersect_triangle(origin, shear, t_min, t_max, t[k]->a, t[k]->b, t[k]->c, one) || one.t > t_limit)
            continue;
        hits.t[k] = one.t, hits.u[k] = one.u, hits.v[k] = one.v;
        hit |= 1u << k;
    }
    return hit;
}

} // namespace pertev
