#pragma once

// The walk of a whole scene: the baked tree first, then each instance that the top level leads to. Closest and any hit
// differ only in the visitor:
//   float limit() const                              a box whose entry is greater holds nothing of interest
//   bool visit(instance, primitive, TriangleHit)     sees each candidate; true ends the walk
//   bool goes_far_first() const                      whether far children had better come first (trace_any.h):
//                                                    CompressedWalk, walk_wide.h and walk_in_flight.h ask it
// The set of triangles that a visitor sees may differ between structures; what it makes of them may not.

#include <cstdint>

#include "base/host_device.h"
#include "base/limits.h"
#include "trace/binary/walk_tree.h"
#include "trace/binary/while_while_walk.h"
#include "trace/scene_trees.h"

namespace pertev {

// A "walk" is how one tree over triangles is walked; the walk of the scene is the same for all:
//   using Tree                                                  what it walks, a view
//   static bool walk(tree, ray, instance, visitor, counter)     `instance` is kNoHit where the triangles carry their
//                                                               own; true when the visitor ended it

/// Where a caller names no walk: of binary trees, near child first.
using PlainWalk = WhileWhileWalk<WalkOptions{}>;

template <class Walk, class Visitor, class Counter>
HD inline void walk_scene(const SingleTree<typename Walk::Tree>& scene, const Ray& ray, Visitor& visitor,
                          const Counter& counter) {
    Walk::walk(scene.baked, ray, kNoHit, visitor, counter);
}

template <class Walk, class Visitor, class Counter>
HD inline void walk_scene(const SceneTrees<typename Walk::Tree>& scene, const Ray& ray, Visitor& visitor,
                          const Counter& counter) {
    TreeStack::Slot top_stack[kMaxTopLevelDepth];
    TreeWalk top = {scene.top_root};
    typename Walk::Tree tree = scene.baked;
    Ray local = ray;
    uint32_t instance = kNoHit;
    for (;;) { // one mesh a turn, so that the device has one copy of the inner walk and a warp meets again here
        if (Walk::walk(tree, local, instance, visitor, counter)) return;
        if (instance != kNoHit) leave_leaf(top, top_stack, visitor.limit());
        if (top.link == kNoLink) return;
        // Made anew at each turn: cheaper than keeping it in registers through the inner walk.
        const RayBoxes boxes = make_ray_boxes(ray.origin, ray.direction, scene.top_reach, scene.top_growth);
        const uint32_t leaf = next_leaf(top, scene.top_nodes, boxes, ray.t_min, visitor.limit(), top_stack, counter);
        if (leaf == kNoLink) return;
        const InstanceRecord record = load_aligned(scene.instances + (leaf & ~kLeafBit));
        instance = record.instance;
        tree = scene.meshes[record.mesh_bvh];
        local = ray_in_instance(record, ray, visitor.accept);
    }
}

} // namespace pertev
