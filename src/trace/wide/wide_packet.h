#pragma once

// Traverses one mesh with eight coherent rays together, host only: the children of a node are tested at once for the
// whole packet, with intervals that contain the eight origins and directions, and the remaining ones one by one for
// the eight rays. A triangle is loaded once for all. Each ray gets the hit that it would get alone.
//
// Source: Wald, Boulos, Shirley, "Ray Tracing Deformable Scenes Using Dynamic Bounding Volume Hierarchies", ACM TOG
// 26(1), 2007, section 4: packets over a hierarchy with intervals; nodes of eight as in traverse_wide.h. An any-hit
// search keeps the builder's order, even for rays without an end (trace_any.h): coherent ones mostly go to one sun,
// and with far children first fewer of them stay together. No hit is lost by the intervals: planes are moved out for
// each ray (ray_boxes.h) by 16 units, of which a bound computed as (plane - moved origin) times 1/direction loses
// four and the triangle test six.

#include <array>
#include <cstdint>

#include "trace/intersect/intersect_rays.h"
#include "trace/wide/traverse_wide.h"

namespace pertev {

inline constexpr int kPacketEights = 4, kWidePacket = 8 * kPacketEights;

template <TraversalOptions kOptions, class Visitor>
class WidePacket {
    static_assert(kOptions.is_exact());
    static constexpr float kMaxSpread = 0.25f; // maximum spread of slopes; with more, rays share too few nodes

public:
    /// Makes a packet of eight rays; those that are not needed are copies of one of the others, with its visitor.
    /// `rays` and, for run(), `visitors` outlive it.
    WidePacket(const WideBvhView<kWideChildren>& bvh, const Ray* rays) : bvh_(bvh), rays_(rays) {
        const RayShear first = make_ray_shear(rays[0].direction);
        for (int axis = 0; axis < 3; ++axis) {
            back_[axis] = guard_direction(component(rays[0].direction, axis)) < 0;
            extents_[axis] = {kInfinity, 0, -kInfinity, kInfinity};
        }
        for (int g = 0; g < kPacketEights; ++g) {
            Floats8 columns[8];
            load_rays(rays + 8 * g, columns);
            const Floats8 *const origin = columns, *const direction = columns + 4;
            __m256 growth =
                _mm256_max_ps(_mm256_max_ps(size_of(origin[0].v), size_of(origin[1].v)), size_of(origin[2].v));
            growth = _mm256_mul_ps(_mm256_set1_ps(0x1p-20f), _mm256_add_ps(growth, _mm256_set1_ps(bvh.bounds_max_abs)));
            Eight& eight = eights_[g];
            for (int axis = 0; axis < 3; ++axis) {
                set_axis(eight, axis, origin[axis].v, direction[axis].v, growth);
            }
            set_shear(eight, columns, first);
            eight.t_min = columns[3].v, eight.t_max = columns[7].v;
            min_t_ = min(min_t_, min_of(eight.t_min));
        }
    }

    /// Returns whether the rays are coherent; others must not run.
    bool is_coherent() const { return is_coherent_; }

    void run(Visitor* visitors, int count) {
        visitors_ = visitors;
        for (int k = 0; k < kWidePacket; ++k) {
            eights_[k / 8].limits[k % 8] = k < count ? visitors[k].limit() : -kInfinity;
        }
        traverse();
    }

private:
    struct Eight {
        __m256 inv[3], near[3], far[3], t_min, t_max;
        RayShearOf<Floats8> shear;
        alignas(32) float limits[8]; // limits of the visitors; -inf for rays that are done
    };

    /// Computes make_ray_boxes for eight rays along an axis, and its bounds.
    void set_axis(Eight& eight, int axis, __m256 origin, __m256 d, __m256 growth) {
        const __m256 sign = _mm256_set1_ps(-0.0f), tiny = _mm256_set1_ps(0x1p-80f);
        const __m256 guarded = _mm256_blendv_ps(d, _mm256_or_ps(tiny, _mm256_and_ps(d, sign)),
                                                _mm256_cmp_ps(size_of(d), tiny, _CMP_LT_OQ));
        const __m256 inv = _mm256_div_ps(_mm256_set1_ps(1.0f), guarded);
        const bool back = back_[axis];
        is_coherent_ = is_coherent_ && mask_of(guarded) == (back ? 0xffu : 0u);
        const __m256 above = _mm256_add_ps(origin, growth), below = _mm256_sub_ps(origin, growth);
        const __m256 lo = _mm256_xor_ps(_mm256_mul_ps(above, inv), sign);
        const __m256 hi = _mm256_xor_ps(_mm256_mul_ps(below, inv), sign);
        eight.inv[axis] = inv, eight.near[axis] = back ? hi : lo, eight.far[axis] = back ? lo : hi;
        // A plane's parameter is (plane - q) |1/d| in positive and (-plane - (-q)) |1/d| in negative direction.
        const __m256 q_near = back ? _mm256_xor_ps(below, sign) : above;
        const __m256 q_far = back ? _mm256_xor_ps(above, sign) : below;
        const __m256 size = size_of(inv);
        Extent& all = extents_[axis];
        all = {min(all.min_inv, min_of(size)), max(all.max_inv, max_of(size)), max(all.max_near, max_of(q_near)),
               min(all.min_far, min_of(q_far))};
    }

    void traverse() {
        struct Waiting {
            __m256 entry[kPacketEights]; // NaN for rays that do not enter
            uint32_t link, count;
        };
        Waiting stack[kWideStackSize<kWideChildren>];
        int size = 0;
        uint32_t link = 0, count = 0;
        unsigned active[kPacketEights] = {};
        for (;;) {
            if (!(link & kLeafBit)) {
                const WideBvhNode<kWideChildren>& node = bvh_.nodes[link];
                int order[kWideChildren];
                for (int n = enter_together(node, order); n-- > 0;) { // the first one ends on top
                    const int k = order[n];
                    Waiting& next = stack[size];
                    int some = 0;
                    for (int g = 0; g < kPacketEights; ++g) some |= enter_child(eights_[g], node, k, next.entry[g]);
                    if (some == 0) continue;
                    next.link = node.child[k], next.count = node.count[k];
                    ++size;
                }
            } else {
                test_leaf(bvh_.triangles + (link & ~kLeafBit), count, active);
            }
            unsigned some = 0;
            do {
                if (size == 0) return;
                const Waiting& top = stack[--size];
                for (int g = 0; g < kPacketEights; ++g) {
                    active[g] = mask_of(_mm256_cmp_ps(top.entry[g], _mm256_load_ps(eights_[g].limits), _CMP_LE_OQ));
                    some |= active[g];
                }
                link = top.link, count = top.count;
            } while (some == 0);
        }
    }

    /// Bounds of all rays along an axis: |1/direction|, and the origins that enter_together subtracts from planes.
    struct Extent {
        float min_inv, max_inv, max_near, min_far;
    };

    /// Makes the shears of eight rays that share the first one's order of axes, like make_ray_shear.
    void set_shear(Eight& eight, const Floats8 (&columns)[8], const RayShear& first) {
        const __m256 x = size_of(columns[4].v), y = size_of(columns[5].v), z = size_of(columns[6].v);
        const unsigned xy = mask_of(_mm256_cmp_ps(x, y, _CMP_GE_OQ)), xz = mask_of(_mm256_cmp_ps(x, z, _CMP_GE_OQ)),
                       yz = mask_of(_mm256_cmp_ps(y, z, _CMP_GE_OQ));
        const unsigned with_x = xy & xz, with_y = ~xy & yz & 0xffu;
        const unsigned with = first.kz == 0 ? with_x : first.kz == 1 ? with_y : ~(with_x | with_y) & 0xffu;
        const RayShearOf<Floats8>& shear = eight.shear = make_shear_of_rays(columns, first.kz);
        const __m256 spread = _mm256_add_ps(size_of(_mm256_sub_ps(shear.sx.v, _mm256_set1_ps(first.sx))),
                                            size_of(_mm256_sub_ps(shear.sy.v, _mm256_set1_ps(first.sy))));
        const unsigned near_first = mask_of(_mm256_cmp_ps(spread, _mm256_set1_ps(kMaxSpread), _CMP_LT_OQ));
        is_coherent_ = is_coherent_ && (with & near_first) == 0xff;
    }

    static __m256 size_of(__m256 x) { return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), x); }
    static float min_of(__m256 all) {
        __m128 least = _mm_min_ps(_mm256_castps256_ps128(all), _mm256_extractf128_ps(all, 1));
        least = _mm_min_ps(least, _mm_movehl_ps(least, least));
        return _mm_cvtss_f32(_mm_min_ss(least, _mm_shuffle_ps(least, least, 1)));
    }
    static float max_of(__m256 all) {
        __m128 most = _mm_max_ps(_mm256_castps256_ps128(all), _mm256_extractf128_ps(all, 1));
        most = _mm_max_ps(most, _mm_movehl_ps(most, most));
        return _mm_cvtss_f32(_mm_max_ss(most, _mm_shuffle_ps(most, most, 1)));
    }
    static unsigned mask_of(__m256 lanes) { return static_cast<unsigned>(_mm256_movemask_ps(lanes)); }
    const float* near_planes(const WideBvhNode<kWideChildren>& node, int axis) const {
        return node.planes[2 * axis + (back_[axis] ? 1 : 0)];
    }
    const float* far_planes(const WideBvhNode<kWideChildren>& node, int axis) const {
        return node.planes[2 * axis + (back_[axis] ? 0 : 1)];
    }

    /// Finds the children that any ray of the packet may enter: their number and order.
    [[gnu::always_inline]] int enter_together(const WideBvhNode<kWideChildren>& node,
                                              int (&order)[kWideChildren]) const {
        __m256 limits = _mm256_load_ps(eights_[0].limits);
        for (int g = 1; g < kPacketEights; ++g) limits = _mm256_max_ps(limits, _mm256_load_ps(eights_[g].limits));
        __m256 entry = _mm256_set1_ps(min_t_), exit = _mm256_set1_ps(max_of(limits));
        for (int axis = 0; axis < 3; ++axis) {
            const Extent& extent = extents_[axis];
            const __m256 sign = _mm256_set1_ps(back_[axis] ? -0.0f : 0.0f);
            const __m256 least = _mm256_set1_ps(extent.min_inv), most = _mm256_set1_ps(extent.max_inv);
            const __m256 a = _mm256_sub_ps(_mm256_xor_ps(_mm256_load_ps(near_planes(node, axis)), sign),
                                           _mm256_set1_ps(extent.max_near));
            const __m256 b = _mm256_sub_ps(_mm256_xor_ps(_mm256_load_ps(far_planes(node, axis)), sign),
                                           _mm256_set1_ps(extent.min_far));
            entry = _mm256_max_ps(entry, _mm256_min_ps(_mm256_mul_ps(a, least), _mm256_mul_ps(a, most)));
            exit = _mm256_min_ps(exit, _mm256_max_ps(_mm256_mul_ps(b, least), _mm256_mul_ps(b, most)));
        }
        alignas(32) float entries[kWideChildren];
        _mm256_store_ps(entries, entry);
        int n = 0;
        for (unsigned rest = mask_of(_mm256_cmp_ps(entry, exit, _CMP_LE_OQ)); rest != 0; rest &= rest - 1) {
            const int k = __builtin_ctz(rest);
            int slot = n++;
            for (; kOptions.near_first && slot > 0 && entries[order[slot - 1]] > entries[k]; --slot) {
                order[slot] = order[slot - 1];
            }
            order[slot] = k;
        }
        return n;
    }

    /// Tests the box of child k for eight rays, like enters_children (traverse_wide.h). The result is nonzero if any
    /// ray enters, with the entry parameters.
    [[gnu::always_inline]] int enter_child(const Eight& eight, const WideBvhNode<kWideChildren>& node, int k,
                                           __m256& entry) const {
        const auto near = [&](int axis) {
            return _mm256_fmadd_ps(_mm256_broadcast_ss(near_planes(node, axis) + k), eight.inv[axis], eight.near[axis]);
        };
        const auto far = [&](int axis) {
            return _mm256_fmadd_ps(_mm256_broadcast_ss(far_planes(node, axis) + k), eight.inv[axis], eight.far[axis]);
        };
        entry = _mm256_max_ps(_mm256_max_ps(near(0), near(1)), _mm256_max_ps(near(2), eight.t_min));
        const __m256 exit =
            _mm256_min_ps(_mm256_min_ps(far(0), far(1)), _mm256_min_ps(far(2), _mm256_load_ps(eight.limits)));
        const __m256 is_out = _mm256_cmp_ps(entry, exit, _CMP_NLE_UQ);
        entry = _mm256_or_ps(entry, is_out);
        return _mm256_movemask_ps(is_out) ^ 0xff;
    }

    void test_leaf(const BvhTriangle* triangles, uint32_t count, const unsigned (&active)[kPacketEights]) {
        for (int g = 0; g < kPacketEights; ++g) {
            Eight& eight = eights_[g];
            unsigned requested = active[g];
            if (requested == 0) continue;
            for (uint32_t i = 0; i < count; ++i) {
                const BvhTriangle& triangle = triangles[i];
                const TriangleHitsOf<Floats8> hits = intersect_rays<Floats8>(
                    eight.shear, {eight.t_min, eight.t_max, _mm256_load_ps(eight.limits)}, triangle, requested);
                for (unsigned rest = hits.hit | hits.slow; rest != 0; rest &= rest - 1) {
                    const auto k = static_cast<uint32_t>(__builtin_ctz(rest));
                    TriangleHit hit = {hits.at.t[k], hits.at.u[k], hits.at.v[k]};
                    if ((hits.slow >> k & 1) != 0 &&
                        !intersect_alone(rays_[8 * g + k], eight.limits[k], triangle, hit)) {
                        continue;
                    }
                    Visitor& visitor = visitors_[8 * g + k];
                    const bool ended = visitor.visit(triangle.instance, triangle.primitive, hit);
                    eight.limits[k] = ended ? -kInfinity : visitor.limit();
                    if (ended) requested &= ~(1u << k);
                }
            }
        }
    }

    const WideBvhView<kWideChildren> bvh_;
    const Ray* const rays_;
    Visitor* visitors_ = nullptr;
    Eight eights_[kPacketEights];
    Extent extents_[3];
    bool back_[3], is_coherent_ = true;
    float min_t_ = kInfinity;
};

} // namespace pertev
