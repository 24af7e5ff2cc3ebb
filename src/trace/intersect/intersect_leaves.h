#pragma once

// Tests four triangles for each of several rays at once, host only, with the bits of intersect_triangle. `F` is Floats8
// or Floats16: two or four rays. Each quad of lanes belongs to one ray.

#include <array>
#include <cstdint>

#include "accel/bvh/bvh.h"
#include "math/lanes.h"
#include "trace/intersect/intersect_4_triangles.h"
#include "trace/intersect/intersect_rays.h"

namespace pertev {

/// Constants of a ray in the order of its axes, as rows of four numbers.
struct ShearRows {
    alignas(16) std::array<uint32_t, 4> order; // kx, ky, kz; the fourth stays
    alignas(16) std::array<float, 4> shear;    // sx, sy, sz, t_max
    alignas(16) std::array<float, 4> origin;   // x, y, z, t_min
};

/// Makes the shear of make_ray_shear, without a branch.
inline ShearRows make_shear_rows(const Ray& ray) {
    RayShear shear;
    const RayShear4 four = make_ray_shear_4(ray, shear);
    ShearRows rows;
    _mm_store_si128(reinterpret_cast<__m128i*>(rows.order.data()), four.order);
    _mm_store_ps(rows.shear.data(), _mm_setr_ps(shear.sx, shear.sy, shear.sz, ray.t_max));
    _mm_store_ps(rows.origin.data(), _mm_permutevar_ps(_mm_loadu_ps(&ray.origin.x), four.order));
    return rows;
}

template <class F>
inline constexpr int kLeavesAtOnce = static_cast<int>(F::kLanes / 4);

/// Up to four triangles for one ray.
struct LeafOfRay {
    const ShearRows* ray;
    const BvhTriangle* first;
    uint32_t count; // 0 to 4; with 0, `first` may still be read
    float t_limit;
};

/// Hits of leaves; bit and number 4 i + k belong to triangle k of leaf i.
template <class F>
struct LeafHits {
    unsigned hit = 0;
    unsigned slow = 0;                                // to be tested alone (intersect_alone)
    alignas(64) std::array<float, F::kLanes> t, u, v; // valid where `hit` has a bit
};

template <class F>
[[gnu::always_inline]] inline void intersect_leaves(const std::array<LeafOfRay, kLeavesAtOnce<F>>& leaves,
                                                    LeafHits<F>& hits) {
    constexpr int kLeaves = kLeavesAtOnce<F>;
    const auto load = [&](const auto& row_of) __attribute__((always_inline)) {
        std::array<const float*, kLeaves> rows;
        for (int i = 0; i < kLeaves; ++i) rows[i] = row_of(leaves[i]);
        F quads;
        load_quads(rows, quads);
        return quads;
    };
    const WordOf<F> order =
        bits_of(load([](const LeafOfRay& leaf) { return reinterpret_cast<const float*>(leaf.ray->order.data()); }));
    const F shear = load([](const LeafOfRay& leaf) { return leaf.ray->shear.data(); });
    const F origin = load([](const LeafOfRay& leaf) { return leaf.ray->origin.data(); });
    const RayShearLanes<F> ray = {broadcast_in_quads<0>(shear),  broadcast_in_quads<1>(shear),
                                  broadcast_in_quads<2>(shear),  broadcast_in_quads<0>(origin),
                                  broadcast_in_quads<1>(origin), broadcast_in_quads<2>(origin)};
    const auto corner = [&](int which) __attribute__((always_inline)) {
        constexpr Vec3 BvhTriangle::*kCorners[] = {&BvhTriangle::a, &BvhTriangle::b, &BvhTriangle::c};
        F rows[4], columns[3];
        for (uint32_t k = 0; k < 4; ++k) {
            rows[k] = permute_quads(
                load([&](const LeafOfRay& leaf) { return &(leaf.first[k < leaf.count ? k : 0].*kCorners[which]).x; }),
                order);
        }
        transpose_quads(rows, columns);
        return Vec3Of<F>{columns[0], columns[1], columns[2]};
    };
    const TriangleEdgesOf<F> edges = edges_of_corners(ray, corner);
    unsigned requested = 0;
    for (int i = 0; i < kLeaves; ++i) requested |= ((1u << leaves[i].count) - 1) << 4 * i;
    requested &= ~bit_mask(edges.is_outside);
    hits.hit = requested & bit_mask(edges.is_inside);
    hits.slow = requested & ~hits.hit;
    if (hits.hit == 0) return;
    const PlaneHitOf<F> at = hit_plane(ray, edges);
    std::array<float, F::kLanes> limits;
    for (int i = 0; i < kLeaves; ++i)
        limits[4 * i] = limits[4 * i + 1] = limits[4 * i + 2] = limits[4 * i + 3] = leaves[i].t_limit;
    const RayRangeOf<F> range = {broadcast_in_quads<3>(origin), broadcast_in_quads<3>(shear), F::load(limits.data())};
    hits.hit &= bit_mask(range.holds(at.t));
    at.t.store(hits.t.data());
    at.u.store(hits.u.data());
    at.v.store(hits.v.data());
}

} // namespace pertev
