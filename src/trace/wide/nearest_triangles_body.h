#pragma once

// Body of nearest_triangles.h for one number of rays at a time. `F` is Floats8 or Floats16.

#include <cstring>

#include "trace/intersect/intersect_rays.h"
#include "trace/wide/nearest_triangles.h"

namespace pertev {

/// Returns whether both are one triangle, which the leaves of a tree may hold more than once.
inline bool is_same_triangle(const BvhTriangle& a, const BvhTriangle& b) {
    return a.instance == b.instance && a.primitive == b.primitive;
}

template <class F>
void find_nearest(const TriangleList& list, const Ray* rays, int kz, unsigned active, bool any,
                  NearestTriangles& nearest) {
    F columns[8];
    load_rays(rays, columns);
    const RayShearOf<F> shear = make_shear_of_rays(columns, kz);
    const F t_max = columns[7];
    F t = t_max, u = 0.0f, v = 0.0f;
    WordOf<F> found = WordOf<F>{} + kNoTriangle;
    MaskOf<F> going = MaskOf<F>::of_bits(active);
    unsigned alone = 0;
    for (uint32_t i = 0; i < list.count; ++i) {
        const TriangleEdgesOf<F> edges = edges_of(shear, list.triangles[i]);
        const MaskOf<F> wanted = going && !edges.is_outside;
        if (bit_mask(wanted) == 0) continue;
        const PlaneHitOf<F> at = hit_plane(shear, edges);
        const MaskOf<F> slow = wanted && !edges.is_inside;
        const MaskOf<F> hit = going && edges.is_inside && RayRangeOf<F>{columns[3], t_max, t}.holds(at.t);
        if (bit_mask(slow) != 0) {
            alone |= bit_mask(slow);
            going = going && !slow;
        }
        if (any) {
            going = going && !hit;
        } else {
            for (unsigned rest = bit_mask(hit && at.t == t); rest != 0; rest &= rest - 1) {
                const auto lane = static_cast<uint32_t>(__builtin_ctz(rest));
                const bool is_other = !is_same_triangle(list.triangles[found[lane]], list.triangles[i]);
                alone |= (is_other ? 1u : 0u) << lane;
            }
        }
        t = select(hit, at.t, t);
        u = select(hit, at.u, u);
        v = select(hit, at.v, v);
        found = select(hit, WordOf<F>{} + i, found);
        if (bit_mask(going) == 0) break;
    }
    t.store(nearest.t), u.store(nearest.u), v.store(nearest.v);
    std::memcpy(nearest.triangle, &found, sizeof found);
    nearest.alone = alone;
}

} // namespace pertev
