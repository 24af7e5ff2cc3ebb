#pragma once

// The walk of a whole scene: the baked tree first, then each instance that the top level leads to. Closest and any hit
// differ only in the visitor:
//   static constexpr bool kNearestFirst              whether nearer boxes should be entered first
//   float limit() const                              a box whose entry is greater holds nothing of interest
//   bool visit(instance, primitive, TriangleHit)     sees each candidate; true ends the walk
// The set of triangles that a visitor sees may differ between structures; what it makes of them may not.

#include <cstdint>

#include "base/host_device.h"
#include "base/limits.h"
#include "trace/intersect_triangle.h"
#include "trace/scene_bvh.h"
#include "trace/walk_tree.h"
#if !PERTEV_ON_DEVICE
#include "trace/walk_wide.h"
#endif

namespace pertev {

/// Walks one mesh's tree. `instance` is kNoHit where the triangles carry their own. True when the visitor ended it.
template <class Visitor, class Counter>
HD inline bool walk_triangles(const BvhView& bvh, const Ray& ray, uint32_t instance, Visitor& visitor,
                              WalkStackEntry* stack, const Counter& counter) {
#if !PERTEV_ON_DEVICE
    if (bvh.wide != nullptr && !(bvh.root & kLeafBit)) return walk_wide(bvh, ray, instance, visitor, counter);
#endif
    const RayBoxes boxes = make_ray_boxes(ray.origin, ray.direction, bvh.bounds_max_abs);
    const RayShear shear = make_ray_shear(ray.direction);
    TreeWalk walk = {bvh.root};
    for (;;) {
        const uint32_t leaf =
            next_leaf<Visitor::kNearestFirst>(walk, bvh.nodes, boxes, ray.t_min, visitor.limit(), stack, counter);
        if (leaf == kNoLink) return false;
        for (const BvhTriangle* at = bvh.triangles + (leaf & ~kLeafBit);; ++at) {
            counter.add_triangle();
            const BvhTriangle triangle = load_aligned(at);
            TriangleHit hit;
            if (intersect_triangle(ray.origin, shear, ray.t_min, ray.t_max, triangle.a, triangle.b, triangle.c, hit) &&
                visitor.visit(instance == kNoHit ? triangle.instance : instance, triangle.primitive, hit)) {
                return true;
            }
            if (triangle.flags & kLastInLeaf) break;
        }
        leave_leaf(walk, stack, visitor.limit());
    }
}

template <class Visitor, class Counter>
HD inline void walk_scene(const SceneBvhView& scene, const Ray& ray, Visitor& visitor, const Counter& counter) {
    WalkStackEntry stack[kMaxBvhDepth], top_stack[kMaxTopLevelDepth];
    TreeWalk top = {scene.top_root};
    BvhView bvh = scene.baked;
    Ray local = ray;
    uint32_t instance = kNoHit;
    for (;;) { // one mesh a turn, so that the device has one copy of the inner walk and a warp meets again here
        if (walk_triangles(bvh, local, instance, visitor, stack, counter)) return;
        if (instance != kNoHit) leave_leaf(top, top_stack, visitor.limit());
        if (top.link == kNoLink) return;
        // Made anew at each turn: cheaper than keeping it in registers through the inner walk.
        const RayBoxes boxes = make_ray_boxes(ray.origin, ray.direction, scene.top_reach, scene.top_growth);
        const uint32_t leaf = next_leaf<Visitor::kNearestFirst>(top, scene.top_nodes, boxes, ray.t_min, visitor.limit(),
                                                                top_stack, counter);
        if (leaf == kNoLink) return;
        const InstanceRecord record = load_aligned(scene.instances + (leaf & ~kLeafBit));
        instance = record.instance;
        bvh = scene.meshes[record.mesh_bvh];
        local = transform_ray(record.local_from_world, ray);
    }
}

} // namespace pertev
