#pragma once

// Traversal of a whole scene: the baked tree first, then each instance that the TLAS leads to. Closest-hit and
// any-hit searches differ only in the visitor:
//   float limit() const                              boxes with a greater entry parameter are skipped
//   bool visit(instance, primitive, TriangleHit)     receives each candidate; returns true to end the traversal
//   bool visits_far_first() const                      whether far children should come first (trace_any.h); used by
//                                                    CompressedTraversal, traverse_wide.h and traversals_in_flight.h
// The set of triangles that a visitor receives may differ between structures; its result must not.

#include <cstdint>

#include "base/host_device.h"
#include "base/limits.h"
#include "trace/binary/traverse_tree.h"
#include "trace/binary/while_while_traversal.h"
#include "trace/scene_trees.h"

namespace pertev {

// A `Traversal` defines the traversal of one tree over triangles; that of the scene is common to all:
//   using Tree                                                  the structure, a view
//   static bool traverse(tree, ray, instance, visitor, counter)     `instance` is kNoHit if the triangles carry their
//   own;
//                                                               returns true if the visitor ended it

/// The default traversal: binary trees, near child first.
using PlainTraversal = WhileWhileTraversal<TraversalOptions{}>;

template <class Traversal, class Visitor, class Counter>
HD inline void traverse_scene(const SingleTree<typename Traversal::Tree>& scene, const Ray& ray, Visitor& visitor,
                              const Counter& counter) {
    Traversal::traverse(scene.baked, ray, kNoHit, visitor, counter);
}

template <class Traversal, class Visitor, class Counter>
HD inline void traverse_scene(const SceneTrees<typename Traversal::Tree>& scene, const Ray& ray, Visitor& visitor,
                              const Counter& counter) {
    TreeStack::Slot tlas_stack[kMaxTlasDepth];
    TreeTraversal top = {scene.tlas_root};
    typename Traversal::Tree tree = scene.baked;
    Ray local = ray;
    uint32_t instance = kNoHit;
    for (;;) { // one mesh per turn, so that a kernel has one copy of the inner traversal, and a warp reconverges here
        if (Traversal::traverse(tree, local, instance, visitor, counter)) return;
        if (instance != kNoHit) finish_leaf(top, tlas_stack, visitor.limit());
        if (top.link == kNoLink) return;
        // Recomputed in each turn, which is cheaper than keeping it in registers through the inner traversal.
        const RayBoxes boxes = make_ray_boxes(ray.origin, ray.direction, scene.tlas_reach, scene.tlas_growth);
        const uint32_t leaf = next_leaf(top, scene.tlas_nodes, boxes, ray.t_min, visitor.limit(), tlas_stack, counter);
        if (leaf == kNoLink) return;
        const InstanceRecord record = load_aligned(scene.instances + (leaf & ~kLeafBit));
        instance = record.instance;
        tree = scene.blases[record.blas];
        local = ray_in_instance(record, ray, visitor.accept);
    }
}

} // namespace pertev
