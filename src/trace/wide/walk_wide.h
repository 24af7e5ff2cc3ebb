#pragma once

// The host's walk of one mesh: eight boxes and four triangles at once (AVX2, part of the baseline x86-64-v3). It skips
// by the same rule as the binary walk, with the same grown planes, so the hits are the same to the bit.

#include <immintrin.h>

#include <cstdint>

#include "accel/bvh/bvh.h"
#include "accel/bvh/wide_bvh.h"
#include "trace/intersect/intersect_4_triangles.h"
#include "trace/intersect/ray_boxes.h"
#include "trace/walk_options.h"

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

/// Bit k: child k may hold a hit with t_min < t <= t_limit; its entry parameter goes to entries[k]. Always inlined: as
/// a call, with its vectors through memory, it takes a tenth of a render.
[[gnu::always_inline]] inline unsigned enters_children(const WideRay& ray, const WideBvhNode<kWideChildren>& node,
                                                       __m256 t_min, __m256 t_limit, float (&entries)[kWideChildren]) {
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

/// Leaves of up to four triangles at once, or one by one where hits need not be exact. True when the visitor ended it.
template <WalkOptions kOptions>
struct LeafOfFour {
    const Ray& ray;
    const typename TestsOf<kOptions>::Triangles prepared;
    const RayShear4 shear4;

    explicit LeafOfFour(const Ray& r)
        : ray(r), prepared(TestsOf<kOptions>::make_triangles(r)), shear4(make_ray_shear_4(r.origin, shear_of(r))) {}

    template <class Visitor>
    bool test(const BvhTriangle* first, uint32_t count, uint32_t instance, Visitor& visitor) const {
        const auto visit = [&](const BvhTriangle& t, const TriangleHit& hit) {
            return visitor.visit(instance == kNoHit ? t.instance : instance, t.primitive, hit);
        };
        if constexpr (kOptions.is_exact()) {
            TriangleHit4 hits;
            unsigned hit = intersect_4_triangles(ray.origin, prepared, shear4, ray.t_min, ray.t_max, visitor.limit(),
                                                 first, count, hits);
            for (; hit != 0; hit &= hit - 1) {
                const int k = __builtin_ctz(hit);
                if (visit(first[k], {hits.t[k], hits.u[k], hits.v[k]})) return true;
            }
        } else {
            for (uint32_t k = 0; k < count; ++k) {
                TriangleHit hit;
                const BvhTriangle& t = first[k];
                if (FastTests::intersect(ray, prepared, t.a, t.b, t.c, hit) && visit(t, hit)) return true;
            }
        }
        return false;
    }

private:
    RayShear shear_of(const Ray& r) const {
        if constexpr (kOptions.is_exact()) {
            return prepared;
        } else {
            return make_ray_shear(r.direction); // not used
        }
    }
};

/// True when the visitor ended it. There is a node. Always inlined: as a call it makes a render a twentieth slower.
template <WalkOptions kOptions, class Visitor, class Counter>
[[gnu::always_inline]] inline bool walk_wide(const WideBvhView<kWideChildren>& bvh, const Ray& ray, uint32_t instance, Visitor& visitor,
                      const Counter& counter) {
    struct Entry {
        float entry;
        uint32_t link, count;
    };
    Entry stack[kWideStackSize<kWideChildren>];
    int size = 0;
    const WideRay wide = make_wide_ray(TestsOf<kOptions>::make_boxes(ray, bvh.bounds_max_abs));
    const LeafOfFour<kOptions> leaf(ray);
    const __m256 t_min = _mm256_set1_ps(ray.t_min);
    Entry at = {ray.t_min, 0, 0};
    for (;;) {
        if (!(at.link & kLeafBit)) {
            const WideBvhNode<kWideChildren>& node = bvh.nodes[at.link];
            counter.add_node(&node);
            alignas(32) float entries[kWideChildren];
            const __m256 t_limit = _mm256_set1_ps(skip_beyond<kOptions>(visitor, ray));
            unsigned entered = enters_children(wide, node, t_min, t_limit, entries);
            if (entered != 0) {
                const int base = size;
                while (entered != 0) {
                    // The last one pushed is entered first: the nearest; else the one that the builder put first.
                    const int k = kOptions.near_first ? __builtin_ctz(entered) : 31 - __builtin_clz(entered);
                    entered &= ~(1u << k);
                    const Entry next = {entries[k], node.child[k], node.count[k]};
                    int place = size++;
                    if constexpr (kOptions.near_first) {
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
                if (leaf.test(first, count, instance, visitor)) return true;
            }
        }
        do {
            if (size == 0) return false;
            at = stack[--size];
        } while (!(at.entry <= skip_beyond<kOptions>(visitor, ray)));
    }
}

/// It as a walk (trace/walk_scene.h); host only.
template <WalkOptions kOptions>
struct Wide8SimdWalk {
    using Tree = WideBvhView<kWideChildren>;

    template <class Visitor, class Counter>
    [[gnu::always_inline]] static bool walk(const Tree& bvh, const Ray& ray, uint32_t instance, Visitor& visitor, const Counter& counter) {
        return bvh.nodes != nullptr && walk_wide<kOptions>(bvh, ray, instance, visitor, counter);
    }
};

} // namespace pertev
