#pragma once

// Closest-hit search. The result depends on the scene, not on the traversal: the least (t, instance, primitive) of
// all candidates, which are the triangles hit with t_min < t < t_max that `accept` lets count.

#include <cstdint>

#include "base/host_device.h"
#include "trace/traverse_scene.h"

namespace pertev {

/// Acceptance of every candidate.
struct AcceptAll {
    HD bool operator()(uint32_t, uint32_t, float, float) const { return true; }
};

template <class Accept>
struct ClosestVisitor {
    const Accept& accept;
    Hit best;

    HD float limit() const { return best.t; }
    HD bool is_done() const { return false; }
    HD static constexpr bool visits_far_first() { return false; }
    HD bool visit(uint32_t instance, uint32_t primitive, const TriangleHit& hit) {
        // Bit operations in place of branches, because lanes of a warp that differ here would be serialized.
        const bool lower = (instance < best.instance) | ((instance == best.instance) & (primitive < best.primitive));
        const bool first = (hit.t < best.t) | ((hit.t == best.t) & lower);
        if (first && accept(instance, primitive, hit.u, hit.v)) best = {hit.t, hit.u, hit.v, instance, primitive};
        return false;
    }
};

/// Finds the closest hit. Returns true and sets `hit` if there is a candidate; otherwise returns false and sets
/// hit.instance to kNoHit. `accept(instance, primitive, u, v)` is a pure function: a traversal may call it in any
/// order, for any subset of candidates that determines the result. `scene` is SceneTrees or SingleTree of the
/// traversal's structure.
template <class Traversal = PlainTraversal, class Scene, class Accept, class Counter = NoTraversalCounter>
HD inline bool trace_closest(const Scene& scene, const Ray& ray, const Accept& accept, Hit& hit,
                             const Counter& counter = {}) {
    ClosestVisitor<Accept> visitor = {accept, {}};
    visitor.best.t = ray.t_max;
    traverse_scene<Traversal>(scene, ray, visitor, counter);
    hit = visitor.best;
    return hit.instance != kNoHit;
}

} // namespace pertev
