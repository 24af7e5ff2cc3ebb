#pragma once

// Whether a ray meets anything between t_min and t_max: true when a candidate exists (see trace_closest.h).
//
// Which candidate is met first is nobody's concern, so a walk may begin where one is likely to be met soon. Of a ray
// that has no end (to a sky or a sun) that is its far end: what stands there is large and plain (the walls of a room,
// the ground), while at its origin many boxes are entered in vain. Rays to the sky from Sponza's surfaces visit half of
// the nodes that they visit near children first, in the open (a forest) four fifths. So some walks of trees begin there
// (walk_scene.h; not that over instances). Of a ray that ends in the scene the better order is the scene's affair:
// docs/performance.md, "Rays to the sky".

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
    HD bool goes_far_first() const { return !(t_max < kInfinity); }
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
