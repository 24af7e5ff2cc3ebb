#pragma once

// Packet traversal by a whole warp: its rays are always at the same node, which is entered if any of them enters it.
// There is one stack, of whose links each lane keeps a copy, with the lane's own entry parameter beside it, so that
// every push and pop of a warp accesses one line of memory. It is meant for persistent warps
// (trace/warps/persistent.h), whose lanes mostly start together.
//
// Source: Guenther, Popov, Seidel, Slusallek, "Realtime Ray Tracing on GPU with BVH-based Packet Traversal", IEEE RT
// 2007 (the majority decides which child is visited first); Aila, Laine, HPG 2009, section 3 (the same as persistent
// packets). Lanes with different trees form separate packets. On the host a packet is one ray, and visits what
// WhileWhileTraversal visits; packet_traversal.h has the host's own packets.

#include <cstdint>

#include "base/limits.h"
#include "trace/binary/traversal_stack.h"
#include "trace/intersect/test_leaf.h"
#include "trace/traversal/traversal_options.h"
#include "trace/warps/warp_vote.h"

namespace pertev {

template <TraversalOptions kOptions>
struct WarpPacketTraversal {
    using Tree = BvhView;

    template <class Visitor, class Counter>
    HD static bool traverse(const BvhView& bvh, const Ray& ray, uint32_t instance, Visitor& visitor,
                            const Counter& counter) {
        using Tests = TestsOf<kOptions>;
        // An instance's rays have their own space, but all instances of a mesh have the same tree.
        const LaneMask packet = lanes_with_same(lanes_here(), reinterpret_cast<uint64_t>(bvh.triangles));
        const auto boxes = Tests::make_boxes(ray, bvh.bounds_max_abs);
        const auto prepared = Tests::make_triangles(ray);
        TraversalStackEntry stack[kMaxBvhDepth]; // links of the packet, entries of the lane
        int size = 0;
        uint32_t link = bvh.root; // like size, equal in every lane of the packet
        bool takes_part = true, found = false;
        const auto pop = [&] {
            const float limit = skip_beyond<kOptions>(visitor, ray);
            while (size > 0) {
                const TraversalStackEntry top = stack[--size];
                takes_part = !found && top.entry <= limit;
                if (ballot(packet, takes_part) != 0) return top.link;
            }
            return kNoLink;
        };
        while (link != kNoLink) {
            if (link & kLeafBit) {
                if (takes_part) {
                    found = test_leaf<Tests>(bvh.triangles, link, ray, prepared, instance, visitor, counter);
                }
                link = pop();
                continue;
            }
            if (takes_part) counter.add_node(bvh.nodes + link);
            const BvhNode node = load_aligned(bvh.nodes + link);
            const float limit = skip_beyond<kOptions>(visitor, ray);
            float entry0, entry1;
            const bool enters0 = enters_child(boxes, node, 0, ray.t_min, limit, entry0) && takes_part;
            const bool enters1 = enters_child(boxes, node, 1, ray.t_min, limit, entry1) && takes_part;
            const LaneMask into0 = ballot(packet, enters0), into1 = ballot(packet, enters1);
            if (into0 != 0 && into1 != 0) {
                bool second = false; // child 1 first
                if constexpr (kOptions.near_first) {
                    const int both = count_lanes(into0 & into1);
                    second =
                        both != 0 && 2 * count_lanes(ballot(packet, enters0 && enters1 && entry1 <= entry0)) >= both;
                }
                const bool enters_later = second ? enters0 : enters1;
                stack[size++] = {second ? node.child[0] : node.child[1],
                                 enters_later ? (second ? entry0 : entry1) : kNeverEntered};
                link = second ? node.child[1] : node.child[0];
                takes_part = second ? enters1 : enters0;
            } else if ((into0 | into1) != 0) {
                link = into0 != 0 ? node.child[0] : node.child[1];
                takes_part = into0 != 0 ? enters0 : enters1;
            } else {
                link = pop();
            }
        }
        return found;
    }

private:
    static constexpr float kNeverEntered = __builtin_nanf(""); // not <= any limit
};

} // namespace pertev
