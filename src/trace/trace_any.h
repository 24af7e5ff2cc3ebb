#pragma once

// Any-hit search: whether a ray hits anything between t_min and t_max, that is, whether a candidate exists
// (trace_closest.h).
//
// The order of candidates does not matter, so a traversal may start where a hit is likely. For a ray without an end
// (to a sky or a sun) that is its far end: surfaces there are large and simple (the walls of a room, the ground),
// while near its origin many boxes are entered without a hit. Rays to the sky from Sponza's surfaces visit half of
// the nodes that they visit with near children first, and four fifths in the open (a forest). So some tree traversals
// start there (traverse_scene.h; not the one over instances). For a ray that ends in the scene the best order depends
// on the scene: docs/performance.md, "Rays to the sky".

#include <cstdint>

#include "base/host_device.h"
#include "trace/traverse_scene.h"

namespace pertev {

template <class Accept>
struct AnyVisitor {
    const Accept& accept;
    float t_max;
    bool found = false;

    HD float limit() const { return t_max; }
    HD bool is_done() const { return found; }
    HD bool visits_far_first() const { return !(t_max < kInfinity); }
    HD bool visit(uint32_t instance, uint32_t primitive, const TriangleHit& hit) {
        found = accept(instance, primitive, hit.u, hit.v);
        return found;
    }
};

template <class Traversal = PlainTraversal, class Scene, class Accept, class Counter = NoTraversalCounter>
HD inline bool trace_any(const Scene& scene, const Ray& ray, const Accept& accept, const Counter& counter = {}) {
    AnyVisitor<Accept> visitor = {accept, ray.t_max};
    traverse_scene<Traversal>(scene, ray, visitor, counter);
    return visitor.found;
}

} // namespace pertev
