#pragma once

// Converts the binary tree to compressed nodes and orders their triangles, from the root down. A node's plan holds
// the number of nodes and triangles below it, so each node finds the positions of its children independently. A
// node's inner children come first, then their subtrees; triangles follow the same order. Thus every node comes after
// its parent.

#include <cstdint>

#include "accel/bvh/compress_boxes.h"
#include "accel/bvh/compressed_bvh.h"
#include "accel/hploc/cluster_tree.h"
#include "accel/hploc/leaves.h"
#include "device/atomics.h"

namespace pertev::hploc {

/// A wide node whose position is known because its parent has been made.
struct alignas(16) WideItem {
    uint32_t node;  // binary node; kNone if not placed yet
    uint32_t depth; // the root has depth 1
    uint32_t child_base, triangle_base;
};

/// Figures of the result, on the device until all is done.
struct alignas(16) WideCounts {
    uint32_t nodes; // kNone until the root is made; if it exceeds the room, nothing else is made
    int32_t depth;
    float cost;     // expected cost of a ray that hits the bounds, as WideBvh::sah_cost
    uint32_t drawn; // items taken by warps that make nodes
    Bounds3 bounds;
    uint32_t queued; // wide nodes that were placed, without the root
};

/// Writes the children of a wide node in the binary tree's order and returns their number.
HD inline uint32_t children_of(const ClusterTree& tree, uint32_t node, uint32_t (&children)[kMaxWidth]) {
    uint32_t pending[kMaxWidth], roots[kMaxWidth], size = 1, count = 0;
    pending[0] = node, roots[0] = kMaxWidth;
    while (size > 0) {
        const uint32_t at = pending[--size];
        uint32_t most = roots[size];
        uint32_t left = 0;
        if (at >= tree.count) {
            const CollapsePlan& plan = tree.plans[at - tree.count];
            while (most > 1 && (left = plan.left_roots(most)) == 0) --most;
        }
        if (left == 0) {
            children[count++] = at;
            continue;
        }
        pending[size] = tree.nodes[at].right, roots[size++] = most - left;
        pending[size] = tree.nodes[at].left, roots[size++] = left;
    }
    return count;
}

HD inline uint32_t triangles_beneath(const ClusterTree& tree, uint32_t node) {
    return node < tree.count ? 1 : tree.sizes[node - tree.count].triangles;
}

/// Input index of triangle k below a node.
HD inline uint32_t triangle_beneath(const ClusterTree& tree, uint32_t node, uint32_t k) {
    while (node >= tree.count) {
        const uint32_t left = tree.nodes[node].left, of_left = triangles_beneath(tree, left);
        node = k < of_left ? left : tree.nodes[node].right;
        if (k >= of_left) k -= of_left;
    }
    return tree.nodes[node].left;
}

/// Sort key of child k for slot s; the smallest fits best. It compares the projection on the slot's octant direction,
/// then k, then s. `from` points from the centre of the node to the child.
HD inline uint64_t dislike(Vec3 from, uint32_t k, uint32_t s) {
    const float cost = (s & 1 ? -from.x : from.x) + (s & 2 ? -from.y : from.y) + (s & 4 ? -from.z : from.z);
    const uint32_t of_cost = static_cast<uint32_t>(ordered(cost + 0.0f)) ^ 0x80000000u; // -0 is 0
    return static_cast<uint64_t>(of_cost) << 32 | k << 3 | s;
}

/// Greedily assigns the remaining child and slot with the least dislike() until every child has a slot. slot_of[k] is
/// the slot of child k.
HD inline void choose_slots(const Vec3 (&from)[kMaxWidth], uint32_t count, uint32_t (&slot_of)[kMaxWidth]) {
    uint32_t children = (1u << count) - 1, slots = 0xffu;
    while (children != 0) {
        uint64_t least = ~uint64_t(0);
        for (uint32_t k = 0; k < count; ++k) {
            if (!(children >> k & 1u)) continue;
            for (uint32_t s = 0; s < 8; ++s) {
                if (slots >> s & 1u && dislike(from[k], k, s) < least) least = dislike(from[k], k, s);
            }
        }
        const uint32_t child = static_cast<uint32_t>(least) >> 3, slot = static_cast<uint32_t>(least) & 7u;
        slot_of[child] = slot;
        children &= ~(1u << child);
        slots &= ~(1u << slot);
    }
}

struct EmitWide {
    ClusterTree tree;
    const uint32_t* root;
    const BvhTriangle* triangles;
    WideItem* items;          // [room] set to 0xff bytes at first; item of node i, or in warps of the i-th placed
                              // node
    uint32_t* item_nodes;     // [room] set to 0xff bytes at first; node number of each item, used only by warps
    CompressedBvhNode* nodes; // [room]
    BvhTriangle* placed;      // [tree.count]
    uint32_t* sources;        // [tree.count] input index of each placed triangle
    WideCounts* counts;       // set to 0xff bytes at first
    uint32_t capacity;

    /// Item of the root, which has no parent to place it.
    HD WideItem first_item() const { return {*root, 1, 1, 0}; }

    HD bool is_leaf(uint32_t node) const { return node < tree.count || tree.plans[node - tree.count].is_leaf(); }

    struct Placed {
        uint32_t first, count; // inner children, as wide nodes
    };

    /// Makes wide node `index` and places its inner children with store(k, item), k being the node number.
    template <class Store>
    HD Placed make(uint32_t index, const WideItem& item, const Store& store) const {
        uint32_t children[kMaxWidth], slot_of[kMaxWidth];
        const uint32_t count = children_of(tree, item.node, children);
        const Bounds3 all = tree.nodes[item.node].box();
        uint32_t child_in[kMaxWidth];
        Bounds3 boxes[kMaxWidth];
        {
            Vec3 from[kMaxWidth];
            for (uint32_t k = 0; k < count; ++k) from[k] = tree.nodes[children[k]].box().centre() - all.centre();
            choose_slots(from, count, slot_of);
        }
        uint32_t inner = 0, leaves = 0, inner_count = 0, leaf_triangles = 0;
        for (uint32_t s = 0; s < kMaxWidth; ++s) child_in[s] = kNone;
        for (uint32_t k = 0; k < count; ++k) {
            const uint32_t s = slot_of[k];
            child_in[s] = children[k];
            boxes[s] = tree.nodes[children[k]].box();
            if (is_leaf(children[k])) {
                const uint32_t held = triangles_beneath(tree, children[k]);
                leaves |= (((1u << 8 * held) - 1) & 0x010101u) << s;
                leaf_triangles += held;
            } else {
                inner |= 1u << s;
                ++inner_count;
            }
        }
        uint32_t child_base = item.child_base + inner_count, triangle_base = item.triangle_base + leaf_triangles;
        uint32_t child = item.child_base;
        if (index == 0) { // the root checks the node count first, so that nothing is written if there is no room
            uint32_t total = 1;
            for (uint32_t s = 0; s < kMaxWidth; ++s) {
                if (inner >> s & 1u) total += tree.sizes[child_in[s] - tree.count].nodes[0];
            }
            start_counts(total, all);
            if (total > capacity) return {0, 0};
        }
        for (uint32_t s = 0; s < kMaxWidth; ++s) {
            if (!(inner >> s & 1u)) continue;
            store(child++, WideItem{child_in[s], item.depth + 1, child_base, triangle_base});
            const CollapseSize& size = tree.sizes[child_in[s] - tree.count];
            child_base += size.nodes[0] - 1;
            triangle_base += size.triangles;
        }
        if (inner_count == 0) raise_depth(static_cast<int32_t>(item.depth));
        CompressedBvhNode node;
        node.exponents_and_inner = inner << 24;
        node.child_base = item.child_base;
        node.triangle_base = item.triangle_base;
        node.triangles = leaves;
        node.byte_base = kByteBase;
        compress_boxes(node, all, boxes);
        nodes[index] = node;
        uint32_t to = item.triangle_base;
        for (uint32_t bit = 0; bit < 24; ++bit) {
            if (!(leaves >> bit & 1u)) continue;
            const uint32_t from = triangle_beneath(tree, child_in[bit % 8], bit / 8);
            BvhTriangle triangle = load_triangle(triangles + from);
            const bool last = bit >= 16 || !(leaves >> (bit + 8) & 1u);
            triangle.flags = (triangle.flags & ~kLastInLeaf) | (last ? kLastInLeaf : 0u);
            sources[to] = from;
            placed[to++] = triangle;
        }
        return {item.child_base, inner_count};
    }

    // Parts of make() that hploc/warp_kernels.h uses too.

    HD void start_counts(uint32_t node_count, const Bounds3& all) const {
        const float area = all.half_area();
        counts->bounds = all;
        const float least = item_cost(*root, area);
        counts->cost = area > 0 ? least / area : 0.0f;
        store_count(node_count);
    }
    HD float item_cost(uint32_t node, float area) const {
        return node < tree.count ? area * (tree.costs.node_cost + tree.costs.triangle_cost)
                                 : tree.plans[node - tree.count].cost[0];
    }
    HD void store_count(uint32_t node_count) const {
#if defined(__CUDA_ARCH__)
        *static_cast<volatile uint32_t*>(&counts->nodes) = node_count;
#else
        counts->nodes = node_count;
#endif
    }
    HD void raise_depth(int32_t depth) const {
#if defined(__CUDA_ARCH__)
        if (depth > counts->depth) atomicMax(&counts->depth, depth);
#else
        int32_t seen = __atomic_load_n(&counts->depth, __ATOMIC_RELAXED);
        while (depth > seen &&
               !__atomic_compare_exchange_n(&counts->depth, &seen, depth, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
        }
#endif
    }
};

/// The stage that makes the wide nodes of a level, one per call. Inner children are appended to the next level in no
/// fixed order.
struct EmitLevel {
    EmitWide emit;
    const uint32_t* level;
    uint32_t* next;
    uint32_t* next_count;

    HD void operator()(uint32_t i) const {
        const uint32_t index = level[i];
        const WideItem item = index == 0 ? emit.first_item() : emit.items[index];
        const auto placed =
            emit.make(index, item, [&](uint32_t child, const WideItem& its) { emit.items[child] = its; });
        if (placed.count == 0) return;
        const uint32_t at = atomic_add(next_count, placed.count);
        for (uint32_t k = 0; k < placed.count; ++k) next[at + k] = placed.first + k;
    }
};

} // namespace pertev::hploc
