#pragma once

// Chooses kernels, and makes the rows of one traversal for the table in traversal_kernels.h. Only .cu files include
// it, because it includes the bodies of launches (device/launch_body.h).

#include "device/launch_body.h"
#include "trace/dynamic_fetch.h"
#include "trace/warps/persistent.h"
#include "tracer/kernels/queue_stages.h"
#include "tracer/traversal_kernels.h"

namespace pertev {

// Each traversal is compiled for opaque scenes with one tree, which saves registers, and for all scenes. Fast
// traversals are also compiled for non-opaque scenes with one tree, and those that rendering uses also for static
// instances.

/// True for the traversals that rendering uses by default.
template <class Traversal>
inline constexpr bool kOfPictures = false;

/// Template arguments of a kernel besides the traversal.
template <class SceneOf, class AcceptOf>
struct Compiled {
    using Scene = SceneOf;
    using Accept = AcceptOf;
};
template <class Traversal>
using OneOpaqueTree = Compiled<SingleTree<typename Traversal::Tree>, AcceptOpaque>;
template <class Traversal>
using OneTree = Compiled<SingleTree<typename Traversal::Tree>, AcceptQueued<false>>;
template <class Traversal>
using StillScene = Compiled<SceneTrees<typename Traversal::Tree>, AcceptQueued<false>>;
template <class Traversal>
using AnyScene = Compiled<SceneTrees<typename Traversal::Tree>, AcceptQueued<true>>;

/// Calls run(scene, compiled) with the kernel for this scene and its surfaces.
template <class Traversal, bool kFast, bool kStillToo, class Run>
void with_kernel(const AnyTrees& trees, const TraceQuery& query, const Run& run) {
    const auto& scene = std::get<SceneTrees<typename Traversal::Tree>>(trees);
    if (scene.tlas_root == kNoLink && query.is_opaque())
        return run(SingleTree{scene.baked}, OneOpaqueTree<Traversal>{});
    if constexpr (kFast) {
        if (scene.tlas_root == kNoLink) return run(SingleTree{scene.baked}, OneTree<Traversal>{});
    }
    if constexpr (kStillToo) {
        if (query.moving == nullptr) return run(scene, StillScene<Traversal>{});
    }
    run(scene, AnyScene<Traversal>{});
}

template <class Traversal, bool kAny, bool kFast>
void trace_one_a_thread(Queue& queue, const AnyTrees& trees, const RayBatch& batch, const HitQueueView& hits) {
    constexpr bool kStillToo = kOfPictures<Traversal> && !kFast;
    with_kernel<Traversal, kFast || kOfPictures<Traversal>, kStillToo>(
        trees, batch.query, [&]<class Kernel>(const auto& scene, Kernel) {
            using Stage = TraceQueue<Traversal, kAny, typename Kernel::Accept, typename Kernel::Scene>;
            launch(queue, "trace rays", batch.count, Stage{scene, batch.query, hits});
        });
}

template <class Traversal, bool kAny>
void count_work(Queue& queue, const AnyTrees& trees, const RayBatch& batch, RayWork* work) {
    const auto& scene = std::get<SceneTrees<typename Traversal::Tree>>(trees);
    launch(queue, "count work", batch.count, CountQueue<Traversal, kAny>{scene, batch.query, work});
}

#if defined(__CUDACC__)

template <class Traversal, bool kAny, bool kFast>
void trace_persistent(Queue& queue, const AnyTrees& trees, const RayBatch& batch, const HitQueueView& hits) {
    with_kernel<Traversal, kFast, false>(trees, batch.query, [&]<class Kernel>(const auto& scene, Kernel) {
        using Stage = TraceQueue<Traversal, kAny, typename Kernel::Accept, typename Kernel::Scene>;
        launch_persistent(queue, "trace rays from a pool", batch.count, Stage{scene, batch.query, hits}, batch.pool);
    });
}

template <class Traversal, bool kAny>
void trace_dynamic(Queue& queue, const AnyTrees& trees, const RayBatch& batch, const HitQueueView& hits) {
    with_kernel<Traversal, true, kOfPictures<Traversal>>(
        trees, batch.query, [&]<class Kernel>(const auto& scene, Kernel) {
            launch_dynamic_fetch<Traversal, kAny>(queue, "trace rays, fetched", scene,
                                                  QueueInOut<kAny, typename Kernel::Accept>{batch.query, hits},
                                                  batch.count, batch.pool);
        });
}

// Lanes are counted only in opaque scenes with one tree, because each counting kernel takes as long to compile as a
// traversal.

/// The stage that counts active lanes (trace/warps/lane_counter.h).
template <class Traversal, bool kAny>
struct CountLanes {
    SingleTree<typename Traversal::Tree> scene;
    TraceQuery query;
    LaneCounts* counts;

    HD void operator()(uint32_t i) const {
        trace_queued<Traversal, kAny, AcceptOpaque>(scene, query, i, LaneCounter{counts});
    }
};

template <class Traversal, bool kAny, Distribution kDistribution>
void count_lanes(Queue& queue, const AnyTrees& trees, const RayBatch& batch, LaneCounts* counts) {
    const SingleTree<typename Traversal::Tree> scene = {std::get<SceneTrees<typename Traversal::Tree>>(trees).baked};
    if constexpr (kDistribution == Distribution::DynamicFetch) {
        launch_dynamic_fetch<Traversal, kAny>(queue, "count lanes", scene, QueueIn<AcceptOpaque>{batch.query},
                                              batch.count, batch.pool, LaneCounter{counts});
    } else if constexpr (kDistribution == Distribution::Persistent) {
        launch_persistent(queue, "count lanes", batch.count, CountLanes<Traversal, kAny>{scene, batch.query, counts},
                          batch.pool);
    } else {
        launch_on_gpu(queue, "count lanes", batch.count, CountLanes<Traversal, kAny>{scene, batch.query, counts});
    }
}

/// Limits of the kernel for opaque static scenes, with one tree or with instances.
template <class Traversal, bool kAny, Distribution kDistribution, bool kStillToo = false>
KernelLimits limits(bool has_instances) {
    const auto of = []<class Kernel>(Kernel) {
        using Scene = typename Kernel::Scene;
        using Accept = typename Kernel::Accept;
        using Stage = TraceQueue<Traversal, kAny, Accept, Scene>;
        if constexpr (kDistribution == Distribution::DynamicFetch) {
            return limits_of(run_dynamic_fetch<Traversal, kAny, Scene, QueueInOut<kAny, Accept>, NoTraversalCounter>);
        } else if constexpr (kDistribution == Distribution::Persistent) {
            return limits_of(run_stage_persistent<Stage>);
        } else {
            return limits_of(run_stage<Stage>);
        }
    };
    if (!has_instances) return of(OneOpaqueTree<Traversal>{});
    if constexpr (kStillToo) return of(StillScene<Traversal>{});
    return of(AnyScene<Traversal>{});
}

#endif

/// Adds the rows of one set of switches, closest or any hit: one ray per thread and, in CUDA, a pool. `kFast` adds
/// dynamic fetch, which rendering then uses. `kLanes` adds lane counting.
template <class Traversal, bool kAny, bool kFast, bool kLanes>
void add_rows(TraversalKind kind, const TraversalOptions& options, std::vector<TraversalKernel>& rows) {
    TraversalKernel row = {kind, options, Distribution::OneAThread, kAny, true, kind != TraversalKind::Packet};
    row.trace = trace_one_a_thread<Traversal, kAny, kFast>;
    row.count = count_work<Traversal, kAny>;
#if defined(__CUDACC__)
    if constexpr (kLanes) row.count_lanes = count_lanes<Traversal, kAny, Distribution::OneAThread>;
    row.limits = limits < Traversal, kAny, Distribution::OneAThread, kOfPictures<Traversal> && !kFast > ;
    rows.push_back(row);
    row.distribution = Distribution::Persistent;
    row.trace = trace_persistent<Traversal, kAny, false>;
    row.count = nullptr; // the row with one ray per thread counts
    if constexpr (kLanes) row.count_lanes = count_lanes<Traversal, kAny, Distribution::Persistent>;
    row.limits = limits<Traversal, kAny, Distribution::Persistent>;
    if constexpr (kFast) {
        rows.push_back(row);
        row.distribution = Distribution::DynamicFetch;
        row.trace = trace_dynamic<Traversal, kAny>;
        if constexpr (kLanes) row.count_lanes = count_lanes<Traversal, kAny, Distribution::DynamicFetch>;
        row.limits = limits<Traversal, kAny, Distribution::DynamicFetch, kOfPictures<Traversal>>;
    }
#endif
    rows.push_back(row);
}

template <template <TraversalOptions> class Traversal, TraversalOptions kOptions, bool kFast>
void add_kernels(TraversalKind kind, std::vector<TraversalKernel>& rows) {
    constexpr bool kLanes = kOptions.near_first && kOptions.is_exact();
    add_rows<Traversal<kOptions>, false, kFast, kLanes>(kind, kOptions, rows);
    if constexpr (kOptions.rta && kOptions.rta_at_pops) {
        add_rows<Traversal<for_any_hit(kOptions)>, true, kFast, kLanes>(kind, kOptions, rows);
    }
}

/// Adds every useful set of switches except the default one, which pictures.cu may have. Tests that leak are combined
/// only with all other switches on. Lanes are counted with the exact tests and near children first.
template <template <TraversalOptions> class Traversal, bool kFast = false>
void add_other_kernels(TraversalKind kind, std::vector<TraversalKernel>& rows) {
    add_kernels<Traversal, TraversalOptions{false, true}, kFast>(kind, rows);
    add_kernels<Traversal, TraversalOptions{true, false}, kFast>(kind, rows);
    add_kernels<Traversal, TraversalOptions{false, false}, kFast>(kind, rows);
    add_kernels<Traversal, TraversalOptions{true, true, TestKind::Fast}, kFast>(kind, rows);
}

/// Adds every useful set of switches.
template <template <TraversalOptions> class Traversal, bool kFast = false>
void add_all_kernels(TraversalKind kind, std::vector<TraversalKernel>& rows) {
    add_kernels<Traversal, TraversalOptions{}, kFast>(kind, rows);
    add_other_kernels<Traversal, kFast>(kind, rows);
}

/// Adds the rows that use the transforms of accel/bvh/woop_bvh.h.
template <template <TraversalOptions> class Traversal>
void add_woop_kernels(TraversalKind kind, std::vector<TraversalKernel>& rows) {
    add_kernels<Traversal, TraversalOptions{true, true, TestKind::Woop}, true>(kind, rows);
}

/// Adds the rows of a traversal that does not order children.
template <template <TraversalOptions> class Traversal>
void add_unordered_kernels(TraversalKind kind, std::vector<TraversalKernel>& rows) {
    add_kernels<Traversal, TraversalOptions{true, true}, false>(kind, rows);
    add_kernels<Traversal, TraversalOptions{false, true}, false>(kind, rows);
    add_kernels<Traversal, TraversalOptions{true, true, TestKind::Fast}, false>(kind, rows);
}

} // namespace pertev
