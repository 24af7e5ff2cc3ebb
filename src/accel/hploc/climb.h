#pragma once

// The bottom-up H-PLOC build: threads climb the radix tree of the Morton codes from its leaves. The second thread to
// reach a node merges the clusters of its two children by nearest neighbours until few are left; at the root one is
// left.
//
// Source: Benthin, Meister, Barczak, Mehalwal, Tsakok, Kensler, "H-PLOC: Hierarchical Parallel Locally-Ordered
// Clustering for Bounding Volume Hierarchy Construction", HPG 2024, sections 3 and 4; the climb is from Apetrei,
// "Fast and Simple Agglomerative LBVH Construction", CGVC 2014. The clusters that a radix node leaves depend only on
// those that its children leave, so the tree does not depend on the order of threads. Ties are resolved as in
// accel/builders/build_ploc.cpp.
//
// This is the CPU's form with one thread per leaf; tracer/hploc/warp_kernels.h has the form with one warp per node.

#include <cstdint>

#include "accel/hploc/cluster_tree.h"
#include "base/host_device.h"
#include "math/bits.h"

namespace pertev::hploc {

inline constexpr uint32_t kKept = 16;               // maximum number of clusters that a radix node leaves to its parent
inline constexpr uint32_t kMaxClusters = 2 * kKept; // maximum number of clusters before merging
inline constexpr uint32_t kSearchRadius = 8;        // neighbours searched on either side

struct Climb {
    ClusterTree tree;
    const uint64_t* codes; // [n], ascending; null: halves of equal counts, and one cluster per node
    Cluster* clusters;     // [n]: the clusters left by a node with leaves [first, last], more than kKept, start at
                           // `first`; fewer than kKept end with kNone
    uint32_t* ends;        // [n], kNone at first: for the gap after leaf i, the far end of the range that arrived
                           // there
    uint32_t* root;        // root of the tree, set at the end

    HD uint32_t kept() const { return codes != nullptr ? kKept : 1; }
};

/// A radix node with leaves [first, middle) and [middle, last].
struct LeafRange {
    uint32_t first, middle, last;

    HD uint32_t size() const { return last - first + 1; }
};

/// Returns whether the gap after leaf i is deeper in the radix tree than the gap after leaf k.
HD inline bool is_deeper(const uint64_t* codes, uint32_t i, uint32_t k) {
    if (codes == nullptr) return (i ^ (i + 1)) < (k ^ (k + 1));
    const uint64_t of_i = codes[i] ^ codes[i + 1], of_k = codes[k] ^ codes[k + 1];
    if (of_i != of_k) return of_i < of_k;
    return (i ^ (i + 1)) < (k ^ (k + 1)); // equal codes only: 0
}

HD inline uint32_t exchange(uint32_t* target, uint32_t value) {
#if defined(__CUDA_ARCH__)
    return atomicExch(target, value);
#else
    return __atomic_exchange_n(target, value, __ATOMIC_ACQ_REL);
#endif
}

/// Moves from a node (leaves [first, last], not all) to its parent. Returns false if the other child has not arrived
/// yet.
HD inline bool ascend(const Climb& climb, LeafRange& range) {
    const uint32_t n = climb.tree.count;
    const bool is_left =
        range.first == 0 || (range.last != n - 1 && is_deeper(climb.codes, range.last, range.first - 1));
    const uint32_t other =
        is_left ? exchange(climb.ends + range.last, range.first) : exchange(climb.ends + (range.first - 1), range.last);
    if (other == kNone) return false;
    if (is_left) {
        range.middle = range.last + 1;
        range.last = other;
    } else {
        range.middle = range.first;
        range.first = other;
    }
    return true;
}

/// Returns whether the node's clusters must be merged; otherwise its clusters are its leaves.
HD inline bool needs_merging(const Climb& climb, const LeafRange& range) {
    return range.size() > climb.kept() || range.size() == climb.tree.count;
}

/// Number of clusters that are left when a node is done.
HD inline uint32_t clusters_to_leave(const Climb& climb, const LeafRange& range) {
    return range.size() == climb.tree.count ? 1 : climb.kept();
}

/// Sort key of merging the neighbours at positions i and k; the smallest is preferred. Areas are not negative.
HD inline uint64_t preference(float area, uint32_t i, uint32_t k) {
    return static_cast<uint64_t>(bits_of(area)) << 32 | (i ^ k);
}

/// Cluster `slot` of the node over leaves [first, end); kNone past the last.
HD inline Cluster cluster_left(const Climb& climb, uint32_t first, uint32_t end, uint32_t slot) {
    if (end - first <= climb.kept()) return {first + slot, first + slot}; // its leaves
    return load_fresh(climb.clusters + first + slot);
}

/// Merges the clusters of a node in one thread.
HD inline void join_range(const Climb& climb, const LeafRange& range) {
    Cluster clusters[kMaxClusters];
    Bounds3 boxes[kMaxClusters];
    uint32_t count = 0;
    const auto take = [&](uint32_t first, uint32_t end) {
        const uint32_t most = end - first < climb.kept() ? end - first : climb.kept();
        for (uint32_t i = 0; i < most; ++i) {
            const Cluster cluster = cluster_left(climb, first, end, i);
            if (cluster.node == kNone) break;
            clusters[count] = cluster;
            boxes[count++] = load_fresh(climb.tree.nodes + cluster.node).box();
        }
    };
    take(range.first, range.middle);
    take(range.middle, range.last + 1);
    const uint32_t leave = clusters_to_leave(climb, range);
    while (count > leave) {
        uint64_t best[kMaxClusters];
        for (uint32_t i = 0; i < count; ++i) best[i] = ~uint64_t(0);
        for (uint32_t i = 0; i < count; ++i) {
            for (uint32_t k = i + 1; k < count && k <= i + kSearchRadius; ++k) {
                Bounds3 both = boxes[i];
                both.extend(boxes[k]);
                const uint64_t preferred = preference(both.half_area(), i, k);
                if (preferred < best[i]) best[i] = preferred;
                if (preferred < best[k]) best[k] = preferred;
            }
        }
        uint32_t kept = 0;
        for (uint32_t i = 0; i < count; ++i) {
            const uint32_t k = i ^ static_cast<uint32_t>(best[i]);
            const bool agrees = (k ^ static_cast<uint32_t>(best[k])) == i;
            if (agrees && k < i) continue;
            Cluster cluster = clusters[i];
            Bounds3 box = boxes[i];
            if (agrees) {
                cluster = join(climb.tree, cluster, box, clusters[k], boxes[k]);
                box.extend(boxes[k]);
            }
            clusters[kept] = cluster;
            boxes[kept++] = box;
        }
        count = kept;
    }
    const uint32_t capacity = range.size() < climb.kept() ? range.size() : climb.kept();
    for (uint32_t i = 0; i < capacity; ++i)
        climb.clusters[range.first + i] = i < count ? clusters[i] : Cluster{kNone, 0};
    if (range.size() == climb.tree.count) *climb.root = clusters[0].node;
}

/// The stage that builds the tree. The call for a leaf climbs while it is the second to arrive at a node.
struct ClimbFromLeaves {
    Climb climb;

    HD void operator()(uint32_t leaf) const {
        LeafRange range = {leaf, leaf, leaf};
        while (range.size() < climb.tree.count && ascend(climb, range)) {
            if (needs_merging(climb, range)) join_range(climb, range);
        }
        if (climb.tree.count == 1) *climb.root = 0;
    }
};

} // namespace pertev::hploc
