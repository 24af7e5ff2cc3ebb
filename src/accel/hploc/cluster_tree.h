#pragma once

// The binary tree that H-PLOC makes, with each node's plan for the conversion to a wide tree. A node's number depends
// only on the triangles: leaf i is triangle i along the Morton curve. A cluster is named by the first leaf of its
// first part, so when two merge, the second's name is never used again, and the new node takes it. There is no shared
// counter, so any number of threads produces the same bytes.
//
// Source of the plan: Ylitie, Karras, Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide
// BVHs", HPG 2017, section 3.1, as in accel/bvh/collapse_tree.h, but made on the way up, with the size of each
// choice, so that on the way down every wide node finds its position independently.

#include <cstdint>

#include "accel/bvh/collapse_tree.h"
#include "base/host_device.h"
#include "math/bounds3.h"
#include "math/scalar.h"

namespace pertev::hploc {

inline constexpr uint32_t kNone = 0xffffffffu;

/// Nodes [0, n) are leaves. Node n + q, for q in [1, n), was made when the cluster named q ended.
struct alignas(32) ClusterNode {
    Vec3 lo;
    uint32_t left; // a node; in a leaf the triangle's index in the input
    Vec3 hi;
    uint32_t right; // a node; kNone in a leaf

    HD Bounds3 box() const { return {lo, hi}; }
    HD bool is_leaf() const { return right == kNone; }
};

/// The least costs of a subtree with at most 1 to 7 roots, and the choices that give them.
struct alignas(32) CollapsePlan {
    float cost[kMaxWidth - 1]; // [j - 1]: with at most j roots
    uint32_t splits; // bits 3 j .. 3 j + 2, j in [2, 8]: how many of j roots the left child has; 0: j - 1 roots are
                     // as good. Bit 0: with one root it is a leaf

    HD bool is_leaf() const { return (splits & 1u) != 0; }
    HD uint32_t left_roots(uint32_t roots) const { return splits >> (3 * roots) & 7u; }
};

/// The sizes of the trees that a CollapsePlan gives.
struct alignas(32) CollapseSize {
    uint32_t nodes[kMaxWidth - 1]; // [j - 1]: wide nodes of the subtree with at most j roots
    uint32_t triangles;
};

struct ClusterTree {
    ClusterNode* nodes;  // [2 n]; [n] is unused
    CollapsePlan* plans; // [n], of node n + q
    CollapseSize* sizes; // [n], of node n + q
    uint32_t count;      // n, at least 1
    CollapseSettings costs;
};

/// Loads a value that another thread of this launch may have written, bypassing caches that are not coherent.
template <class T>
HD inline T load_fresh(const T* at) {
#if defined(__CUDA_ARCH__)
    static_assert(sizeof(T) % 16 == 0 || sizeof(T) == 8);
    T value;
    if constexpr (sizeof(T) == 8) {
        *reinterpret_cast<uint2*>(&value) = __ldcg(reinterpret_cast<const uint2*>(at));
    } else {
        for (unsigned k = 0; k < sizeof(T) / 16; ++k) {
            reinterpret_cast<uint4*>(&value)[k] = __ldcg(reinterpret_cast<const uint4*>(at) + k);
        }
    }
    return value;
#else
    return *at;
#endif
}

/// Plan and size of a leaf or an inner node.
struct Plans {
    CollapsePlan plan;
    CollapseSize size;
};

HD inline Plans leaf_plans(const ClusterTree& tree, float area) {
    Plans plans;
    for (int j = 0; j < kMaxWidth - 1; ++j) {
        plans.plan.cost[j] = area * tree.costs.triangle_cost;
        plans.size.nodes[j] = 0;
    }
    plans.plan.splits = 1;
    plans.size.triangles = 1;
    return plans;
}

/// Plans of any node; `area` belongs to its box.
HD inline Plans plans_of(const ClusterTree& tree, uint32_t node, float area) {
    if (node < tree.count) return leaf_plans(tree, area);
    return {load_fresh(tree.plans + (node - tree.count)), load_fresh(tree.sizes + (node - tree.count))};
}

/// Returns the plans of an inner node, by the decisions of CollapsedTree, except that any triangles of a subtree may
/// share a leaf.
HD inline Plans plan_inner(const CollapseSettings& costs, float area, const Plans& left, const Plans& right) {
    Plans plans;
    plans.size.triangles = left.size.triangles + right.size.triangles;
    float least[kMaxWidth + 1]; // [j]: with exactly j roots, or fewer on a side that cannot have more
    uint32_t nodes[kMaxWidth + 1], splits[kMaxWidth + 1];
#if defined(__CUDA_ARCH__)
#pragma unroll
#endif
    for (int j = 2; j <= kMaxWidth; ++j) {
        least[j] = left.plan.cost[0] + right.plan.cost[j - 2];
        nodes[j] = left.size.nodes[0] + right.size.nodes[j - 2];
        splits[j] = 1;
#if defined(__CUDA_ARCH__)
#pragma unroll
#endif
        for (int k = 2; k < j; ++k) {
            const float cost = left.plan.cost[k - 1] + right.plan.cost[j - k - 1];
            if (!(cost < least[j])) continue;
            least[j] = cost;
            nodes[j] = left.size.nodes[k - 1] + right.size.nodes[j - k - 1];
            splits[j] = static_cast<uint32_t>(k);
        }
    }
    const float as_node = least[kMaxWidth] + area * costs.node_cost;
    const bool may_be_leaf = plans.size.triangles <= static_cast<uint32_t>(costs.max_leaf);
    // The search tests one triangle per step, as in the traversal of compressed nodes.
    const float as_leaf = area * (costs.triangle_cost * static_cast<float>(plans.size.triangles));
    const bool leaf = may_be_leaf && as_leaf <= as_node;
    plans.plan.splits = splits[kMaxWidth] << (3 * kMaxWidth) | (leaf ? 1u : 0u);
    plans.plan.cost[0] = leaf ? as_leaf : as_node;
    plans.size.nodes[0] = leaf ? 0 : 1 + nodes[kMaxWidth];
#if defined(__CUDA_ARCH__)
#pragma unroll
#endif
    for (int j = 2; j < kMaxWidth; ++j) {
        const bool fewer = least[j] > plans.plan.cost[j - 2]; // if both cost the same, the shallower tree
        plans.plan.cost[j - 1] = fewer ? plans.plan.cost[j - 2] : least[j];
        plans.size.nodes[j - 1] = fewer ? plans.size.nodes[j - 2] : nodes[j];
        plans.plan.splits |= (fewer ? 0u : splits[j]) << (3 * j);
    }
    return plans;
}

/// A part of the tree that has no parent yet.
struct alignas(8) Cluster {
    uint32_t node; // kNone if there is none
    uint32_t name; // a leaf that names no other cluster
};

/// Merges two clusters, whose boxes are `left_box` and `right_box`, and returns the new one. The node's number is the
/// second's name.
HD inline Cluster join(const ClusterTree& tree, Cluster left, const Bounds3& left_box, Cluster right,
                       const Bounds3& right_box) {
    Bounds3 both = left_box;
    both.extend(right_box);
    const Plans plans = plan_inner(tree.costs, both.half_area(), plans_of(tree, left.node, left_box.half_area()),
                                   plans_of(tree, right.node, right_box.half_area()));
    const uint32_t node = tree.count + right.name;
    tree.nodes[node] = {both.lo, left.node, both.hi, right.node};
    tree.plans[right.name] = plans.plan;
    tree.sizes[right.name] = plans.size;
    return {node, left.name};
}

} // namespace pertev::hploc
