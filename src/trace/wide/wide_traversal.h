#pragma once

// Traversal of a 4- or 8-wide tree with float boxes, one box after another, on host and device: a stack of children
// with their entry parameters, sorted by them or in the builder's order.
//
// Source: Wald, Benthin, Boulos, "Getting Rid of Packets", IEEE RT 2008, with a scalar box test; RTA drops a child
// entered beyond the nearest hit when it is pushed and again when it is popped.

#include <cstdint>

#include "accel/bvh/wide_bvh.h"
#include "base/host_device.h"
#include "math/float4.h"
#include "trace/binary/traversal_stack.h"
#include "trace/intersect/fast_min_max.h"
#include "trace/intersect/load_bvh.h"
#include "trace/intersect/test_leaf.h"
#include "trace/traversal/traversal_options.h"

namespace pertev {

/// Four planes of one row of WideBvhNode::planes.
HD inline Float4 load_planes(const float* row) { return load_aligned(reinterpret_cast<const Float4*>(row)); }

/// Tests four children of a node from `first` on. Bit k is set if child first + k may hold a hit with t_min < t <=
/// t_limit; its entry parameter goes to entries[k]. Empty slots have inverted boxes, which are never entered.
template <int kWidth>
HD inline uint32_t enters_4_children(const RayBoxes& r, const WideBvhNode<kWidth>* node, int first, float t_min,
                                     float t_limit, float (&entries)[4]) {
    const bool back_x = r.inv.x < 0, back_y = r.inv.y < 0, back_z = r.inv.z < 0;
    const Float4 x0 = load_planes(node->planes[back_x ? 1 : 0] + first);
    const Float4 x1 = load_planes(node->planes[back_x ? 0 : 1] + first);
    const Float4 y0 = load_planes(node->planes[back_y ? 3 : 2] + first);
    const Float4 y1 = load_planes(node->planes[back_y ? 2 : 3] + first);
    const Float4 z0 = load_planes(node->planes[back_z ? 5 : 4] + first);
    const Float4 z1 = load_planes(node->planes[back_z ? 4 : 5] + first);
    const Vec3 near = {back_x ? r.hi.x : r.lo.x, back_y ? r.hi.y : r.lo.y, back_z ? r.hi.z : r.lo.z};
    const Vec3 far = {back_x ? r.lo.x : r.hi.x, back_y ? r.lo.y : r.hi.y, back_z ? r.lo.z : r.hi.z};
    const auto enters = [&](float nx, float ny, float nz, float fx, float fy, float fz, float& entry) {
        entry = fast_max(fast_max(fma(nx, r.inv.x, near.x), fma(ny, r.inv.y, near.y)),
                         fast_max(fma(nz, r.inv.z, near.z), t_min));
        const float exit = fast_min(fast_min(fma(fx, r.inv.x, far.x), fma(fy, r.inv.y, far.y)),
                                    fast_min(fma(fz, r.inv.z, far.z), t_limit));
        return entry <= exit ? 1u : 0u;
    };
    uint32_t mask = enters(x0.x, y0.x, z0.x, x1.x, y1.x, z1.x, entries[0]);
    mask |= enters(x0.y, y0.y, z0.y, x1.y, y1.y, z1.y, entries[1]) << 1;
    mask |= enters(x0.z, y0.z, z0.z, x1.z, y1.z, z1.z, entries[2]) << 2;
    mask |= enters(x0.w, y0.w, z0.w, x1.w, y1.w, z1.w, entries[3]) << 3;
    return mask;
}

template <int kWidth, TraversalOptions kOptions>
struct WideTraversal {
    using Tree = WideBvhView<kWidth>;

    template <class Visitor, class Counter>
    HD static bool traverse(const Tree& bvh, const Ray& ray, uint32_t instance, Visitor& visitor,
                            const Counter& counter) {
        using Tests = TestsOf<kOptions>;
        if (bvh.nodes == nullptr) return false;
        TraversalStackEntry stack[kWideStackSize<kWidth>];
        int size = 0;
        const RayBoxes boxes = Tests::make_boxes(ray, bvh.bounds_max_abs);
        const typename Tests::Triangles prepared = Tests::make_triangles(ray);
        uint32_t link = 0;
        for (;;) {
            if (link & kLeafBit) {
                if (test_leaf<Tests>(bvh.triangles, link, ray, prepared, instance, visitor, counter)) return true;
            } else {
                counter.add_node(bvh.nodes + link);
                push_children<Visitor>(bvh.nodes + link, boxes, ray.t_min, skip_beyond<kOptions>(visitor, ray), stack,
                                       size);
            }
            do {
                if (size == 0) return false;
                --size;
            } while (!(stack[size].entry <= skip_beyond<kOptions>(visitor, ray)));
            link = stack[size].link;
        }
    }

private:
    /// Pushes the entered children, the one to enter first last.
    template <class Visitor>
    HD static void push_children(const WideBvhNode<kWidth>* node, const RayBoxes& boxes, float t_min, float t_limit,
                                 TraversalStackEntry* stack, int& size) {
        const int base = size;
        for (int first = kWidth - 4; first >= 0; first -= 4) {
            float entries[4];
            const uint32_t mask = enters_4_children(boxes, node, first, t_min, t_limit, entries);
            if (mask == 0) continue;
            const Uint4 links = load_aligned(reinterpret_cast<const Uint4*>(node->child + first));
            const auto push = [&](uint32_t entered, float entry, uint32_t link) {
                if (entered == 0) return;
                int slot = size++;
                if constexpr (kOptions.near_first) {
                    for (; slot > base && stack[slot - 1].entry < entry; --slot) stack[slot] = stack[slot - 1];
                }
                stack[slot] = {link, entry};
            };
            push(mask & 8, entries[3], links.w);
            push(mask & 4, entries[2], links.z);
            push(mask & 2, entries[1], links.y);
            push(mask & 1, entries[0], links.x);
        }
    }
};

template <TraversalOptions kOptions>
using Wide4Traversal = WideTraversal<4, kOptions>;
template <TraversalOptions kOptions>
using Wide8Traversal = WideTraversal<8, kOptions>;

} // namespace pertev
