#pragma once

// Tests the triangles of a leaf, or one of them.

#include <cstdint>

#include "accel/bvh/bvh.h"
#include "base/host_device.h"
#include "trace/intersect/load_bvh.h"
#include "trace/intersect/ray.h"
#include "trace/intersect/ray_tests.h"

namespace pertev {

/// Tests the triangle at `at` and passes a hit to the visitor; `last` is set to whether its leaf ends there.
/// `instance` is kNoHit if the triangles carry their own. Returns true if the visitor ended the traversal.
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

/// Tests each triangle of the leaf that the link `leaf` names.
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

/// Tests a leaf of a tree; trace/intersect/woop_tests.h has the overload for Woop's triangles.
template <class Tests, class Visitor, class Counter>
HD inline bool test_leaf(const BvhView& bvh, uint32_t leaf, const Ray& ray, const typename Tests::Triangles& prepared,
                         uint32_t instance, Visitor& visitor, const Counter& counter) {
    return test_leaf<Tests>(bvh.triangles, leaf, ray, prepared, instance, visitor, counter);
}

} // namespace pertev
