#pragma once

// Body of nearest_triangles.h for one number of rays at a time. `F` is Floats8 or Floats16.

#include <cstring>

#include "trace/intersect/intersect_rays.h"
#include "trace/wide/nearest_triangles.h"

namespace pertev {

/// Makes the shear of rays whose directions have their largest component along axis `kz`, as make_ray_shear does.
template <class F>
[[gnu::always_inline]] inline RayShearOf<F> make_shear_of_rays(const F (&columns)[8], int kz) {
    const int kx = kz == 2 ? 0 : kz + 1, ky = kz == 0 ? 2 : kz - 1;
    const F dz = columns[4 + kz];
    return {kx, ky, kz, columns[4 + kx] / dz, columns[4 + ky] / dz, 1.0f / dz, columns[kx], columns[ky], columns[kz]};
}

template <class F>
[[gnu::always_inline]] inline void find_nearest(const TriangleList& list, const Ray* rays, int kz, unsigned active,
                                                bool any, NearestTriangles& nearest) {
    static_assert(sizeof(Ray) == 8 * sizeof(float));
    std::array<const float*, F::kLanes> rows;
    for (uint32_t k = 0; k < F::kLanes; ++k) rows[k] = &rays[k].origin.x;
    F columns[8]; // origin, t_min, direction, t_max
    load_columns(rows, columns);
    const RayShearOf<F> shear = make_shear_of_rays(columns, kz);
    const F t_min = columns[3], t_max = columns[7];
    F t = t_max, u = 0.0f, v = 0.0f;
    WordOf<F> found = WordOf<F>{} + kNoTriangle;
    unsigned alone = 0;
    for (uint32_t i = 0; i < list.count && active != 0; ++i) {
        const TriangleHitsOf<F> hits = intersect_rays<F>(shear, {t_min, t_max, t}, list.triangles[i], active);
        alone |= hits.slow;
        active &= ~hits.slow;
        if (hits.hit == 0) continue;
        const MaskOf<F> hit = MaskOf<F>::of_bits(hits.hit);
        if (any) {
            active &= ~hits.hit;
        } else {
            alone |= bit_mask(hit && hits.t == t && hits.t < t_max);
        }
        t = select(hit, hits.t, t);
        u = select(hit, hits.u, u);
        v = select(hit, hits.v, v);
        found = select(hit, WordOf<F>{} + i, found);
    }
    t.store(nearest.t), u.store(nearest.u), v.store(nearest.v);
    std::memcpy(nearest.triangle, &found, sizeof found);
    nearest.alone = alone;
}

} // namespace pertev
