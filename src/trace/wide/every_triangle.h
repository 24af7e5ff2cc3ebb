#pragma once

// Rays of a small scene, host only: each is tested against every triangle, many rays at a time. For a few dozen
// triangles that is cheaper than a tree, whose boxes rays without coherence share too rarely. Rays are grouped by the
// largest component of their directions, because those of a group share the order of axes of the triangle test. Hits
// are those of the tree to the bit.

#include <array>
#include <cstdint>
#include <utility>

#include "trace/intersect/intersect_4_triangles.h"
#include "trace/scene_trees.h"
#include "trace/wide/nearest_triangles.h"

namespace pertev {

/// Scenes with more triangles for each ray at a time use their trees: with sixteen lanes, rooms of 96 triangles are
/// traced about as fast either way.
inline constexpr uint32_t kMaxTrianglesPerLane = 6;

/// Returns whether EveryTriangle may trace the scene's rays.
inline bool is_small(const HostTrees& scene) {
    return scene.tlas_root == kNoLink && scene.baked.nodes != nullptr &&
           scene.baked.triangle_count <= kMaxTrianglesPerLane * triangle_tests().lanes;
}

/// Tests rays against all triangles of `bvh`; kAny says that any hit will do. Other parameters are those of
/// traverse_scene_in_flight.
template <bool kAny, class RayOf, class AcceptOf, class MakeVisitor, class End>
class EveryTriangle {
    using Accept = decltype(std::declval<AcceptOf>()(0));
    using Visitor = decltype(std::declval<MakeVisitor>()(std::declval<const Accept&>(), std::declval<const Ray&>()));

public:
    EveryTriangle(const WideBvhView<kWideChildren>& bvh, const RayOf& ray_of, const AcceptOf& accept_of,
                  const MakeVisitor& make_visitor, const End& end_of, const TriangleTests& tests = triangle_tests())
        : bvh_(bvh), ray_of_(ray_of), accept_of_(accept_of), make_visitor_(make_visitor), end_of_(end_of),
          tests_(tests) {}

    void run(uint32_t count) {
        for (uint32_t i = 0; i < count; ++i) {
            const Ray ray = ray_of_(i);
            const int kz = dominant_axis(ray.direction);
            Group& group = groups_[kz];
            group.rays[group.size] = ray;
            group.numbers[group.size] = i;
            if (++group.size == tests_.lanes) trace(group, kz);
        }
        for (int kz = 0; kz < 3; ++kz) {
            if (groups_[kz].size > 0) trace(groups_[kz], kz);
        }
    }

private:
    struct Group {
        Ray rays[kMaxLanes];
        uint32_t numbers[kMaxLanes];
        uint32_t size = 0;
    };

    void trace(Group& group, int kz) {
        for (uint32_t k = group.size; k < tests_.lanes; ++k) group.rays[k] = group.rays[0];
        NearestTriangles nearest;
        tests_.find({bvh_.triangles, bvh_.triangle_count}, group.rays, kz, (1u << group.size) - 1, kAny, nearest);
        for (uint32_t k = 0; k < group.size; ++k) {
            const Accept accept = accept_of_(group.numbers[k]);
            Visitor visitor = make_visitor_(accept, group.rays[k]);
            bool is_alone = (nearest.alone >> k & 1) != 0;
            if (!is_alone && nearest.triangle[k] != kNoTriangle) {
                const BvhTriangle& triangle = bvh_.triangles[nearest.triangle[k]];
                const float before = visitor.limit();
                const bool ended =
                    visitor.visit(triangle.instance, triangle.primitive, {nearest.t[k], nearest.u[k], nearest.v[k]});
                is_alone = !ended && visitor.limit() == before; // it does not count, so that another one may
            }
            if (is_alone) test_alone(group.rays[k], visitor);
            end_of_(group.numbers[k], visitor);
        }
        group.size = 0;
    }

    void test_alone(const Ray& ray, Visitor& visitor) const {
        const RayShear shear = make_ray_shear(ray.direction);
        for (uint32_t i = 0; i < bvh_.triangle_count; ++i) {
            const BvhTriangle& triangle = bvh_.triangles[i];
            TriangleHit hit;
            if (intersect_triangle(ray.origin, shear, ray.t_min, ray.t_max, triangle.a, triangle.b, triangle.c, hit) &&
                hit.t <= visitor.limit() && visitor.visit(triangle.instance, triangle.primitive, hit)) {
                return;
            }
        }
    }

    const WideBvhView<kWideChildren> bvh_;
    const RayOf& ray_of_;
    const AcceptOf& accept_of_;
    const MakeVisitor& make_visitor_;
    const End& end_of_;
    const TriangleTests& tests_;
    std::array<Group, 3> groups_;
};

} // namespace pertev
