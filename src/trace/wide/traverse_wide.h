#pragma once

// Host traversal of one mesh: eight boxes and four triangles at once (AVX2, part of the baseline x86-64-v3). It skips
// by the same rule as the binary traversal, with the same grown planes, so the hits are the same to the bit.

#include <immintrin.h>

#include <cstddef>
#include <cstdint>
#include <utility>

#include "accel/bvh/bvh.h"
#include "accel/bvh/wide_bvh.h"
#include "trace/intersect/intersect_4_triangles.h"
#include "trace/intersect/ray_boxes.h"
#include "trace/traversal/traversal_options.h"

namespace pertev {

struct WideRay {
    std::ptrdiff_t near_plane[3], far_plane[3]; // offsets in WideBvhNode::planes, in floats
    __m256 inv[3];
    __m256 near[3], far[3]; // map a moved-out plane to its parameter; RayBoxes' lo and hi by the ray's sign
};

/// Data of a ray for box tests, exact or not. For exact tests it is computed in vectors, to the bit like
/// make_ray_boxes, and without a branch on the direction's signs.
template <TraversalOptions kOptions>
WideRay make_wide_ray(const Ray& ray, float bounds_max_abs) {
    __m128 inv, lo, hi;
    if constexpr (kOptions.is_exact()) {
        const __m128 sign = _mm_set1_ps(-0.0f), tiny = _mm_set1_ps(0x1p-80f);
        const __m128 origin = _mm_loadu_ps(&ray.origin.x), direction = _mm_loadu_ps(&ray.direction.x);
        const __m128 is_tiny = _mm_cmplt_ps(_mm_andnot_ps(sign, direction), tiny);
        inv = _mm_div_ps(_mm_set1_ps(1.0f),
                         _mm_blendv_ps(direction, _mm_or_ps(tiny, _mm_and_ps(direction, sign)), is_tiny));
        const __m128 growth = _mm_set1_ps(box_growth(ray.origin, bounds_max_abs));
        lo = _mm_xor_ps(_mm_mul_ps(_mm_add_ps(origin, growth), inv), sign);
        hi = _mm_xor_ps(_mm_mul_ps(_mm_sub_ps(origin, growth), inv), sign);
    } else {
        const auto boxes = TestsOf<kOptions>::make_boxes(ray, bounds_max_abs);
        const auto vector = [](Vec3 v) { return _mm_setr_ps(v.x, v.y, v.z, 0); };
        inv = vector(boxes.inv), lo = vector(boxes.lo), hi = vector(boxes.hi);
    }
    const auto backwards = static_cast<unsigned>(_mm_movemask_ps(inv));
    const __m128 near = _mm_blendv_ps(lo, hi, inv), far = _mm_blendv_ps(hi, lo, inv);
    WideRay wide;
    for (int axis = 0; axis < 3; ++axis) {
        const auto all = [axis](__m128 v) { return _mm256_broadcastss_ps(_mm_permutevar_ps(v, _mm_set1_epi32(axis))); };
        const std::ptrdiff_t back = backwards >> axis & 1;
        wide.near_plane[axis] = kWideChildren * (2 * axis + back);
        wide.far_plane[axis] = kWideChildren * (2 * axis + 1 - back);
        wide.inv[axis] = all(inv), wide.near[axis] = all(near), wide.far[axis] = all(far);
    }
    return wide;
}

/// Entered children of a node: lane k is child k.
struct EnteredChildren {
    __m256 entries; // entry parameters
    __m256 is_in;   // all bits set if the child may hold a hit with t_min < t <= t_limit, else 0

    unsigned mask() const { return static_cast<unsigned>(_mm256_movemask_ps(is_in)); }
};

/// Tests the boxes of a node's children. It is always inlined: as a call, with its vectors through memory, it would
/// take a tenth of a render.
[[gnu::always_inline]] inline EnteredChildren
enters_children(const WideRay& ray, const WideBvhNode<kWideChildren>& node, __m256 t_min, __m256 t_limit) {
    const auto near = [&](int axis) {
        return _mm256_fmadd_ps(_mm256_load_ps(&node.planes[0][0] + ray.near_plane[axis]), ray.inv[axis],
                               ray.near[axis]);
    };
    const auto far = [&](int axis) {
        return _mm256_fmadd_ps(_mm256_load_ps(&node.planes[0][0] + ray.far_plane[axis]), ray.inv[axis], ray.far[axis]);
    };
    const __m256 entries = _mm256_max_ps(_mm256_max_ps(near(0), near(1)), _mm256_max_ps(near(2), t_min));
    const __m256 exit = _mm256_min_ps(_mm256_min_ps(far(0), far(1)), _mm256_min_ps(far(2), t_limit));
    return {entries, _mm256_cmp_ps(entries, exit, _CMP_LE_OQ)};
}

/// Tests leaves of up to four triangles at once, or one by one if hits need not be exact.
template <TraversalOptions kOptions>
struct LeafOfFour {
    const Ray& ray;
    RayShear shear;
    RayShear4 shear4;

    explicit LeafOfFour(const Ray& r) : ray(r) {
        if constexpr (kOptions.is_exact()) shear4 = make_ray_shear_4(r, shear);
    }

    template <class Visitor>
    bool test(const BvhTriangle* first, uint32_t count, uint32_t instance, Visitor& visitor) const {
        const auto visit = [&](const BvhTriangle& t, const TriangleHit& hit) {
            return visitor.visit(instance == kNoHit ? t.instance : instance, t.primitive, hit);
        };
        if constexpr (kOptions.is_exact()) {
            TriangleHit4 hits;
            unsigned hit = intersect_4_triangles(ray.origin, shear, shear4, ray.t_min, ray.t_max, visitor.limit(),
                                                 first, count, hits);
            for (; hit != 0; hit &= hit - 1) {
                const int k = __builtin_ctz(hit);
                if (visit(first[k], {hits.t[k], hits.u[k], hits.v[k]})) return true;
            }
        } else {
            for (uint32_t k = 0; k < count; ++k) {
                TriangleHit hit;
                const BvhTriangle& t = first[k];
                if (FastTests::intersect(ray, {}, t.a, t.b, t.c, hit) && visit(t, hit)) return true;
            }
        }
        return false;
    }

    /// Tests a leaf of any size.
    template <class Visitor, class Counter>
    bool test_all(const BvhTriangle* triangles, uint32_t count, uint32_t instance, Visitor& visitor,
                  const Counter& counter) const {
        for (uint32_t i = 0; i < count; i += 4) {
            const BvhTriangle* first = triangles + i;
            const uint32_t some = min(count - i, 4u);
            for (uint32_t k = 0; k < some; ++k) counter.add_triangle(first + k);
            if (test(first, some, instance, visitor)) return true;
        }
        return false;
    }
};

/// A pending child.
struct WideEntry {
    float entry;
    uint32_t link, count; // copied from WideBvhNode
};
using WideStack = WideEntry[kWideStackSize<kWideChildren>];

/// Tests a node's boxes. If the ray enters any, the first goes to `at` and the others to the stack: the nearest
/// first, or the builder's first, or the farthest, and the others in the builder's order. Most nodes have one or two
/// entered children, for which no sorting loop is needed.
template <TraversalOptions kOptions>
[[gnu::always_inline]] inline bool enter_node(const WideBvhNode<kWideChildren>& node, const WideRay& wide, __m256 t_min,
                                              __m256 t_limit, bool far_first, WideEntry* stack, int& size,
                                              WideEntry& at) {
    const EnteredChildren children = enters_children(wide, node, t_min, t_limit);
    unsigned entered = children.mask();
    if (entered == 0) return false;
    alignas(32) float entries[kWideChildren];
    _mm256_store_ps(entries, children.entries);
    const auto child = [&](int k) { return WideEntry{entries[k], node.child[k], node.count[k]}; };
    if (!kOptions.near_first || far_first) {
        int first = __builtin_ctz(entered);
        for (unsigned rest = entered; far_first && rest != 0; rest &= rest - 1) {
            const int k = __builtin_ctz(rest);
            if (entries[k] > entries[first]) first = k;
        }
        entered ^= 1u << first;
        while (entered != 0) {
            const int last = 31 - __builtin_clz(entered);
            stack[size++] = child(last);
            entered ^= 1u << last;
        }
        at = child(first);
        return true;
    }
    const int first = __builtin_ctz(entered);
    entered &= entered - 1;
    if (entered == 0) {
        at = child(first);
        return true;
    }
    const int second = __builtin_ctz(entered);
    entered &= entered - 1;
    const int nearer = entries[second] < entries[first] ? second : first, farther = first ^ second ^ nearer;
    const int base = size;
    stack[size++] = child(farther);
    at = child(nearer);
    for (; entered != 0; entered &= entered - 1) {
        WideEntry next = child(__builtin_ctz(entered));
        if (next.entry < at.entry) std::swap(next, at);
        int slot = size++;
        for (; slot > base && stack[slot - 1].entry < next.entry; --slot) stack[slot] = stack[slot - 1];
        stack[slot] = next;
    }
    return true;
}

/// Traverses a tree with at least one node. Returns true if the visitor ended the traversal. It is always inlined: as a
/// call it makes a render a twentieth slower.
template <TraversalOptions kOptions, class Visitor, class Counter>
[[gnu::always_inline]] inline bool traverse_wide(const WideBvhView<kWideChildren>& bvh, const Ray& ray,
                                                 uint32_t instance, Visitor& visitor, const Counter& counter) {
    WideStack stack;
    int size = 0;
    const WideRay wide = make_wide_ray<kOptions>(ray, bvh.bounds_max_abs);
    const LeafOfFour<kOptions> leaf(ray);
    const __m256 t_min = _mm256_set1_ps(ray.t_min);
    WideEntry at = {ray.t_min, 0, 0};
    for (;;) {
        if (!(at.link & kLeafBit)) {
            const WideBvhNode<kWideChildren>& node = bvh.nodes[at.link];
            counter.add_node(&node);
            const __m256 t_limit = _mm256_set1_ps(skip_beyond<kOptions>(visitor, ray));
            if (enter_node<kOptions>(node, wide, t_min, t_limit, visitor.visits_far_first(), stack, size, at)) continue;
        } else if (leaf.test_all(bvh.triangles + (at.link & ~kLeafBit), at.count, instance, visitor, counter)) {
            return true;
        }
        do {
            if (size == 0) return false;
            at = stack[--size];
        } while (!(at.entry <= skip_beyond<kOptions>(visitor, ray)));
    }
}

/// The traversal in the form of trace/traverse_scene.h; host only.
template <TraversalOptions kOptions>
struct Wide8SimdTraversal {
    using Tree = WideBvhView<kWideChildren>;

    template <class Visitor, class Counter>
    [[gnu::always_inline]] static bool traverse(const Tree& bvh, const Ray& ray, uint32_t instance, Visitor& visitor,
                                                const Counter& counter) {
        return bvh.nodes != nullptr && traverse_wide<kOptions>(bvh, ray, instance, visitor, counter);
    }
};

} // namespace pertev
