#pragma once

// Traverses one mesh with coherent rays together, host only: the children of a node are tested at once for the whole
// packet, with intervals that contain all origins and directions, and the remaining ones one by one for groups of rays,
// as many as a vector holds. A triangle is loaded once for all. Each ray gets the hit that it would get alone.
//
// Source: Wald, Boulos, Shirley, "Ray Tracing Deformable Scenes Using Dynamic Bounding Volume Hierarchies", ACM TOG
// 26(1), 2007, section 4: packets over a hierarchy with intervals; nodes of eight as in traverse_wide.h. An any-hit
// search keeps the builder's order, even for rays without an end (trace_any.h): coherent ones mostly go to one sun,
// and with far children first fewer of them stay together. No hit is lost by the intervals: planes are moved out for
// each ray (ray_boxes.h) by 16 units, of which a bound computed as (plane - moved origin) times 1/direction loses
// four and the triangle test six.

#include <array>
#include <cstdint>

#include "math/portable_exp_log.h"
#include "trace/intersect/intersect_rays.h"
#include "trace/wide/traverse_wide.h"

namespace pertev {

inline constexpr int kWidePacket = 32;

/// `F` is Floats8 or Floats16: the rays of a group.
template <TraversalOptions kOptions, class Visitor, class F>
class WidePacket {
    static_assert(kOptions.is_exact());
    static constexpr float kMaxSpread = 0.25f; // maximum spread of slopes; with more, rays share too few nodes
    static constexpr int kLanes = F::kLanes, kGroups = kWidePacket / kLanes;
    static constexpr unsigned kAllLanes = (1u << kLanes) - 1;
    using Mask = MaskOf<F>;

public:
    /// Makes a packet of kWidePacket rays; those that are not needed are copies of one of the others, with its visitor.
    /// `rays` and, for run(), `visitors` outlive it.
    WidePacket(const WideBvhView<kWideChildren>& bvh, const Ray* rays) : bvh_(bvh), rays_(rays) {
        const RayShear first = make_ray_shear(rays[0].direction);
        for (int axis = 0; axis < 3; ++axis) {
            back_[axis] = guard_direction(component(rays[0].direction, axis)) < 0;
            extents_[axis] = {kInfinity, 0, -kInfinity, kInfinity};
        }
        for (int g = 0; g < kGroups; ++g) {
            F columns[8];
            load_rays(rays + kLanes * g, columns);
            const F *const origin = columns, *const direction = columns + 4;
            const F size = max(max(abs(origin[0]), abs(origin[1])), abs(origin[2]));
            const F growth = 0x1p-20f * (size + bvh.bounds_max_abs);
            Group& group = groups_[g];
            for (int axis = 0; axis < 3; ++axis) set_axis(group, axis, origin[axis], direction[axis], growth);
            set_shear(group, columns, first);
            group.t_min = columns[3], group.t_max = columns[7];
            min_t_ = min(min_t_, least_of(group.t_min));
        }
    }

    /// Returns whether the rays are coherent; others must not run.
    bool is_coherent() const { return is_coherent_; }

    void run(Visitor* visitors, int count) {
        visitors_ = visitors;
        for (int k = 0; k < kWidePacket; ++k) {
            groups_[k / kLanes].limits[k % kLanes] = k < count ? visitors[k].limit() : -kInfinity;
        }
        traverse();
    }

private:
    struct Group {
        F inv[3], near[3], far[3], t_min, t_max;
        RayShearOf<F> shear;
        alignas(64) float limits[kLanes]; // limits of the visitors; -inf for rays that are done
    };

    /// Computes make_ray_boxes for a group along an axis, and its bounds.
    void set_axis(Group& group, int axis, F origin, F d, F growth) {
        const F guarded = select(abs(d) < 0x1p-80f, copysign(F(0x1p-80f), d), d);
        const F inv = 1.0f / guarded;
        const bool back = back_[axis];
        is_coherent_ = is_coherent_ && bit_mask(guarded < 0.0f) == (back ? kAllLanes : 0u);
        const F above = origin + growth, below = origin - growth;
        const F lo = -(above * inv), hi = -(below * inv);
        group.inv[axis] = inv, group.near[axis] = back ? hi : lo, group.far[axis] = back ? lo : hi;
        // A plane's parameter is (plane - q) |1/d| in positive and (-plane - (-q)) |1/d| in negative direction.
        const F q_near = back ? -below : above, q_far = back ? -above : below, size = abs(inv);
        Extent& all = extents_[axis];
        all = {min(all.min_inv, least_of(size)), max(all.max_inv, greatest_of(size)),
               max(all.max_near, greatest_of(q_near)), min(all.min_far, least_of(q_far))};
    }

    void traverse() {
        struct Waiting {
            F entry[kGroups]; // NaN for rays that do not enter
            uint32_t link, count;
        };
        Waiting stack[kWideStackSize<kWideChildren>];
        int size = 0;
        uint32_t link = 0, count = 0;
        unsigned active[kGroups] = {};
        for (;;) {
            if (!(link & kLeafBit)) {
                const WideBvhNode<kWideChildren>& node = bvh_.nodes[link];
                int order[kWideChildren];
                for (int n = enter_together(node, order); n-- > 0;) { // the first one ends on top
                    const int k = order[n];
                    Waiting& next = stack[size];
                    unsigned some = 0;
                    for (int g = 0; g < kGroups; ++g) some |= enter_child(groups_[g], node, k, next.entry[g]);
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
                for (int g = 0; g < kGroups; ++g) {
                    active[g] = bit_mask(top.entry[g] <= F::load(groups_[g].limits));
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

    /// Makes the shears of a group that shares the first ray's order of axes, like make_ray_shear.
    void set_shear(Group& group, const F (&columns)[8], const RayShear& first) {
        const F x = abs(columns[4]), y = abs(columns[5]), z = abs(columns[6]);
        const Mask with_x = x >= y && x >= z, with_y = !(x >= y) && y >= z;
        const Mask with = first.kz == 0 ? with_x : first.kz == 1 ? with_y : !(with_x || with_y);
        const RayShearOf<F>& shear = group.shear = make_shear_of_rays(columns, first.kz);
        const F spread = abs(shear.sx - first.sx) + abs(shear.sy - first.sy);
        is_coherent_ = is_coherent_ && bit_mask(with && spread < kMaxSpread) == kAllLanes;
    }

    const float* near_planes(const WideBvhNode<kWideChildren>& node, int axis) const {
        return node.planes[2 * axis + (back_[axis] ? 1 : 0)];
    }
    const float* far_planes(const WideBvhNode<kWideChildren>& node, int axis) const {
        return node.planes[2 * axis + (back_[axis] ? 0 : 1)];
    }

    /// Finds the children that any ray of the packet may enter: their number and order.
    [[gnu::always_inline]] int enter_together(const WideBvhNode<kWideChildren>& node,
                                              int (&order)[kWideChildren]) const {
        F limits = F::load(groups_[0].limits);
        for (int g = 1; g < kGroups; ++g) limits = max(limits, F::load(groups_[g].limits));
        Floats8 entry = min_t_, exit = greatest_of(limits);
        for (int axis = 0; axis < 3; ++axis) {
            const Extent& extent = extents_[axis];
            const Floats8 sign = back_[axis] ? -1.0f : 1.0f, least = extent.min_inv, most = extent.max_inv;
            const Floats8 a = fma(Floats8::load(near_planes(node, axis)), sign, -extent.max_near);
            const Floats8 b = fma(Floats8::load(far_planes(node, axis)), sign, -extent.min_far);
            entry = max(entry, min(a * least, a * most));
            exit = min(exit, max(b * least, b * most));
        }
        float entries[kWideChildren];
        entry.store(entries);
        int n = 0;
        for (unsigned rest = bit_mask(entry <= exit); rest != 0; rest &= rest - 1) {
            const int k = __builtin_ctz(rest);
            int slot = n++;
            for (; kOptions.near_first && slot > 0 && entries[order[slot - 1]] > entries[k]; --slot) {
                order[slot] = order[slot - 1];
            }
            order[slot] = k;
        }
        return n;
    }

    /// Tests the box of child k for a group, like enters_children (traverse_wide.h). The result is nonzero if any ray
    /// enters, with the entry parameters.
    [[gnu::always_inline]] unsigned enter_child(const Group& group, const WideBvhNode<kWideChildren>& node, int k,
                                                F& entry) const {
        const auto near = [&](int axis) {
            return fma(F(near_planes(node, axis)[k]), group.inv[axis], group.near[axis]);
        };
        const auto far = [&](int axis) { return fma(F(far_planes(node, axis)[k]), group.inv[axis], group.far[axis]); };
        const F first = max(max(near(0), near(1)), max(near(2), group.t_min));
        const F last = min(min(far(0), far(1)), min(far(2), F::load(group.limits)));
        const Mask enters = first <= last;
        entry = select(enters, first, F(kNaN));
        return bit_mask(enters);
    }

    void test_leaf(const BvhTriangle* triangles, uint32_t count, const unsigned (&active)[kGroups]) {
        for (int g = 0; g < kGroups; ++g) {
            Group& group = groups_[g];
            unsigned requested = active[g];
            if (requested == 0) continue;
            for (uint32_t i = 0; i < count; ++i) {
                const BvhTriangle& triangle = triangles[i];
                const TriangleHitsOf<F> hits = intersect_rays<F>(
                    group.shear, {group.t_min, group.t_max, F::load(group.limits)}, triangle, requested);
                for (unsigned rest = hits.hit | hits.slow; rest != 0; rest &= rest - 1) {
                    const auto k = static_cast<uint32_t>(__builtin_ctz(rest));
                    TriangleHit hit = {hits.at.t[k], hits.at.u[k], hits.at.v[k]};
                    if ((hits.slow >> k & 1) != 0 &&
                        !intersect_alone(rays_[kLanes * g + k], group.limits[k], triangle, hit)) {
                        continue;
                    }
                    Visitor& visitor = visitors_[kLanes * g + k];
                    const bool ended = visitor.visit(triangle.instance, triangle.primitive, hit);
                    group.limits[k] = ended ? -kInfinity : visitor.limit();
                    if (ended) requested &= ~(1u << k);
                }
            }
        }
    }

    const WideBvhView<kWideChildren> bvh_;
    const Ray* const rays_;
    Visitor* visitors_ = nullptr;
    Group groups_[kGroups];
    Extent extents_[3];
    bool back_[3], is_coherent_ = true;
    float min_t_ = kInfinity;
};

} // namespace pertev
