#pragma once

// Traversal of a queue of rays, as stages that rendering and the laboratory share. Each traversal's .cu file
// instantiates launch() for its stages.

#include <cstdint>

#include "device_scene/accept_queued.h"
#include "trace/trace_any.h"
#include "trace/trace_closest.h"

namespace pertev {

/// Traces ray i of the queue and counts work in `counter`. An any-hit search returns instance 0 if there is a hit.
template <class Traversal, bool kAny, class Accept, class Scene, class Counter>
HD inline Hit trace_queued(const Scene& scene, const TraceQuery& query, uint32_t i, const Counter& counter) {
    const Accept accept{query, i};
    const Ray ray = query.rays.load(i);
    Hit hit;
    if constexpr (kAny) {
        hit.instance = trace_any<Traversal>(scene, ray, accept, counter) ? 0 : kNoHit;
    } else {
        trace_closest<Traversal>(scene, ray, accept, hit, counter);
    }
    return hit;
}

template <bool kAny>
HD inline void store_hit(const HitQueueView& hits, uint32_t i, const Hit& hit) {
    if constexpr (kAny) {
        hits.store_any(i, hit.instance != kNoHit);
    } else {
        hits.store(i, hit);
    }
}

/// The stage that traces a queue. `Scene` is SceneTrees or SingleTree of the structure; `Accept` is AcceptOpaque or
/// AcceptQueued.
template <class Traversal, bool kAny, class Accept, class Scene>
struct TraceQueue {
    Scene scene;
    TraceQuery query;
    HitQueueView hits;

    HD void operator()(uint32_t i) const {
        store_hit<kAny>(hits, i, trace_queued<Traversal, kAny, Accept>(scene, query, i, NoTraversalCounter{}));
    }
};

/// The rays and hits of a queue for launch_dynamic_fetch (trace/dynamic_fetch.h).
template <bool kAny, class Accept>
struct QueueInOut {
    TraceQuery query;
    HitQueueView hits;

    HD Ray load(uint32_t i) const { return query.rays.load(i); }
    HD Accept accept(uint32_t i) const { return {query, i}; }
    HD void store(uint32_t i, const Hit& hit) const { store_hit<kAny>(hits, i, hit); }
};

/// The rays of a queue, like QueueInOut without stored hits.
template <class Accept>
struct QueueIn {
    TraceQuery query;

    HD Ray load(uint32_t i) const { return query.rays.load(i); }
    HD Accept accept(uint32_t i) const { return {query, i}; }
    HD void store(uint32_t, const Hit&) const {}
};

/// The stage that counts the work of a traversal. It is separate so that counting does not slow down the timed one.
template <class Traversal, bool kAny>
struct CountQueue {
    SceneTrees<typename Traversal::Tree> scene;
    TraceQuery query;
    RayWork* work;

    HD void operator()(uint32_t i) const {
        uint64_t nodes = 0, triangles = 0;
        trace_queued<Traversal, kAny, AcceptQueued<true>>(scene, query, i, TraversalCounter{&nodes, &triangles});
        work[i] = {static_cast<uint32_t>(nodes), static_cast<uint32_t>(triangles)};
    }
};

} // namespace pertev
