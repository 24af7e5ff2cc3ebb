#pragma once

// Woop's unit-triangle test, only for the laboratory: transforms the ray to the space in which the triangle is the
// unit triangle. The tree has the transforms (accel/bvh/woop_bvh.h), so the vertices are not read. Boxes are tested by
// FastTests.
//
// Sources: Woop, M.Sc. thesis, Saarland University, 2004, section 4.2; used by Aila, Laine, "Understanding the
// Efficiency of Ray Traversal on GPUs", HPG 2009, section 3.

#include <cstdint>

#include "accel/bvh/woop_bvh.h"
#include "base/host_device.h"
#include "trace/intersect/load_bvh.h"
#include "trace/intersect/ray.h"
#include "trace/intersect/ray_tests.h"

namespace pertev {

struct WoopTests {
    using Boxes = FastTests::Boxes;
    using Triangles = FastTests::Triangles;

    HD static Boxes make_boxes(const Ray& ray, float bounds_max_abs) {
        return FastTests::make_boxes(ray, bounds_max_abs);
    }
    HD static Triangles make_triangles(const Ray& ray) { return FastTests::make_triangles(ray); }
    /// Finds a hit at t_min < t < ray.t_max.
    HD static bool intersect(const Ray& ray, const WoopTriangle& w, TriangleHit& hit) {
        const auto dot_fma = [](Vec3 p, Vec3 q, float add) { return fma(p.x, q.x, fma(p.y, q.y, fma(p.z, q.z, add))); };
        const auto slope = [](Vec3 p, Vec3 q) { return fma(p.x, q.x, fma(p.y, q.y, p.z * q.z)); };
        const float t = -dot_fma(w.normal, ray.origin, w.height) * fast_reciprocal(slope(w.normal, ray.direction));
        const float u = fma(t, slope(w.u_row, ray.direction), dot_fma(w.u_row, ray.origin, w.u_shift));
        const float v = fma(t, slope(w.v_row, ray.direction), dot_fma(w.v_row, ray.origin, w.v_shift));
        if (!(u >= 0 && v >= 0 && u + v <= 1 && t > ray.t_min && t < ray.t_max)) return false;
        hit = {t, u, v};
        return true;
    }
};

/// Tests a leaf of a tree with Woop's transforms, like test_leaf() of trace/intersect/test_leaf.h.
template <class Tests, class Visitor, class Counter>
HD inline bool test_leaf(const WoopBvhView& bvh, uint32_t leaf, const Ray& ray, const typename Tests::Triangles&,
                         uint32_t instance, Visitor& visitor, const Counter& counter) {
    for (uint32_t i = leaf & ~kLeafBit;; ++i) {
        counter.add_triangle(bvh.transforms + i);
        const WoopTriangle triangle = load_aligned(bvh.transforms + i);
        TriangleHit hit;
        if (Tests::intersect(ray, triangle, hit) && hit.t <= visitor.limit()) { // otherwise its id is not needed
            const BvhTriangle* which = bvh.triangles + i;
            if (visitor.visit(instance == kNoHit ? which->instance : instance, which->primitive, hit)) return true;
        }
        if (bits_of(triangle.normal.x) & kLastInLeaf) return false;
    }
}

} // namespace pertev
