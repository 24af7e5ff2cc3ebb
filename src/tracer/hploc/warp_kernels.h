#pragma once

// CUDA kernels of the device builder; only hploc_kernels.cu includes this. A warp merges the clusters of one node of
// the radix tree, one cluster per lane, as in the source (accel/hploc/climb.h). Wide nodes are made by threads that
// wait for their parents, as in Benthin, Drabinski, Tessari, Dittebrandt, "PLOC++", 2022, section 4.
//
// The bytes equal those of the single-threaded form: the same pairs are compared by the same numbers, and each node's
// number and position follow from the triangles.

#include <cstdint>

#include "accel/bvh/compress_boxes.h"
#include "accel/hploc/climb.h"
#include "tracer/hploc/emit_wide.h"

#if PERTEV_HAS_KERNELS

namespace pertev::hploc {

inline constexpr uint32_t kClimbThreads = 32, kEmitThreads = 128, kAllLanes = 0xffffffffu;
// Blocks per multiprocessor. 25 leave 80 registers per thread without spills; more with fewer registers, or blocks of
// four warps, are as fast. Some architectures hold fewer at once, and ptxas refuses more.
#if defined(__CUDA_ARCH__) && (__CUDA_ARCH__ == 750 || __CUDA_ARCH__ == 860 || __CUDA_ARCH__ == 870)
inline constexpr uint32_t kClimbBlocks = 16;
#elif defined(__CUDA_ARCH__) && (__CUDA_ARCH__ == 890 || __CUDA_ARCH__ >= 1200)
inline constexpr uint32_t kClimbBlocks = 24;
#else
inline constexpr uint32_t kClimbBlocks = 25;
#endif
inline constexpr uint32_t kNodesAtOnce = 32 / kMaxWidth; // nodes that a warp makes at once

/// The clusters that a warp merges, in order: {corner of the box, node} and {other corner, name}.
struct WarpClusters {
    float4 lower[32], upper[32];

    __device__ Bounds3 box(uint32_t i) const {
        return {{lower[i].x, lower[i].y, lower[i].z}, {upper[i].x, upper[i].y, upper[i].z}};
    }
    __device__ Cluster cluster(uint32_t i) const { return {__float_as_uint(lower[i].w), __float_as_uint(upper[i].w)}; }
    __device__ void set(uint32_t i, const Bounds3& box, Cluster cluster) {
        lower[i] = make_float4(box.lo.x, box.lo.y, box.lo.z, __uint_as_float(cluster.node));
        upper[i] = make_float4(box.hi.x, box.hi.y, box.hi.z, __uint_as_float(cluster.name));
    }
};

/// Loads the remaining clusters of both children side by side and returns their number. The lower half of the warp
/// reads the left child.
__device__ inline uint32_t take_clusters(const Climb& climb, const LeafRange& range, WarpClusters& all, uint32_t lane) {
    const bool of_right = lane >= kKept;
    const uint32_t first = of_right ? range.middle : range.first, end = of_right ? range.last + 1 : range.middle;
    const uint32_t most = end - first < climb.kept() ? end - first : climb.kept(), slot = lane % kKept;
    const Cluster cluster = slot < most ? cluster_left(climb, first, end, slot) : Cluster{kNone, 0};
    const bool is_there = cluster.node != kNone;
    const uint32_t there = __ballot_sync(kAllLanes, is_there);
    if (is_there) {
        const auto before = static_cast<uint32_t>(__popc(there & ((1u << lane) - 1)));
        all.set(before, load_fresh(climb.tree.nodes + cluster.node).box(), cluster);
    }
    return static_cast<uint32_t>(__popc(there));
}

/// Merges the clusters of a node by all lanes of a warp, like join_range.
__device__ inline void join_range_together(const Climb& climb, const LeafRange& range, WarpClusters& all,
                                           uint32_t lane) {
    uint32_t count = take_clusters(climb, range, all, lane);
    __syncwarp();
    const uint32_t leave = clusters_to_leave(climb, range);
    while (count > leave) {
        const bool is_there = lane < count;
        const Bounds3 own = is_there ? all.box(lane) : Bounds3{};
        uint64_t best = ~uint64_t(0);
#pragma unroll
        for (uint32_t step = 1; step <= kSearchRadius; ++step) {
            uint64_t preferred = ~uint64_t(0);
            if (lane + step < count) {
                Bounds3 both = own;
                both.extend(all.box(lane + step));
                preferred = preference(both.half_area(), lane, lane + step);
            }
            const auto before =
                static_cast<uint64_t>(__shfl_up_sync(kAllLanes, static_cast<unsigned long long>(preferred), step));
            best = preferred < best ? preferred : best;
            if (lane >= step && before < best) best = before;
        }
        const uint32_t wanted = is_there ? lane ^ static_cast<uint32_t>(best) : lane;
        const bool agrees = __shfl_sync(kAllLanes, wanted, static_cast<int>(wanted & 31u)) == lane && is_there;
        const bool stays = is_there && !(agrees && wanted < lane);
        Cluster cluster = is_there ? all.cluster(lane) : Cluster{kNone, 0};
        Bounds3 box = own;
        if (stays && agrees) {
            const Bounds3 other = all.box(wanted);
            cluster = join(climb.tree, cluster, own, all.cluster(wanted), other);
            box.extend(other);
        }
        const uint32_t staying = __ballot_sync(kAllLanes, stays);
        __syncwarp();
        if (stays) all.set(static_cast<uint32_t>(__popc(staying & ((1u << lane) - 1))), box, cluster);
        count = static_cast<uint32_t>(__popc(staying));
        __syncwarp(); // lanes also read nodes and plans that other lanes wrote
    }
    const uint32_t capacity = range.size() < climb.kept() ? range.size() : climb.kept();
    if (lane < capacity) climb.clusters[range.first + lane] = lane < count ? all.cluster(lane) : Cluster{kNone, 0};
    if (lane == 0 && range.size() == climb.tree.count) *climb.root = all.cluster(0).node;
    __syncwarp();
}

/// Climbs like ClimbFromLeaves, with ranges merged by all lanes of the warp, one node after the other.
__device__ inline void climb_together(const Climb& climb, WarpClusters& all) {
    const uint32_t n = climb.tree.count, lane = threadIdx.x & 31u;
    const uint32_t leaf = blockIdx.x * blockDim.x + threadIdx.x;
    LeafRange range = {leaf, leaf, leaf};
    bool climbs = leaf < n;
    while (__any_sync(kAllLanes, climbs)) {
        bool joins = false;
        if (climbs) {
            if (range.size() == n) {
                if (n == 1) *climb.root = 0;
                climbs = false;
            } else {
                if (needs_merging(climb, range))
                    __threadfence(); // the warp's writes must be visible before its
                                     // arrival is counted
                climbs = ascend(climb, range);
                joins = climbs && needs_merging(climb, range);
                if (joins) __threadfence();
            }
        }
        __syncwarp(); // all lanes see what any lane has read
        for (uint32_t left = __ballot_sync(kAllLanes, joins); left != 0; left &= left - 1) {
            const int source = __ffs(static_cast<int>(left)) - 1;
            const LeafRange of_lane = {__shfl_sync(kAllLanes, range.first, source),
                                       __shfl_sync(kAllLanes, range.middle, source),
                                       __shfl_sync(kAllLanes, range.last, source)};
            join_range_together(climb, of_lane, all, lane);
        }
    }
}

__global__ void __launch_bounds__(kClimbThreads, kClimbBlocks) climb_by_warps(Climb climb) {
    __shared__ WarpClusters of_warps[kClimbThreads / 32];
    climb_together(climb, of_warps[threadIdx.x / 32]);
}

// Stores an item atomically.
#if defined(PERTEV_EMULATED_WARPS)
__device__ inline void store_item(WideItem* at, const WideItem& item) { *at = item; }
__device__ inline WideItem load_item(const WideItem* at) { return *at; }
#else
__device__ inline void store_item(WideItem* at, const WideItem& item) {
    asm volatile("{\n .reg .b128 v; .reg .b64 a, b;\n mov.b64 a, {%1, %2};\n mov.b64 b, {%3, %4};\n"
                 " mov.b128 v, {a, b};\n st.relaxed.gpu.global.b128 [%0], v;\n}" ::"l"(__cvta_generic_to_global(at)),
                 "r"(item.node), "r"(item.depth), "r"(item.child_base), "r"(item.triangle_base)
                 : "memory");
}
__device__ inline WideItem load_item(const WideItem* at) {
    WideItem item;
    asm volatile("{\n .reg .b128 v; .reg .b64 a, b;\n ld.relaxed.gpu.global.b128 v, [%4];\n mov.b128 {a, b}, v;\n"
                 " mov.b64 {%0, %1}, a;\n mov.b64 {%2, %3}, b;\n}"
                 : "=r"(item.node), "=r"(item.depth), "=r"(item.child_base), "=r"(item.triangle_base)
                 : "l"(__cvta_generic_to_global(at))
                 : "memory");
    return item;
}
#endif

// Memory through which the eight lanes that make a wide node, one lane per child, exchange data.
struct alignas(16) GroupMemory {
    uint2 entries[kMaxWidth];
    CompressedBvhNode node;
    uint32_t triangles[kCompressedLeaf * kMaxWidth]; // input indices; kLast marks the last triangle of a leaf
};
inline constexpr uint32_t kLast = 0x80000000u;

__device__ inline uint64_t min_of_group(uint64_t x) {
    for (uint32_t step = 1; step < kMaxWidth; step *= 2) {
        const auto other = static_cast<uint64_t>(__shfl_xor_sync(kAllLanes, static_cast<unsigned long long>(x), step));
        x = other < x ? other : x;
    }
    return x;
}
/// Sum of x over the lanes before this one in its group.
__device__ inline uint32_t sum_before(uint32_t x, uint32_t k) {
    uint32_t sum = x;
    for (uint32_t step = 1; step < kMaxWidth; step *= 2) {
        const uint32_t before = __shfl_up_sync(kAllLanes, sum, step, kMaxWidth);
        if (k >= step) sum += before;
    }
    return sum - x;
}

/// Finds the children of a wide node in parallel, like children_of: each lane gets a child or kNone, in the binary
/// tree's order. A subtree that may have j roots owns j consecutive lanes, so its halves know theirs.
__device__ inline uint32_t child_of_lane(const ClusterTree& tree, uint32_t node, GroupMemory& memory, uint32_t k) {
    uint2 own = k == 0 ? make_uint2(node, kMaxWidth) : make_uint2(kNone, 0);
    memory.entries[k] = own;
    for (;;) {
        uint32_t left = 0;
        if (own.x != kNone && own.x >= tree.count && own.y > 1) {
            const CollapsePlan& plan = tree.plans[own.x - tree.count];
            while (own.y > 1 && (left = plan.left_roots(own.y)) == 0) --own.y;
        }
        __syncwarp();
        if (!__any_sync(kAllLanes, left != 0)) return own.x;
        if (left != 0) {
            memory.entries[k + left] = make_uint2(tree.nodes[own.x].right, own.y - left);
            memory.entries[k] = make_uint2(tree.nodes[own.x].left, left);
        } else if (own.x != kNone) { // the lane that fills an empty entry may write it
            memory.entries[k].y = own.y;
        }
        __syncwarp();
        own = memory.entries[k];
    }
}

/// Chooses the slot of the lane's child (kNone if it has none), like choose_slots.
__device__ inline uint32_t slot_of_lane(uint32_t child, Vec3 from, uint32_t k) {
    uint32_t slot = kNone, free = 0xffu;
    bool wants = child != kNone;
    uint64_t own = ~uint64_t(0);
    while (__any_sync(kAllLanes, wants)) {
        if (wants && (own == ~uint64_t(0) || !(free >> (own & 7u) & 1u))) { // the lane's best slot is taken
            own = ~uint64_t(0);
#pragma unroll
            for (uint32_t s = 0; s < kMaxWidth; ++s) {
                const uint64_t cost = dislike(from, k, s);
                if (free >> s & 1u && cost < own) own = cost;
            }
        }
        const uint64_t least = min_of_group(wants ? own : ~uint64_t(0));
        if (least == ~uint64_t(0)) continue; // no lane of this group wants a slot
        const auto taken = static_cast<uint32_t>(least & 7u);
        free &= ~(1u << taken);
        if (k == static_cast<uint32_t>(least >> 3 & 7u)) {
            slot = taken;
            wants = false;
        }
    }
    return slot;
}

/// Makes wide nodes like EmitWide::make, by the eight lanes of each group that is ready. All lanes of the warp must
/// call it.
__device__ inline void make_together(const EmitWide& emit, uint32_t index, const WideItem& item, bool is_ready,
                                     GroupMemory& memory) {
    const ClusterTree& tree = emit.tree;
    const uint32_t k = threadIdx.x & 7u, group = threadIdx.x & 24u; // first lane of its group
    uint32_t child = child_of_lane(tree, is_ready ? item.node : kNone, memory, k);
    const Bounds3 all = is_ready ? tree.nodes[item.node].box() : Bounds3{};
    Bounds3 box = child != kNone ? tree.nodes[child].box() : Bounds3{};
    const uint32_t slot = slot_of_lane(child, box.centre() - all.centre(), k);

    // From here on lanes stand for slots.
    memory.entries[k].x = kNone;
    __syncwarp();
    if (slot != kNone) memory.entries[slot].x = k;
    __syncwarp();
    const uint32_t source = memory.entries[k].x;
    const int from = static_cast<int>(group + (source & 7u));
    child = __shfl_sync(kAllLanes, child, from);
    box.lo = {__shfl_sync(kAllLanes, box.lo.x, from), __shfl_sync(kAllLanes, box.lo.y, from),
              __shfl_sync(kAllLanes, box.lo.z, from)};
    box.hi = {__shfl_sync(kAllLanes, box.hi.x, from), __shfl_sync(kAllLanes, box.hi.y, from),
              __shfl_sync(kAllLanes, box.hi.z, from)};
    const bool is_there = source != kNone && is_ready;
    const bool is_inner = is_there && !emit.is_leaf(child);
    const uint32_t beneath = is_there ? triangles_beneath(tree, child) : 0;
    const uint32_t nodes_beneath = is_inner ? tree.sizes[child - tree.count].nodes[0] - 1 : 0;
    const uint32_t held = is_there && !is_inner ? beneath : 0;
    const uint32_t inner = __ballot_sync(kAllLanes, is_inner) >> group & 0xffu;
    uint32_t leaves = 0;
    for (uint32_t more = 0; more < kCompressedLeaf; ++more) {
        leaves |= (__ballot_sync(kAllLanes, held > more) >> group & 0xffu) << (8 * more);
    }
    const uint32_t nodes_before = sum_before(nodes_beneath, k),
                   triangles_before = sum_before(is_inner ? beneath : 0, k);
    const auto inner_count = static_cast<uint32_t>(__popc(inner)),
               leaf_triangles = static_cast<uint32_t>(__popc(leaves));
    const uint32_t total =
        1 + inner_count + __shfl_sync(kAllLanes, nodes_before + nodes_beneath, static_cast<int>(group + 7));
    if (index == 0 && is_ready) {
        if (k == 0) emit.start_counts(total, all);
        is_ready = total <= emit.capacity;
    }

    uint32_t first_index = 0; // position in the queue; the counter starts at -1, and the root's own position comes
                              // first
    if (is_ready && k == 0 && inner_count != 0) first_index = atomicAdd(&emit.counts->queued, inner_count) + 2;
    first_index = __shfl_sync(kAllLanes, first_index, static_cast<int>(group));
    if (is_inner && is_ready) {
        const auto rank = static_cast<uint32_t>(__popc(inner & ((1u << k) - 1)));
        *static_cast<volatile uint32_t*>(emit.item_nodes + first_index + rank) = item.child_base + rank;
        store_item(emit.items + first_index + rank,
                   {child, item.depth + 1, item.child_base + inner_count + nodes_before,
                    item.triangle_base + leaf_triangles + triangles_before});
    }
    if (is_ready && k == 0) {
        if (inner == 0) emit.raise_depth(static_cast<int32_t>(item.depth));
        memory.node.exponents_and_inner = inner << 24;
        lay_grid(memory.node, all);
        memory.node.child_base = item.child_base;
        memory.node.triangle_base = item.triangle_base;
        memory.node.triangles = leaves;
        memory.node.byte_base = kByteBase;
    }
    for (uint32_t i = 0; i < held; ++i) {
        const uint32_t before = leaves & ((1u << (8 * i + k)) - 1);
        memory.triangles[__popc(before)] = triangle_beneath(tree, child, i) | (i + 1 == held ? kLast : 0u);
    }
    __syncwarp();
    if (is_ready) {
        for (int axis = 0; axis < 3; ++axis) {
            uint32_t lower = kEmptyPlanes[0], upper = kEmptyPlanes[1];
            if (is_there) compress_extent(memory.node, axis, box, lower, upper);
            reinterpret_cast<unsigned char*>(memory.node.planes[2 * axis])[k] = static_cast<unsigned char>(lower);
            reinterpret_cast<unsigned char*>(memory.node.planes[2 * axis + 1])[k] = static_cast<unsigned char>(upper);
        }
    }
    __syncwarp();
    if (!is_ready) return;
    if (k < sizeof(CompressedBvhNode) / 16) {
        reinterpret_cast<uint4*>(emit.nodes + index)[k] = reinterpret_cast<const uint4*>(&memory.node)[k];
    }
    for (uint32_t i = k; i < leaf_triangles; i += kMaxWidth) {
        emit.sources[item.triangle_base + i] = memory.triangles[i] & ~kLast;
    }
    // Triangles are copied in 16-byte pieces; the last piece of each holds the flags.
    for (uint32_t piece = k; piece < 3 * leaf_triangles; piece += kMaxWidth) {
        const uint32_t i = piece / 3;
        const uint32_t triangle = memory.triangles[i];
        uint4 value = __ldg(reinterpret_cast<const uint4*>(emit.triangles + (triangle & ~kLast)) + piece % 3);
        if (piece % 3 == 2) value.w = (value.w & ~kLastInLeaf) | (triangle & kLast ? kLastInLeaf : 0u);
        reinterpret_cast<uint4*>(emit.placed + item.triangle_base)[piece] = value;
    }
}

/// Makes wide nodes in the order in which they are placed, eight lanes each. That order depends on timing, but each
/// node has a fixed number. The maker of the i-th node waits until it is placed, which happens only while fewer nodes
/// are placed than there are warps. In the order of numbers most would wait for a parent that is made at the same
/// time: 2.9 ms instead of 1.8 ms for 8.2 M triangles on an H200.
__device__ inline void emit_together(const EmitWide& emit, GroupMemory& memory) {
    const int head = static_cast<int>(threadIdx.x & 24u); // first lane of the group; the others use its value
    uint32_t first = 0, total = 0;
    do {
        if ((threadIdx.x & 31u) == 0)
            first = (atomicAdd(&emit.counts->drawn, 1u) + 1) * kNodesAtOnce; // the counter starts at -1
        first = __shfl_sync(kAllLanes, first, 0);
        const uint32_t slot = first + (threadIdx.x & 31u) / kMaxWidth;
        bool waits = slot < emit.capacity;
        while (__any_sync(kAllLanes, waits)) {
            WideItem item = {kNone, 0, 0, 0};
            uint32_t index = kNone;
            if (waits) {
                total = *static_cast<volatile uint32_t*>(&emit.counts->nodes);
                if (slot == 0) {
                    item = emit.first_item();
                    index = 0;
                } else if (total != kNone) {
                    waits = slot < total && total <= emit.capacity;
                    if (waits) {
                        item = load_item(emit.items + slot);
                        index = *static_cast<volatile uint32_t*>(emit.item_nodes + slot);
                    }
                }
            }
            if (index == kNone) item.node = kNone; // both parts are there or neither is
            index = __shfl_sync(kAllLanes, index, head);
            item.node = __shfl_sync(kAllLanes, item.node, head);
            item.depth = __shfl_sync(kAllLanes, item.depth, head);
            item.child_base = __shfl_sync(kAllLanes, item.child_base, head);
            item.triangle_base = __shfl_sync(kAllLanes, item.triangle_base, head);
            waits = __shfl_sync(kAllLanes, static_cast<uint32_t>(waits), head) != 0;
            const bool is_ready = item.node != kNone;
            if (__any_sync(kAllLanes, is_ready)) {
                make_together(emit, index, item, is_ready, memory);
                if (is_ready) waits = false;
            } else if (__any_sync(kAllLanes, waits)) {
                __nanosleep(20);
            }
        }
        // The total is known by now, but these nodes found no room.
        total = __shfl_sync(kAllLanes, *static_cast<volatile uint32_t*>(&emit.counts->nodes), 0);
    } while (first + kNodesAtOnce < total && total <= emit.capacity && first + kNodesAtOnce < emit.capacity);
}

__global__ void __launch_bounds__(kEmitThreads) emit_in_turn(EmitWide emit) {
    __shared__ GroupMemory of_groups[kEmitThreads / kMaxWidth];
    emit_together(emit, of_groups[threadIdx.x / kMaxWidth]);
}

} // namespace pertev::hploc

#endif
