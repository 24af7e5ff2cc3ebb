#pragma once

// Tests the triangles that a leaf references. A triangle in several leaves is tested in each: that does not change
// the result, and costs less than remembering it.

#include <cstdint>

#include "accel/bvh/bvh.h"
#include "base/host_device.h"
#include "trace/intersect/load_bvh.h"
#include "trace/intersect/ray.h"
#include "trace/intersect/ray_tests.h"

namespace pertev {

/// Tests the triangles references[0] to references[count - 1] like test_leaf.
template <class Tests = ExactTests, class Visitor, class Counter>
HD inline bool test_references(const BvhTriangle* triangles, const uint32_t* references, uint32_t count, const Ray& ray,
                               const typename Tests::Triangles& prepared, uint32_t instance, Visitor& visitor,
                               const Counter& counter) {
    for (uint32_t i = 0; i < count; ++i) {
        const BvhTriangle* at = triangles + references[i];
        counter.add_triangle(at);
        const BvhTriangle triangle = load_aligned(at);
        TriangleHit hit;
        if (Tests::intersect(ray, prepared, triangle.a, triangle.b, triangle.c, hit) &&
            visitor.visit(instance == kNoHit ? triangle.instance : instance, triangle.primitive, hit)) {
            return true;
        }
    }
    return false;
}

} // namespace pertev
