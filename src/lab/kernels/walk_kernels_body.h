#pragma once

// The rows of the table of walk_kernels.h for one walk: included by the .cu files of this folder and by nothing else,
// since it holds the bodies of launches (see device/launch_body.h).

#include "device/launch_body.h"
#include "lab/walk_kernels.h"
#include "trace/dynamic_fetch.h"
#include "trace/persistent.h"

namespace pertev {

/// Calls run(scene): where all triangles are baked, with a scene that has no top level, which saves registers.
template <class Walk, class Run>
void with_scene(const AnyTrees& trees, const Run& run) {
    const auto& scene = std::get<SceneTrees<typename Walk::Tree>>(trees);
    if (scene.top_root == kNoLink) {
        run(SingleTree<typename Walk::Tree>{scene.baked});
    } else {
        run(scene);
    }
}

template <class Walk>
SingleTree<typename Walk::Tree> single_tree(const AnyTrees& trees) {
    return {std::get<SceneTrees<typename Walk::Tree>>(trees).baked};
}

template <class Walk, bool kAny>
void trace_batch(Queue& queue, const AnyTrees& trees, const RayBatch& batch, RayHit* hits) {
    with_scene<Walk>(trees, [&]<class Scene>(const Scene& scene) {
        launch(queue, "lab walk", batch.count, TraceRays<Walk, kAny, Scene>{scene, batch.rays, hits});
    });
}

template <class Walk, bool kAny>
void count_batch(Queue& queue, const AnyTrees& trees, const RayBatch& batch, RayWork* work) {
    const auto& scene = std::get<SceneTrees<typename Walk::Tree>>(trees);
    launch(queue, "lab count", batch.count, CountRays<Walk, kAny>{scene, batch.rays, work});
}

#if defined(__CUDACC__)

template <class Walk, bool kAny>
using SingleStage = TraceRays<Walk, kAny, SingleTree<typename Walk::Tree>>;

template <class Walk, bool kAny>
void trace_batch_persistent(Queue& queue, const AnyTrees& trees, const RayBatch& batch, RayHit* hits) {
    launch_persistent(queue, "lab persistent walk", batch.count,
                      SingleStage<Walk, kAny>{single_tree<Walk>(trees), batch.rays, hits}, batch.pool);
}

/// For launch_dynamic_fetch.
struct BatchInOut {
    const Ray* rays;
    RayHit* hits;

    HD Ray load(uint32_t i) const { return load_ray(rays, i); }
    HD void store(uint32_t i, const Hit& hit) const { hits[i] = {hit.t, hit.instance, hit.primitive}; }
};

template <class Walk, bool kAny>
void trace_batch_dynamic(Queue& queue, const AnyTrees& trees, const RayBatch& batch, RayHit* hits) {
    launch_dynamic_fetch<Walk, kAny>(queue, "lab dynamic fetch", single_tree<Walk>(trees).baked,
                                     BatchInOut{batch.rays, hits}, batch.count, batch.pool);
}

/// The counting of trace/lane_counter.h.
template <class Walk, bool kAny, class Scene>
struct CountLanes {
    Scene scene;
    const Ray* rays;
    LaneCounts* counts;

    HD void operator()(uint32_t i) const { trace_ray<Walk, kAny>(scene, load_ray(rays, i), LaneCounter{counts}); }
};

template <class Walk, bool kAny>
void count_lanes_of_batch(Queue& queue, const AnyTrees& trees, const RayBatch& batch, LaneCounts* counts) {
    with_scene<Walk>(trees, [&]<class Scene>(const Scene& scene) {
        launch(queue, "lab lanes", batch.count, CountLanes<Walk, kAny, Scene>{scene, batch.rays, counts});
    });
}

template <class Walk, bool kAny>
void count_lanes_persistent(Queue& queue, const AnyTrees& trees, const RayBatch& batch, LaneCounts* counts) {
    using Scene = SingleTree<typename Walk::Tree>;
    launch_persistent(queue, "lab lanes", batch.count,
                      CountLanes<Walk, kAny, Scene>{single_tree<Walk>(trees), batch.rays, counts}, batch.pool);
}

/// For launch_dynamic_fetch, where hits are not wanted.
struct BatchIn {
    const Ray* rays;

    HD Ray load(uint32_t i) const { return load_ray(rays, i); }
    HD void store(uint32_t, const Hit&) const {}
};

template <class Walk, bool kAny>
void count_lanes_dynamic(Queue& queue, const AnyTrees& trees, const RayBatch& batch, LaneCounts* counts) {
    launch_dynamic_fetch<Walk, kAny>(queue, "lab lanes", single_tree<Walk>(trees).baked, BatchIn{batch.rays},
                                     batch.count, batch.pool, LaneCounter{counts});
}

template <class Walk, bool kAny>
KernelLimits limits_one_a_thread(bool has_instances) {
    return has_instances ? limits_of(run_stage<TraceRays<Walk, kAny>>) : limits_of(run_stage<SingleStage<Walk, kAny>>);
}

#endif

/// Closest or any hit of one set of switches: one ray a thread, and in CUDA from a pool too. Lanes are counted with the
/// exact tests and near children first: each counting kernel takes as long to compile as a walk.
template <class Walk, bool kAny, bool kDynamic, bool kLanes>
void add_rows(WalkKind kind, const WalkOptions& options, std::vector<WalkKernel>& rows) {
    WalkKernel row = {kind, options, Distribution::OneAThread, kAny, true, kind != WalkKind::Packet};
    row.trace = trace_batch<Walk, kAny>;
    row.count = count_batch<Walk, kAny>;
#if defined(__CUDACC__)
    if constexpr (kLanes) row.count_lanes = count_lanes_of_batch<Walk, kAny>;
    row.limits = limits_one_a_thread<Walk, kAny>;
    rows.push_back(row);
    row.distribution = Distribution::Persistent;
    row.trace = trace_batch_persistent<Walk, kAny>;
    row.count = nullptr; // as one ray a thread
    if constexpr (kLanes) row.count_lanes = count_lanes_persistent<Walk, kAny>;
    row.limits = [](bool) { return limits_of(run_stage_persistent<SingleStage<Walk, kAny>>); };
    if constexpr (kDynamic) {
        rows.push_back(row);
        row.distribution = Distribution::DynamicFetch;
        row.trace = trace_batch_dynamic<Walk, kAny>;
        if constexpr (kLanes) row.count_lanes = count_lanes_dynamic<Walk, kAny>;
        row.limits = [](bool) { return limits_of(run_dynamic_fetch<Walk, kAny, BatchInOut, NoWalkCounter>); };
    }
#endif
    rows.push_back(row);
}

template <template <WalkOptions> class Walk, WalkOptions kOptions, bool kDynamic>
void add_kernels(WalkKind kind, std::vector<WalkKernel>& rows) {
    constexpr bool kLanes = kOptions.near_first && kOptions.is_exact();
    add_rows<Walk<kOptions>, false, kDynamic, kLanes>(kind, kOptions, rows);
    if constexpr (kOptions.rta && kOptions.rta_at_pops) {
        add_rows<Walk<for_any_hit(kOptions)>, true, kDynamic, kLanes>(kind, kOptions, rows);
    }
}

/// Every useful set of switches: tests that leak only with everything else on.
template <template <WalkOptions> class Walk, bool kDynamic = false>
void add_all_kernels(WalkKind kind, std::vector<WalkKernel>& rows) {
    add_kernels<Walk, WalkOptions{true, true}, kDynamic>(kind, rows);
    add_kernels<Walk, WalkOptions{false, true}, kDynamic>(kind, rows);
    add_kernels<Walk, WalkOptions{true, false}, kDynamic>(kind, rows);
    add_kernels<Walk, WalkOptions{false, false}, kDynamic>(kind, rows);
    add_kernels<Walk, WalkOptions{true, true, TestKind::Fast}, kDynamic>(kind, rows);
}

/// Those with the transforms of accel/bvh/woop_bvh.h.
template <template <WalkOptions> class Walk>
void add_woop_kernels(WalkKind kind, std::vector<WalkKernel>& rows) {
    add_kernels<Walk, WalkOptions{true, true, TestKind::Woop}, true>(kind, rows);
}

/// For a walk without an order of children.
template <template <WalkOptions> class Walk>
void add_unordered_kernels(WalkKind kind, std::vector<WalkKernel>& rows) {
    add_kernels<Walk, WalkOptions{true, true}, false>(kind, rows);
    add_kernels<Walk, WalkOptions{false, true}, false>(kind, rows);
    add_kernels<Walk, WalkOptions{true, true, TestKind::Fast}, false>(kind, rows);
}

} // namespace pertev
