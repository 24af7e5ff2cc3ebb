// The kernels of src/device/launch_body.h, src/trace/warps/persistent.h and src/trace/dynamic_fetch.h with the
// traversals that vote, compiled as device code (tests/support/emulated_device.h). Views, rays and hits of the host
// have the device's layout, so their addresses are valid for both. Nothing else passes between host and device.

#include "tests/support/emulated_traversals.h"

#include "tests/support/emulated_device.h" // device code from here on

#include <type_traits>

#include "device/launch_body.h"
#include "trace/binary/octant_traversal.h"
#include "trace/binary/speculative_traversal.h"
#include "trace/binary/warp_packet_traversal.h"
#include "trace/binary/while_while_traversal.h"
#include "trace/dynamic_fetch.h"
#include "trace/scene_trees.h"
#include "trace/warps/lane_counter.h"
#include "trace/warps/persistent.h"
#include "trace/wide/compressed_traversal.h"

namespace pertev {
namespace {

/// tests/support/check_traversal.h's.
struct AcceptSome {
    bool operator()(uint32_t instance, uint32_t primitive, float u, float) const {
        return (primitive * 2654435761u + instance) % 3 != 0 || u > 0.5f;
    }
};

struct Batch {
    const Ray* rays;
    Hit* hits;
    uint32_t* stores;
    uint32_t count;
    LaneCounts* lanes;

    Ray load(uint32_t i) const { return i < count ? rays[i] : Ray{}; }
    void store(uint32_t i, const Hit& hit) const {
        ++stores[i < count ? i : count];
        if (i < count) hits[i] = hit;
    }
    template <class Counter>
    Counter counter() const {
        if constexpr (std::is_same_v<Counter, LaneCounter>) {
            return {lanes};
        } else {
            return {};
        }
    }
};

template <class Traversal, bool kAny, class Accept, class Counter, class Scene>
struct TraceBatch {
    Scene scene;
    Batch batch;

    void operator()(uint32_t i) const {
        const Accept accept;
        const Ray ray = batch.load(i);
        const auto counter = batch.counter<Counter>();
        Hit hit;
        if constexpr (kAny) {
            if (trace_any<Traversal>(scene, ray, accept, counter)) hit.instance = 0;
            hit.t = 0;
        } else {
            trace_closest<Traversal>(scene, ray, accept, hit, counter);
        }
        batch.store(i, hit);
    }
};

template <class Traversal, bool kAny, class Accept, class Counter, class Scene>
void run_one_a_thread(const Scene& scene, const Batch& batch, uint32_t*) {
    run_stage(TraceBatch<Traversal, kAny, Accept, Counter, Scene>{scene, batch}, batch.count);
}

template <class Traversal, bool kAny, class Accept, class Counter, class Scene>
void run_persistent(const Scene& scene, const Batch& batch, uint32_t* pool) {
    run_stage_persistent(TraceBatch<Traversal, kAny, Accept, Counter, Scene>{scene, batch}, batch.count, pool);
}

/// The batch with the acceptance rule of each ray, in the kernel's form.
template <class Accept>
struct BatchAccepting : Batch {
    struct AcceptOf : Accept {
        uint32_t i;
    };
    AcceptOf accept(uint32_t i) const { return {{}, i}; }
};

template <class Traversal, bool kAny, class Accept, class Counter, class Scene>
void run_dynamic(const Scene& scene, const Batch& batch, uint32_t* pool) {
    run_dynamic_fetch<Traversal, kAny>(scene, BatchAccepting<Accept>{batch}, batch.count, pool,
                                       batch.counter<Counter>());
}

} // namespace
} // namespace pertev

#undef pertev // host code from here on

namespace pertev::test {
namespace {

namespace device = pertev_emulated;
using device::AcceptAll, device::AcceptSome, device::LaneCounter, device::NoTraversalCounter, device::SingleTree,
    device::TestKind, device::TraversalOptions;

/// Returns the host's object as one of the device.
template <class Device, class Host>
const Device& seen_by_device(const Host* host) {
    return *reinterpret_cast<const Device*>(host);
}

constexpr uint64_t kMaxStepsARay = 20'000; // about 5 times the observed number

/// Runs one thread's work in all threads.
template <class Run>
std::string run_threads(const EmulatedBatch& batch, bool one_a_thread, const Run& run) {
    constexpr uint32_t threads = device::kTraversalThreads;
    const uint32_t needed = (batch.count + threads - 1) / threads;
    const device::Batch rays = {reinterpret_cast<const device::Ray*>(batch.rays),
                                reinterpret_cast<device::Hit*>(batch.hits), batch.stores, batch.count,
                                reinterpret_cast<device::LaneCounts*>(batch.lanes)};
    return run_warps({.blocks = one_a_thread ? needed : batch.blocks,
                      .threads = threads,
                      .seed = batch.seed,
                      .max_steps = 1'000'000 + kMaxStepsARay * batch.count},
                     [&] { run(rays, batch.pool); });
}

/// Returns the member of EmulatedTrees or EmulatedScenes that the traversal reads.
template <class Traversal>
const auto* pick(const auto& trees) {
    if constexpr (std::is_same_v<typename Traversal::Tree, device::CompressedBvhView>) {
        return trees.compressed;
    } else if constexpr (std::is_same_v<typename Traversal::Tree, device::WoopBvhView>) {
        return trees.woop;
    } else {
        return trees.binary;
    }
}

enum class Way { OneAThread, Persistent, Dynamic };
constexpr const char* kWays[] = {"one a thread", "persistent", "dynamic fetch"};
constexpr const char* kTests[] = {"exact", "fast", "woop"}; // names of TestKind

template <class Traversal, bool kAny, Way kWay, class Accept, class Counter, class Scene>
std::string run_in(const Scene& scene, const EmulatedBatch& batch) {
    return run_threads(batch, kWay == Way::OneAThread, [&](auto&&... given) {
        if constexpr (kWay == Way::OneAThread)
            device::run_one_a_thread<Traversal, kAny, Accept, Counter>(scene, given...);
        if constexpr (kWay == Way::Persistent)
            device::run_persistent<Traversal, kAny, Accept, Counter>(scene, given...);
        if constexpr (kWay == Way::Dynamic) device::run_dynamic<Traversal, kAny, Accept, Counter>(scene, given...);
    });
}

template <class Traversal, bool kAny, Way kWay, class Accept = AcceptAll, class Counter = NoTraversalCounter>
std::string run_tree(const EmulatedTrees& trees, const EmulatedBatch& batch) {
    using Tree = typename Traversal::Tree;
    return run_in<Traversal, kAny, kWay, Accept, Counter>(
        SingleTree<Tree>{seen_by_device<Tree>(pick<Traversal>(trees))}, batch);
}

template <class Traversal, bool kAny, Way kWay>
std::string run_scene(const EmulatedScenes& scenes, const EmulatedBatch& batch) {
    using Scene = device::SceneTrees<typename Traversal::Tree>;
    return run_in<Traversal, kAny, kWay, AcceptAll, NoTraversalCounter>(seen_by_device<Scene>(pick<Traversal>(scenes)),
                                                                        batch);
}

using Rows = std::vector<EmulatedTraversal>;

template <template <TraversalOptions> class Traversal, TraversalOptions kOptions, bool kAny, Way kWay>
void add_way(const char* name, Rows& rows) {
    using W = Traversal<kAny ? device::for_any_hit(kOptions) : kOptions>;
    constexpr bool kPlain = kOptions.rta && kOptions.near_first && kOptions.is_exact() && kOptions.rta_at_pops;
    EmulatedTraversal row = {name,         kWays[static_cast<int>(kWay)], kTests[static_cast<int>(kOptions.tests)],
                             kOptions.rta, kOptions.near_first,           kAny};
    row.run = run_tree<W, kAny, kWay>;
    rows.push_back(row);
    if constexpr (kPlain && !kAny) {
        row.counts_lanes = true;
        row.run = run_tree<W, kAny, kWay, AcceptAll, LaneCounter>;
        rows.push_back(row);
        row.counts_lanes = false;
    }
    if constexpr (kPlain) {
        row.cut_outs = true;
        row.run = run_tree<W, kAny, kWay, AcceptSome>;
        rows.push_back(row);
        row.cut_outs = false;
        row.run = nullptr;
        row.run_scene = run_scene<W, kAny, kWay>;
        rows.push_back(row);
    }
}

template <template <TraversalOptions> class Traversal, TraversalOptions kOptions, bool kAny, bool kDynamic>
void add_ways(const char* name, Rows& rows) {
    add_way<Traversal, kOptions, kAny, Way::OneAThread>(name, rows);
    add_way<Traversal, kOptions, kAny, Way::Persistent>(name, rows);
    if constexpr (kDynamic) add_way<Traversal, kOptions, kAny, Way::Dynamic>(name, rows);
}

template <template <TraversalOptions> class Traversal>
void add_woop(const char* name, Rows& rows) {
    add_ways<Traversal, TraversalOptions{true, true, TestKind::Woop}, false, true>(name, rows);
    add_ways<Traversal, TraversalOptions{true, true, TestKind::Woop}, true, true>(name, rows);
}

template <template <TraversalOptions> class Traversal, bool kDynamic>
void add_all(const char* name, Rows& rows) {
    add_ways<Traversal, TraversalOptions{}, false, kDynamic>(name, rows);
    add_ways<Traversal, TraversalOptions{}, true, kDynamic>(name, rows);
    add_ways<Traversal, TraversalOptions{false, false}, false, kDynamic>(name, rows);
    add_ways<Traversal, TraversalOptions{true, true, TestKind::Fast}, false, kDynamic>(name, rows);
    add_ways<Traversal, TraversalOptions{true, true, TestKind::Fast}, true, kDynamic>(name, rows);
}

} // namespace

std::vector<EmulatedTraversal> emulated_traversals() {
    Rows rows;
    add_all<device::WhileWhileTraversal, true>("while-while", rows);
    add_all<device::SpeculativeTraversal, true>("speculative", rows);
    add_woop<device::WhileWhileTraversal>("while-while", rows);
    add_woop<device::SpeculativeTraversal>("speculative", rows);
    add_all<device::CompressedTraversal, true>("compressed", rows);
    add_ways<device::CompressedTraversal, TraversalOptions{.rta_at_pops = false}, false, true>("compressed", rows);
    // It runs only with exact tests, because it tests triangles before t_min, where the fast tests may hit just behind
    // it.
    add_ways<device::OctantTraversal, TraversalOptions{}, false, false>("octants", rows);
    add_ways<device::OctantTraversal, TraversalOptions{}, true, false>("octants", rows);
    add_ways<device::OctantTraversal, TraversalOptions{false, false}, false, false>("octants", rows);
    add_all<device::WarpPacketTraversal, false>("warp packet", rows);
    return rows;
}

} // namespace pertev::test
