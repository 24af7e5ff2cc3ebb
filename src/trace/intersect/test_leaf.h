#pragma once

// Tests the run of triangles that a leaf is, or one of them.

#include <cstdint>

#include "accel/bvh/bvh.h"
#include "base/host_device.h"
#include "trace/intersect/load_bvh.h"
#include "trace/intersect/ray.h"
#include "trace/intersect/ray_tests.h"

namespace pertev {

/// Shows the visitor the triangle at `at`, if the ray hits it; `last` tells whether its leaf ends
/// there. `instance` is kNoHit where the triangles carry their own. True when the visitor ended the walk.
template <class Tests = ExactTests, class Visitor, class Counter>
HD inline bool test_triangle(const BvhTriangle* at, const Ray& ray, const typename Tests::Triangles& prepared,
                             uint32_t instance, Visitor& visitor, const Counter& counter, bool& last) {
    counter.add_triangle(at);
    const BvhTriangle triangle = load_aligned(at);
    last = (triangle.flags & kLastInLeaf) != 0;
    TriangleHit hit;
    return Tests::intersect(ray, prepared, triangle.a, triangle.b, triangle.c, hit) &&
           visitor.visit(instance == kNoHit ? triangle.instance : instance, triangle.primitive, hit);
}

/// The same of each triangle of the run that the link `leaf` names.
template <class Tests = ExactTests, class Visitor, class Counter>
HD inline bool test_leaf(const BvhTriangle* triangles, uint32_t leaf, const Ray& ray,
                         const typename Tests::Triangles& prepared, uint32_t instance, Visitor& visitor,
                         const Counter& counter) {
    for (const BvhTriangle* at = triangles + (leaf & ~kLeafBit);; ++at) {
        bool last;
        if (test_triangle<Tests>(at, ray, prepared, instance, visitor, counter, last)) return true;
        if (last) return false;
    }
}

/// The same, of a tree; trace/intersect/woop_tests.h has that of a tree with Woop's triangles.
template <class Tests, class Visitor, class Counter>
HD inline bool test_leaf(const BvhView& bvh, uint32_t leaf, const Ray& ray, const typename Tests::Triangles& prepared,
                         uint32_t instance, Visitor& visitor, const Counter& counter) {
    return test_leaf<Tests>(bvh.triangles, leaf, ray, prepared, instance, visitor, counter);
}

} // namespace pertev
