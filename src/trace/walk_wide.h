#pragma once

// The host's walk of one mesh: eight boxes and four triangles at once (AVX2, part of the baseline x86-64-v3). It skips
// by the same rule as the binary walk, with the same grown planes, so the hits are the same to the bit.

#include <immintrin.h>

#include <cstdint>

#include "accel/bvh/bvh.h"
#include "accel/bvh/wide_bvh.h"
#include "base/limits.h"
#include "trace/intersect_4_triangles.h"
#include "trace/ray_boxes.h"

namespace pertev {

struct WideRay {
    int near_plane[3]; // index into WideBvhNode::planes; the far one is near ^ 1
    __m256 inv[3];
    __m256 near[3], far[3]; // what takes a moved-out plane to its parameter; RayBoxes' lo and hi by the ray's sign
};

inline WideRay make_wide_ray(const RayBoxes& boxes) {
    WideRay ray;
    for (int axis = 0; axis < 3; ++axis) {
        const float inv = component(boxes.inv, axis), lo = component(boxes.lo, axis), hi = component(boxes.hi, axis);
        const bool backwards = inv < 0;
        ray.near_plane[axis] = 2 * axis + (backwards ? 1 : 0);
        ray.inv[axis] = _mm256_set1_ps(inv);
        ray.near[axis] = _mm256_set1_ps(backwards ? hi : lo);
        ray.far[axis] = _mm256_set1_ps(backwards ? lo : hi);
    }
    return ray;
}

/// Bit k: child k may hold a hit with t_min < t <= t_limit; its entry parameter goes to entries[k].
inline unsigned enters_children(const WideRay& ray, const WideBvhNode& node, __m256 t_min, __m256 t_limit,
                                float (&entries)[kWideChildren]) {
    const auto near = [&](int axis) {
        return _mm256_fmadd_ps(_mm256_load_ps(node.planes[ray.near_plane[axis]]), ray.inv[axis], ray.near[axis]);
    };
    const auto far = [&](int axis) {
        return _mm256_fmadd_ps(_mm256_load_ps(node.planes[ray.near_plane[axis] ^ 1]), ray.inv[axis], ray.far[axis]);
    };
    const __m256 entry = _mm256_max_ps(_mm256_max_ps(near(0), near(1)), _mm256_max_ps(near(2), t_min));
    const __m256 exit = _mm256_min_ps(_mm256_min_ps(far(0), far(1)), _mm256_min_ps(far(2), t_limit));
    _mm256_store_ps(entries, entry);
    return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(entry, exit, _CMP_LE_OQ)));
}

/// True when the visitor ended it. `bvh.wide` is there and the root is an inner node.
template <class Visitor, class Counter>
inline bool walk_wide(const BvhView& bvh, const Ray& ray, uint32_t instance, Visitor& visitor, const Counter& counter) {
    struct Entry {
        float entry;
        uint32_t link, count;
    };
    Entry stack[kMaxBvhDepth * (kWideChildren - 1) + 1];
    int size = 0;
    const WideRay wide = make_wide_ray(make_ray_boxes(ray.origin, ray.direction, bvh.bounds_max_abs));
    const RayShear shear = make_ray_shear(ray.direction);
    const RayShear4 shear4 = make_ray_shear_4(ray.origin, shear);
    const __m256 t_min = _mm256_set1_ps(ray.t_min);
    Entry at = {ray.t_min, 0, 0};
    for (;;) {
        if (!(at.link & kLeafBit)) {
            const WideBvhNode& node = bvh.wide[at.link];
            counter.add_node(&node);
            alignas(32) float entries[kWideChildren];
            unsigned entered = enters_children(wide, node, t_min, _mm256_set1_ps(visitor.limit()), entries);
            if (entered != 0) {
                const int base = size;
                while (entered != 0) {
                    // The last one pushed is entered first: the nearest; else the one that the builder put first.
                    const int k = Visitor::kNearestFirst ? __builtin_ctz(entered) : 31 - __builtin_clz(entered);
                    entered &= ~(1u << k);
                    const Entry next = {entries[k], node.child[k], node.count[k]};
                    int place = size++;
                    if constexpr (Visitor::kNearestFirst) {
                        for (; place > base && stack[place - 1].entry < next.entry; --place)
                            stack[place] = stack[place - 1];
                    }
                    stack[place] = next;
                }
                at = stack[--size];
                continue;
            }
        } else {
            for (uint32_t i = 0; i < at.count; i += 4) {
                const BvhTriangle* first = bvh.triangles + (at.link & ~kLeafBit) + i;
                const uint32_t count = min(at.count - i, 4u);
                for (uint32_t k = 0; k < count; ++k) counter.add_triangle(first + k);
                TriangleHit4 hits;
                unsigned hit = intersect_4_triangles(ray.origin, shear, shear4, ray.t_min, ray.t_max, visitor.limit(),
                                                     first, count, hits);
                for (; hit != 0; hit &= hit - 1) {
                    const int k = __builtin_ctz(hit);
                    if (visitor.visit(instance == kNoHit ? first[k].instance : instance, first[k].primitive,
                                      {hits.t[k], hits.u[k], hits.v[k]})) {
                        return true;
                    }
                }
            }
        }
        do {
            if (size == 0) return false;
            at = stack[--size];
        } while (!(at.entry <= visitor.limit()));
    }
}

} // namespace pertev
