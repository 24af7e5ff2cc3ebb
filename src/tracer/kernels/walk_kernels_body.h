#pragma once

// Makes the rows of one traversal for the table in walk_kernels.h. Only .cu files of this folder include it, because
// it includes the bodies of launches (device/launch_body.h).

#include "device/launch_body.h"
#include "trace/dynamic_fetch.h"
#include "trace/warps/persistent.h"
#include "tracer/kernels/queue_stages.h"
#include "tracer/walk_kernels.h"

namespace pertev {

// Each traversal is compiled for opaque scenes with one tree, which saves registers, and for all scenes. Fast
// traversals are also compiled for non-opaque scenes with one tree, and those that rendering uses also for static
// instances.

/// Whether rendering uses this traversal by default.
template <class Walk>
inline constexpr bool kOfPictures = false;

/// Template arguments of a kernel besides the traversal.
template <class SceneOf, class AcceptOf>
struct Compiled {
    using Scene = SceneOf;
    using Accept = AcceptOf;
};
template <class Walk>
using OneOpaqueTree = Compiled<SingleTree<typename Walk::Tree>, AcceptOpaque>;
template <class Walk>
using OneTree = Compiled<SingleTree<typename Walk::Tree>, AcceptQueued<false>>;
template <class Walk>
using StillScene = Compiled<SceneTrees<typename Walk::Tree>, AcceptQueued<false>>;
template <class Walk>
using AnyScene = Compiled<SceneTrees<typename Walk::Tree>, AcceptQueued<true>>;

/// Calls run(scene, compiled) with the kernel for this scene and its surfaces.
template <class Walk, bool kFast, bool kStillToo, class Run>
void with_kernel(const AnyTrees& trees, const TraceQuery& query, const Run& run) {
    const auto& scene = std::get<SceneTrees<typename Walk::Tree>>(trees);
    if (scene.top_root == kNoLink && query.is_opaque()) return run(SingleTree{scene.baked}, OneOpaqueTree<Walk>{});
    if constexpr (kFast) {
        if (scene.top_root == kNoLink) return run(SingleTree{scene.baked}, OneTree<Walk>{});
    }
    if constexpr (kStillToo) {
        if (query.moving == nullptr) return run(scene, StillScene<Walk>{});
    }
    run(scene, AnyScene<Walk>{});
}

template <class Walk, bool kAny, bool kFast>
void trace_one_a_thread(Queue& queue, const AnyTrees& trees, const RayBatch& batch, const HitQueueView& hits) {
    constexpr bool kStillToo = kOfPictures<Walk> && !kFast;
    with_kernel<Walk, kFast || kOfPictures<Walk>, kStillToo>(
        trees, batch.query, [&]<class Kernel>(const auto& scene, Kernel) {
            using Stage = TraceQueue<Walk, kAny, typename Kernel::Accept, typename Kernel::Scene>;
            launch(queue, "trace rays", batch.count, Stage{scene, batch.query, hits});
        });
}

template <class Walk, bool kAny>
void count_work(Queue& queue, const AnyTrees& trees, const RayBatch& batch, RayWork* work) {
    const auto& scene = std::get<SceneTrees<typename Walk::Tree>>(trees);
    launch(queue, "count work", batch.count, CountQueue<Walk, kAny>{scene, batch.query, work});
}

#if defined(__CUDACC__)

template <class Walk, bool kAny, bool kFast>
void trace_persistent(Queue& queue, const AnyTrees& trees, const RayBatch& batch, const HitQueueView& hits) {
    with_kernel<Walk, kFast, false>(trees, batch.query, [&]<class Kernel>(const auto& scene, Kernel) {
        using Stage = TraceQueue<Walk, kAny, typename Kernel::Accept, typename Kernel::Scene>;
        launch_persistent(queue, "trace rays from a pool", batch.count, Stage{scene, batch.query, hits}, batch.pool);
    });
}

template <class Walk, bool kAny>
void trace_dynamic(Queue& queue, const AnyTrees& trees, const RayBatch& batch, const HitQueueView& hits) {
    with_kernel<Walk, true, kOfPictures<Walk>>(trees, batch.query, [&]<class Kernel>(const auto& scene, Kernel) {
        launch_dynamic_fetch<Walk, kAny>(queue, "trace rays, fetched", scene,
                                         QueueInOut<kAny, typename Kernel::Accept>{batch.query, hits}, batch.count,
                                         batch.pool);
    });
}

// Lanes are counted only in opaque scenes with one tree, because each counting kernel takes as long to compile as a
// traversal.

/// Counts lanes as in trace/warps/lane_counter.h.
template <class Walk, bool kAny>
struct CountLanes {
    SingleTree<typename Walk::Tree> scene;
    TraceQuery query;
    LaneCounts* counts;

    HD void operator()(uint32_t i) const {
        trace_queued<Walk, kAny, AcceptOpaque>(scene, query, i, LaneCounter{counts});
    }
};

template <class Walk, bool kAny, Distribution kDistribution>
void count_lanes(Queue& queue, const AnyTrees& trees, const RayBatch& batch, LaneCounts* counts) {
    const SingleTree<typename Walk::Tree> scene = {std::get<SceneTrees<typename Walk::Tree>>(trees).baked};
    if constexpr (kDistribution == Distribution::DynamicFetch) {
        launch_dynamic_fetch<Walk, kAny>(queue, "count lanes", scene, QueueIn<AcceptOpaque>{batch.query}, batch.count,
                                         batch.pool, LaneCounter{counts});
    } else if constexpr (kDistribution == Distribution::Persistent) {
        launch_persistent(queue, "count lanes", batch.count, CountLanes<Walk, kAny>{scene, batch.query, counts},
                          batch.pool);
    } else {
        launch_on_gpu(queue, "count lanes", batch.count, CountLanes<Walk, kAny>{scene, batch.query, counts});
    }
}

/// Limits of the kernel for opaque static scenes, with one tree or with instances.
template <class Walk, bool kAny, Distribution kDistribution, bool kStillToo = false>
KernelLimits limits(bool has_instances) {
    const auto of = []<class Kernel>(Kernel) {
        using Scene = typename Kernel::Scene;
        using Accept = typename Kernel::Accept;
        using Stage = TraceQueue<Walk, kAny, Accept, Scene>;
        if constexpr (kDistribution == Distribution::DynamicFetch) {
            return limits_of(run_dynamic_fetch<Walk, kAny, Scene, QueueInOut<kAny, Accept>, NoWalkCounter>);
        } else if constexpr (kDistribution == Distribution::Persistent) {
            return limits_of(run_stage_persistent<Stage>);
        } else {
            return limits_of(run_stage<Stage>);
        }
    };
    if (!has_instances) return of(OneOpaqueTree<Walk>{});
    if constexpr (kStillToo) return of(StillScene<Walk>{});
    return of(AnyScene<Walk>{});
}

#endif

/// Adds the rows of one set of switches, closest or any hit: one ray per thread and, in CUDA, a pool. `kFast` adds
/// dynamic fetch, which rendering then uses. `kLanes` adds lane counting.
template <class Walk, bool kAny, bool kFast, bool kLanes>
void add_rows(WalkKind kind, const WalkOptions& options, std::vector<WalkKernel>& rows) {
    WalkKernel row = {kind, options, Distribution::OneAThread, kAny, true, kind != WalkKind::Packet};
    row.trace = trace_one_a_thread<Walk, kAny, kFast>;
    row.count = count_work<Walk, kAny>;
#if defined(__CUDACC__)
    if constexpr (kLanes) row.count_lanes = count_lanes<Walk, kAny, Distribution::OneAThread>;
    row.limits = limits < Walk, kAny, Distribution::OneAThread, kOfPictures<Walk> && !kFast > ;
    rows.push_back(row);
    row.distribution = Distribution::Persistent;
    row.trace = trace_persistent<Walk, kAny, false>;
    row.count = nullptr; // the row with one ray per thread counts
    if constexpr (kLanes) row.count_lanes = count_lanes<Walk, kAny, Distribution::Persistent>;
    row.limits = limits<Walk, kAny, Distribution::Persistent>;
    if constexpr (kFast) {
        rows.push_back(row);
        row.distribution = Distribution::DynamicFetch;
        row.trace = trace_dynamic<Walk, kAny>;
        if constexpr (kLanes) row.count_lanes = count_lanes<Walk, kAny, Distribution::DynamicFetch>;
        row.limits = limits<Walk, kAny, Distribution::DynamicFetch, kOfPictures<Walk>>;
    }
#endif
    rows.push_back(row);
}

template <template <WalkOptions> class Walk, WalkOptions kOptions, bool kFast>
void add_kernels(WalkKind kind, std::vector<WalkKernel>& rows) {
    constexpr bool kLanes = kOptions.near_first && kOptions.is_exact();
    add_rows<Walk<kOptions>, false, kFast, kLanes>(kind, kOptions, rows);
    if constexpr (kOptions.rta && kOptions.rta_at_pops) {
        add_rows<Walk<for_any_hit(kOptions)>, true, kFast, kLanes>(kind, kOptions, rows);
    }
}

/// Adds every useful set of switches except the default one, which pictures.cu may have. Tests that leak are combined
/// only with all other switches on. Lanes are counted with the exact tests and near children first.
template <template <WalkOptions> class Walk, bool kFast = false>
void add_other_kernels(WalkKind kind, std::vector<WalkKernel>& rows) {
    add_kernels<Walk, WalkOptions{false, true}, kFast>(kind, rows);
    add_kernels<Walk, WalkOptions{true, false}, kFast>(kind, rows);
    add_kernels<Walk, WalkOptions{false, false}, kFast>(kind, rows);
    add_kernels<Walk, WalkOptions{true, true, TestKind::Fast}, kFast>(kind, rows);
}

/// Adds every useful set of switches.
template <template <WalkOptions> class Walk, bool kFast = false>
void add_all_kernels(WalkKind kind, std::vector<WalkKernel>& rows) {
    add_kernels<Walk, WalkOptions{}, kFast>(kind, rows);
    add_other_kernels<Walk, kFast>(kind, rows);
}

/// Adds the rows that use the transforms of accel/bvh/woop_bvh.h.
template <template <WalkOptions> class Walk>
void add_woop_kernels(WalkKind kind, std::vector<WalkKernel>& rows) {
    add_kernels<Walk, WalkOptions{true, true, TestKind::Woop}, true>(kind, rows);
}

/// Adds the rows of a traversal that does not order children.
template <template <WalkOptions> class Walk>
void add_unordered_kernels(WalkKind kind, std::vector<WalkKernel>& rows) {
    add_kernels<Walk, WalkOptions{true, true}, false>(kind, rows);
    add_kernels<Walk, WalkOptions{false, true}, false>(kind, rows);
    add_kernels<Walk, WalkOptions{true, true, TestKind::Fast}, false>(kind, rows);
}

} // namespace pertev
