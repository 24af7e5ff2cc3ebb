#pragma once

// The first thing a ray meets. The result is a function of the scene, not of the walk: the least (t, instance,
// primitive) of all candidates, which are the triangles hit with t_min < t < t_max that `accept` lets count.

#include <cstdint>

#include "base/host_device.h"
#include "trace/walk_scene.h"

namespace pertev {

/// Every triangle counts.
struct AcceptAll {
    HD bool operator()(uint32_t, uint32_t, float, float) const { return true; }
};

template <class Accept>
struct ClosestVisitor {
    const Accept& accept;
    Hit best;

    HD float limit() const { return best.t; }
    HD bool is_done() const { return false; }
    HD static constexpr bool goes_far_first() { return false; }
    HD bool visit(uint32_t instance, uint32_t primitive, const TriangleHit& hit) {
        // Bits in place of branches: lanes of a warp that differ here would otherwise take turns.
        const bool lower = (instance < best.instance) | ((instance == best.instance) & (primitive < best.primitive));
        const bool first = (hit.t < best.t) | ((hit.t == best.t) & lower);
        if (first && accept(instance, primitive, hit.u, hit.v)) best = {hit.t, hit.u, hit.v, instance, primitive};
        return false;
    }
};

/// True and `hit` when there is a candidate; else false and hit.instance is kNoHit. `accept(instance, primitive, u, v)`
/// is a pure function: a walk may ask it in any order, and about any subset that decides the result. `scene` is
/// SceneTrees or SingleTree of what the walk walks.
template <class Walk = PlainWalk, class Scene, class Accept, class Counter = NoWalkCounter>
HD inline bool trace_closest(const Scene& scene, const Ray& ray, const Accept& accept, Hit& hit,
                             const Counter& counter = {}) {
    ClosestVisitor<Accept> visitor = {accept, {}};
    visitor.best.t = ray.t_max;
    walk_scene<Walk>(scene, ray, visitor, counter);
    hit = visitor.best;
    return hit.instance != kNoHit;
}

} // namespace pertev
