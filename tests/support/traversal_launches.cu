#include "tests/support/traversal_launches.h"

#include <type_traits>

#include "device/launch_body.h"
#include "trace/binary/if_if_traversal.h"
#include "trace/binary/octant_traversal.h"
#include "trace/binary/parent_links_traversal.h"
#include "trace/binary/short_stack_traversal.h"
#include "trace/binary/speculative_traversal.h"
#include "trace/binary/warp_packet_traversal.h"
#include "trace/binary/while_while_traversal.h"
#include "trace/dynamic_fetch.h"
#include "trace/warps/persistent.h"
#include "trace/wide/compressed_traversal.h"

namespace pertev::test {
namespace {

constexpr const char* kOneAThread = "one a thread";

template <class Traversal, bool kAny, class Scene, class Counter = NoTraversalCounter>
struct TraceBatch {
    Scene scene;
    TraversalBatch batch;
    Counter counter;

    HD void operator()(uint32_t i) const {
        const AcceptAll accept;
        Hit hit;
        if constexpr (kAny) {
            if (trace_any<Traversal>(scene, batch.rays[i], accept, counter)) hit.instance = 0;
            hit.t = 0;
        } else {
            trace_closest<Traversal>(scene, batch.rays[i], accept, hit, counter);
        }
        batch.hits[i] = hit;
    }
};

struct AcceptAllOf : AcceptAll {
    uint32_t i;
};

struct BatchRays {
    TraversalBatch batch;

    HD AcceptAllOf accept(uint32_t i) const { return {{}, i}; }
    HD Ray load(uint32_t i) const { return batch.rays[i]; }
    HD void store(uint32_t i, const Hit& hit) const { batch.hits[i] = hit; }
};

/// Launches a stage with persistent threads on a GPU, or with one ray per thread.
template <bool kPersistent, class Stage>
void run_stage_of(Queue& queue, const Stage& stage, const TraversalBatch& batch) {
#if defined(__CUDACC__)
    if constexpr (kPersistent) return launch_persistent(queue, "trace persistent", batch.count, stage, batch.pool);
#endif
    if constexpr (!kPersistent) launch(queue, "trace", batch.count, stage);
}

/// Returns the member of TraversalTrees or TraversalScenes for the traversal.
template <class Traversal>
const auto& pick(const auto& trees) {
    if constexpr (std::is_same_v<typename Traversal::Tree, CompressedBvhView>) {
        return trees.compressed;
    } else {
        return trees.binary;
    }
}

template <class Traversal, bool kAny, bool kPersistent>
void run_tree(Queue& queue, const TraversalTrees& trees, const TraversalBatch& batch) {
    const SingleTree<typename Traversal::Tree> tree{pick<Traversal>(trees)};
    run_stage_of<kPersistent>(queue, TraceBatch<Traversal, kAny, SingleTree<typename Traversal::Tree>>{tree, batch, {}},
                              batch);
}

template <class Traversal, bool kAny, bool kPersistent>
void run_scene(Queue& queue, const TraversalScenes& scenes, const TraversalBatch& batch) {
    using Scene = SceneTrees<typename Traversal::Tree>;
    run_stage_of<kPersistent>(queue, TraceBatch<Traversal, kAny, Scene>{pick<Traversal>(scenes), batch, {}}, batch);
}

#if defined(__CUDACC__)

template <class Traversal, bool kAny>
void run_dynamic(Queue& queue, const TraversalTrees& trees, const TraversalBatch& batch) {
    launch_dynamic_fetch<Traversal, kAny>(queue, "trace dynamic",
                                          SingleTree<typename Traversal::Tree>{pick<Traversal>(trees)},
                                          BatchRays{batch}, batch.count, batch.pool);
}

template <class Traversal, bool kAny>
void run_dynamic_scene(Queue& queue, const TraversalScenes& scenes, const TraversalBatch& batch) {
    launch_dynamic_fetch<Traversal, kAny>(queue, "trace dynamic", pick<Traversal>(scenes), BatchRays{batch},
                                          batch.count, batch.pool);
}

#endif

template <template <TraversalOptions> class Traversal, TraversalOptions kOptions, bool kAny, bool kDynamic>
void add(const char* name, std::vector<TraversalLaunch>& launches) {
    using W = Traversal<kOptions>;
    TraversalLaunch row = {name,   kOneAThread, kOptions.rta, kOptions.near_first, kAny, run_tree<W, kAny, false>,
                           nullptr};
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

template <template <TraversalOptions> class Traversal, bool kDynamic>
void add_all(const char* name, std::vector<TraversalLaunch>& launches) {
    add<Traversal, TraversalOptions{true, true}, false, kDynamic>(name, launches);
    add<Traversal, TraversalOptions{true, true}, true, kDynamic>(name, launches);
    add<Traversal, TraversalOptions{false, false}, false, kDynamic>(name, launches);
    add<Traversal, TraversalOptions{false, false}, true, kDynamic>(name, launches);
}

} // namespace

std::vector<TraversalLaunch> traversal_launches(bool on_cuda) {
    std::vector<TraversalLaunch> launches;
    add_all<WhileWhileTraversal, true>("while-while", launches);
    add_all<SpeculativeTraversal, true>("speculative", launches);
    add_all<OctantTraversal, false>("octants", launches);
    add_all<IfIfTraversal, false>("if-if", launches);
    add_all<RestartTrailTraversal, false>("restart trail", launches);
    add_all<ShortStackTraversal, false>("short stack", launches);
    add_all<ParentLinksTraversal, false>("parent links", launches);
    add_all<WarpPacketTraversal, false>("warp packet", launches);
    add_all<CompressedTraversal, true>("compressed", launches);
    if (!on_cuda) std::erase_if(launches, [](const TraversalLaunch& row) { return row.distribution != kOneAThread; });
    return launches;
}

std::vector<LaneLaunch> lane_launches(bool on_cuda) {
    using Traversal = WhileWhileTraversal<TraversalOptions{}>;
    using Stage = TraceBatch<Traversal, false, SingleTree<BvhView>, LaneCounter>;
    std::vector<LaneLaunch> launches;
    launches.push_back([](Queue& queue, const BvhView& bvh, const TraversalBatch& batch, LaneCounts* counts) {
        run_stage_of<false>(queue, Stage{{bvh}, batch, {counts}}, batch);
    });
#if defined(__CUDACC__)
    if (!on_cuda) return launches;
    launches.push_back([](Queue& queue, const BvhView& bvh, const TraversalBatch& batch, LaneCounts* counts) {
        run_stage_of<true>(queue, Stage{{bvh}, batch, {counts}}, batch);
    });
    launches.push_back([](Queue& queue, const BvhView& bvh, const TraversalBatch& batch, LaneCounts* counts) {
        launch_dynamic_fetch<Traversal, false>(queue, "count lanes", SingleTree<BvhView>{bvh}, BatchRays{batch},
                                               batch.count, batch.pool, LaneCounter{counts});
    });
#endif
    static_cast<void>(on_cuda);
    return launches;
}

} // namespace pertev::test
