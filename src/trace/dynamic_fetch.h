#pragma once

// Persistent threads with dynamic fetch: lanes whose rays are done get new ones while others are still in traversal,
// as soon as fewer than State::kRefillBelow of a warp's lanes are active. The loop of the traversal is the kernel, so
// it works for traversals that can be suspended between two turns (WhileWhileTraversal, SpeculativeTraversal,
// CompressedTraversal). In a scene with instances each lane proceeds from tree to tree independently
// (trace/scene_traversal_state.h). Only .cu files include this (device/launch_body.h).
//
// Besides the common interface (trace/traverse_scene.h), such a traversal has
//   State(State::Slot[State::kSlots])                  the state of a ray, initially done; is_done(), stop()
//   start(tree, ray, visitor, state)                   puts the ray at the root
//   step(tree, ray, instance, state, visitor, counter, lanes, working)    advances it; returns true if the visitor
//                                                      ended the traversal. `lanes` take this step together, `working`
//                                                      of them have an active ray; the step does nothing for the others
//
// Source: Aila, Laine, Karras, "Understanding the Efficiency of Ray Traversal on GPUs - Kepler and Fermi Addendum",
// 2012.

#include <cstdint>
#include <type_traits>

#include "base/error.h"
#include "base/host_device.h"
#include "device/queue.h"
#include "device/work_count.h"
#include "trace/scene_traversal_state.h"
#include "trace/trace_any.h"
#include "trace/trace_closest.h"
#include "trace/warps/kernel_limits.h"
#include "trace/warps/warp_vote.h"

namespace pertev {

/// A kind of search: the visitor, made for each ray, and the result. `accept` outlives it.
template <bool kAny, class Accept>
struct RaySearch;

template <class Accept>
struct RaySearch<false, Accept> {
    ClosestVisitor<Accept> visitor;
    HD RaySearch(const Accept& accept, float t_max) : visitor{accept, Hit{.t = t_max}} {}
    HD void restart(float t_max) { visitor.best = Hit{.t = t_max}; }
    HD Hit hit() const { return visitor.best; }
};

template <class Accept>
struct RaySearch<true, Accept> {
    AnyVisitor<Accept> visitor;
    HD RaySearch(const Accept& accept, float t_max) : visitor{accept, t_max} {}
    HD void restart(float t_max) {
        visitor.t_max = t_max;
        visitor.found = false;
    }
    HD Hit hit() const { return {.t = 0, .instance = visitor.found ? 0u : kNoHit}; }
};

#if PERTEV_HAS_KERNELS

/// Number of blocks that a multiprocessor should hold: for one tree as many as fit with 64 registers per thread,
/// though some spill.
template <class Scene>
inline constexpr int kBlocksWanted = 1;
template <class Tree>
inline constexpr int kBlocksWanted<SingleTree<Tree>> = 8;

/// Fetches the next `wanted` indices of a pool for a warp and returns the first. All lanes must be here: persistent.h
/// explains when ptxas 13.0 does not wait for them. In kernels of this file it does, because the SASS of all 103 has
/// no BMOV (b41ae20).
__device__ inline uint32_t fetch_from_pool(uint32_t* pool, uint32_t wanted) {
    uint32_t first = 0;
    if (threadIdx.x % 32 == 0) first = atomicAdd(pool, wanted);
    return __shfl_sync(0xffffffffu, first, 0);
}

template <class Traversal, bool kAny, class Scene, class Rays, class Counter>
__global__ void __launch_bounds__(kTraversalThreads, kBlocksWanted<Scene>)
    run_dynamic_fetch(Scene scene, Rays rays, WorkCount work, uint32_t* pool, Counter counter) {
    constexpr LaneMask kWarp = 0xffffffffu;
    constexpr uint32_t kNoRay = 0xffffffffu;
    uint32_t count = work.value(); // 0 once the pool is empty; equal in all lanes, like every exit of this loop
    typename Traversal::State::Slot slots[Traversal::State::kSlots];
    SceneTraversalState<Traversal, Scene> state(slots); // initially done, as whenever there is no ray
    auto accept = rays.accept(kNoRay);
    // Number of the lane's ray. Closest-hit searches have no register for it beside accept.i; with a separate one
    // any-hit searches are 1 % faster.
    uint32_t number = kNoRay;
    uint32_t& index = kAny ? number : accept.i;
    using Search = RaySearch<kAny, decltype(accept)>;
    Search search(accept, 0);
    Ray ray;
    for (;;) {
        if (count != 0) {
            const LaneMask idle = ballot(kWarp, index == kNoRay);
            const uint32_t wanted = static_cast<uint32_t>(count_lanes(idle));
            const uint32_t first = fetch_from_pool(pool, wanted);
            const uint32_t next = first + static_cast<uint32_t>(count_lanes(idle & lanes_before()));
            const bool has_next = index == kNoRay && next < count;
            if (first + wanted >= count) count = 0;
            if (has_next) {
                index = accept.i = next;
                ray = rays.load(index);
                search.restart(ray.t_max);
                state.start(scene, ray, search.visitor);
            }
        }
        if (ballot(kWarp, index != kNoRay) == 0) return; // the pool is empty too then
        const auto count_working = [&] { return count_lanes(ballot(kWarp, !state.is_done())); };
        for (int working = count_working(); working != 0;) { // by all lanes, because votes of a whole warp are
                                                             // cheapest
            state.step(scene, ray, search.visitor, counter, kWarp, working);
            working = count_working();
            if (count != 0 && working < Traversal::State::kRefillBelow) break;
        }
        if (index != kNoRay && state.is_done()) {
            rays.store(index, search.hit());
            index = kNoRay;
        }
        __syncwarp();
    }
}

#endif

#if defined(__CUDACC__)

/// Traverses a scene (SceneTrees or SingleTree) for rays [0, count), count <= kMaxPoolCount. `rays` has the
/// host-device functions `Ray load(uint32_t i) const`, `accept(uint32_t i) const`, which returns an Accept
/// (trace/trace_closest.h) with a member `i` that names its ray, and `void store(uint32_t i, const Hit&) const`. Of
/// an any-hit search only the hit's instance counts: kNoHit or not. `pool` is a counter in the queue's memory, 0 when
/// the launch runs. The queue is a GPU's.
template <class Traversal, bool kAny, class Scene, class Rays, class Counter = NoTraversalCounter>
void launch_dynamic_fetch(Queue& queue, const char* name, const Scene& scene, const Rays& rays, WorkCount count,
                          uint32_t* pool, const Counter& counter = {}) {
    PERTEV_CHECK(queue.is_cuda() && count.most <= kMaxPoolCount);
    if (count.most == 0) return;
    const Queue::Scope scope(queue, name);
    static LimitsByDevice limits;
    const uint32_t blocks = blocks_that_fit(limits.of(run_dynamic_fetch<Traversal, kAny, Scene, Rays, Counter>),
                                            count.most, queue.streams());
    run_dynamic_fetch<Traversal, kAny><<<blocks, kTraversalThreads, 0, static_cast<cudaStream_t>(queue.stream())>>>(
        scene, rays, count, pool, counter);
    queue.check_launch();
}

#endif

} // namespace pertev
