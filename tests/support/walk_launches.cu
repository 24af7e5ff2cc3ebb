#include "tests/support/walk_launches.h"

#include <type_traits>

#include "device/launch_body.h"
#include "trace/binary/if_if_walk.h"
#include "trace/binary/octant_walk.h"
#include "trace/binary/parent_links_walk.h"
#include "trace/binary/short_stack_walk.h"
#include "trace/binary/speculative_walk.h"
#include "trace/binary/warp_packet_walk.h"
#include "trace/binary/while_while_walk.h"
#include "trace/dynamic_fetch.h"
#include "trace/warps/persistent.h"
#include "trace/wide/compressed_walk.h"

namespace pertev::test {
namespace {

constexpr const char* kOneAThread = "one a thread";

template <class Walk, bool kAny, class Scene, class Counter = NoWalkCounter>
struct TraceBatch {
    Scene scene;
    WalkBatch batch;
    Counter counter;

    HD void operator()(uint32_t i) const {
        const AcceptAll accept;
        Hit hit;
        if constexpr (kAny) {
            if (trace_any<Walk>(scene, batch.rays[i], accept, counter)) hit.instance = 0;
            hit.t = 0;
        } else {
            trace_closest<Walk>(scene, batch.rays[i], accept, hit, counter);
        }
        batch.hits[i] = hit;
    }
};

struct AcceptAllOf : AcceptAll {
    uint32_t i;
};

struct BatchRays {
    WalkBatch batch;

    HD AcceptAllOf accept(uint32_t i) const { return {{}, i}; }
    HD Ray load(uint32_t i) const { return batch.rays[i]; }
    HD void store(uint32_t i, const Hit& hit) const { batch.hits[i] = hit; }
};

/// From a pool on a GPU, or one ray a thread.
template <bool kPersistent, class Stage>
void run_stage_of(Queue& queue, const Stage& stage, const WalkBatch& batch) {
#if defined(__CUDACC__)
    if constexpr (kPersistent) return launch_persistent(queue, "trace persistent", batch.count, stage, batch.pool);
#endif
    if constexpr (!kPersistent) launch(queue, "trace", batch.count, stage);
}

/// The one of WalkTrees or WalkScenes that the walk is for.
template <class Walk>
const auto& pick(const auto& trees) {
    if constexpr (std::is_same_v<typename Walk::Tree, CompressedBvhView>) {
        return trees.compressed;
    } else {
        return trees.binary;
    }
}

template <class Walk, bool kAny, bool kPersistent>
void run_tree(Queue& queue, const WalkTrees& trees, const WalkBatch& batch) {
    const SingleTree<typename Walk::Tree> tree{pick<Walk>(trees)};
    run_stage_of<kPersistent>(queue, TraceBatch<Walk, kAny, SingleTree<typename Walk::Tree>>{tree, batch, {}}, batch);
}

template <class Walk, bool kAny, bool kPersistent>
void run_scene(Queue& queue, const WalkScenes& scenes, const WalkBatch& batch) {
    using Scene = SceneTrees<typename Walk::Tree>;
    run_stage_of<kPersistent>(queue, TraceBatch<Walk, kAny, Scene>{pick<Walk>(scenes), batch, {}}, batch);
}

#if defined(__CUDACC__)

template <class Walk, bool kAny>
void run_dynamic(Queue& queue, const WalkTrees& trees, const WalkBatch& batch) {
    launch_dynamic_fetch<Walk, kAny>(queue, "trace dynamic", SingleTree<typename Walk::Tree>{pick<Walk>(trees)},
                                     BatchRays{batch}, batch.count, batch.pool);
}

template <class Walk, bool kAny>
void run_dynamic_scene(Queue& queue, const WalkScenes& scenes, const WalkBatch& batch) {
    launch_dynamic_fetch<Walk, kAny>(queue, "trace dynamic", pick<Walk>(scenes), BatchRays{batch}, batch.count,
                                     batch.pool);
}

#endif

template <template <WalkOptions> class Walk, WalkOptions kOptions, bool kAny, bool kDynamic>
void add(const char* name, std::vector<WalkLaunch>& launches) {
    using W = Walk<kOptions>;
    WalkLaunch row = {name, kOneAThread, kOptions.rta, kOptions.near_first, kAny, run_tree<W, kAny, false>, nullptr};
    if constexpr (kOptions.rta) row.run_scene = run_scene<W, kAny, false>;
    launches.push_back(row);
#if defined(__CUDACC__)
    row.distribution = "persistent";
    row.run = run_tree<W, kAny, true>;
    if constexpr (kOptions.rta) row.run_scene = run_scene<W, kAny, true>;
    launches.push_back(row);
    if constexpr (kDynamic) {
        row.distribution = "dynamic fetch";
        row.run = run_dynamic<W, kAny>;
        row.run_scene = kOptions.rta ? run_dynamic_scene<W, kAny> : nullptr;
        launches.push_back(row);
    }
#endif
}

template <template <WalkOptions> class Walk, bool kDynamic>
void add_all(const char* name, std::vector<WalkLaunch>& launches) {
    add<Walk, WalkOptions{true, true}, false, kDynamic>(name, launches);
    add<Walk, WalkOptions{true, true}, true, kDynamic>(name, launches);
    add<Walk, WalkOptions{false, false}, false, kDynamic>(name, launches);
    add<Walk, WalkOptions{false, false}, true, kDynamic>(name, launches);
}

} // namespace

std::vector<WalkLaunch> walk_launches(bool on_cuda) {
    std::vector<WalkLaunch> launches;
    add_all<WhileWhileWalk, true>("while-while", launches);
    add_all<SpeculativeWalk, true>("speculative", launches);
    add_all<OctantWalk, false>("octants", launches);
    add_all<IfIfWalk, false>("if-if", launches);
    add_all<RestartTrailWalk, false>("restart trail", launches);
    add_all<ShortStackWalk, false>("short stack", launches);
    add_all<ParentLinksWalk, false>("parent links", launches);
    add_all<WarpPacketWalk, false>("warp packet", launches);
    add_all<CompressedWalk, true>("compressed", launches);
    if (!on_cuda) std::erase_if(launches, [](const WalkLaunch& row) { return row.distribution != kOneAThread; });
    return launches;
}

std::vector<LaneLaunch> lane_launches(bool on_cuda) {
    using Walk = WhileWhileWalk<WalkOptions{}>;
    using Stage = TraceBatch<Walk, false, SingleTree<BvhView>, LaneCounter>;
    std::vector<LaneLaunch> launches;
    launches.push_back([](Queue& queue, const BvhView& bvh, const WalkBatch& batch, LaneCounts* counts) {
        run_stage_of<false>(queue, Stage{{bvh}, batch, {counts}}, batch);
    });
#if defined(__CUDACC__)
    if (!on_cuda) return launches;
    launches.push_back([](Queue& queue, const BvhView& bvh, const WalkBatch& batch, LaneCounts* counts) {
        run_stage_of<true>(queue, Stage{{bvh}, batch, {counts}}, batch);
    });
    launches.push_back([](Queue& queue, const BvhView& bvh, const WalkBatch& batch, LaneCounts* counts) {
        launch_dynamic_fetch<Walk, false>(queue, "count lanes", SingleTree<BvhView>{bvh}, BatchRays{batch}, batch.count,
                                          batch.pool, LaneCounter{counts});
    });
#endif
    static_cast<void>(on_cuda);
    return launches;
}

} // namespace pertev::test
