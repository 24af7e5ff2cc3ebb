#pragma once

// Whether a ray meets anything between t_min and t_max: true when a candidate exists (see trace_closest.h).

#include <cstdint>

#include "base/host_device.h"
#include "trace/walk_scene.h"

namespace pertev {

template <class Accept>
struct AnyVisitor {
    const Accept& accept;
    float t_max;
    bool found = false;

    HD float limit() const { return t_max; }
    HD bool is_done() const { return found; }
    HD bool visit(uint32_t instance, uint32_t primitive, const TriangleHit& hit) {
        found = accept(instance, primitive, hit.u, hit.v);
        return found;
    }
};

template <class Walk = PlainWalk, class Scene, class Accept, class Counter = NoWalkCounter>
HD inline bool trace_any(const Scene& scene, const Ray& ray, const Accept& accept, const Counter& counter = {}) {
    AnyVisitor<Accept> visitor = {accept, ray.t_max};
    walk_scene<Walk>(scene, ray, visitor, counter);
    return visitor.found;
}

} // namespace pertev
