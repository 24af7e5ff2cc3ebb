#pragma once

// Tests the run of triangles that a leaf is.

#include <cstdint>

#include "accel/bvh/bvh.h"
#include "base/host_device.h"
#include "trace/load_bvh.h"
#include "trace/ray.h"
#include "trace/ray_tests.h"

namespace pertev {

/// Shows the visitor each triangle of the run that the link `leaf` names and the ray hits. `instance` is kNoHit where
/// the triangles carry their own. True when the visitor ended the walk.
template <class Tests = ExactTests, class Visitor, class Counter>
HD inline bool test_leaf(const BvhTriangle* triangles, uint32_t leaf, const Ray& ray,
                         const typename Tests::Triangles& prepared, uint32_t instance, Visitor& visitor,
                         const Counter& counter) {
    for (const BvhTriangle* at = triangles + (leaf & ~kLeafBit);; ++at) {
        counter.add_triangle(at);
        const BvhTriangle triangle = load_aligned(at);
        TriangleHit hit;
        if (Tests::intersect(ray, prepared, triangle.a, triangle.b, triangle.c, hit) &&
            visitor.visit(instance == kNoHit ? triangle.instance : instance, triangle.primitive, hit)) {
            return true;
        }
        if (triangle.flags & kLastInLeaf) return false;
    }
}

} // namespace pertev
