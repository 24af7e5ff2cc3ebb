#pragma once

// State of a ray between two turns of the traversal of a whole scene, for traversals that can be suspended
// (trace/dynamic_fetch.h): in one tree, or between the trees of a scene with instances. Trees are visited in the
// order of trace/traverse_scene.h.

#include <cstdint>

#include "base/host_device.h"
#include "trace/traverse_scene.h"
#include "trace/warps/warp_vote.h"

namespace pertev {

/// State of a traversal of a scene between two turns. `Scene` is SceneTrees or SingleTree of the structure that is
/// traversed.
template <class Traversal, class Scene>
struct SceneTraversalState;

template <class Traversal>
struct SceneTraversalState<Traversal, SingleTree<typename Traversal::Tree>> {
    using Scene = SingleTree<typename Traversal::Tree>;
    typename Traversal::State state;

    HD explicit SceneTraversalState(typename Traversal::State::Slot* slots) : state(slots) {}

    HD bool is_done() const { return state.is_done(); }
    template <class Visitor>
    HD void start(const Scene& scene, const Ray& ray, const Visitor& visitor) {
        Traversal::start(scene.baked, ray, visitor, state);
    }
    /// Takes one step. All of `lanes` must call it together; it does nothing for those that are done.
    template <class Visitor, class Counter>
    HD void step(const Scene& scene, const Ray& ray, Visitor& visitor, const Counter& counter, LaneMask lanes,
                 int working) {
        if (Traversal::step(scene.baked, ray, kNoHit, state, visitor, counter, lanes, working)) state.stop();
    }
};

template <class Traversal>
struct SceneTraversalState<Traversal, SceneTrees<typename Traversal::Tree>> {
    using Scene = SceneTrees<typename Traversal::Tree>;
    typename Traversal::State state; // in `tree`
    typename Traversal::Tree tree = {};
    Ray local; // the ray in the tree's space
    uint32_t instance = kNoHit;
    TreeTraversal top = {kNoLink}; // state in the tree over instances; kNoLink at its end
    TreeStack::Slot tlas_stack[kMaxTlasDepth];

    HD explicit SceneTraversalState(typename Traversal::State::Slot* slots) : state(slots) {}

    HD bool is_done() const { return state.is_done() && top.link == kNoLink; }
    template <class Visitor>
    HD void start(const Scene& scene, const Ray& ray, const Visitor& visitor) {
        tree = scene.baked;
        local = ray;
        instance = kNoHit;
        top = {scene.tlas_root};
        Traversal::start(tree, local, visitor, state);
    }
    /// Takes one step. All of `lanes` must call it together; it does nothing for those that are done.
    template <class Visitor, class Counter>
    HD void step(const Scene& scene, const Ray& ray, Visitor& visitor, const Counter& counter, LaneMask lanes,
                 int working) {
        if (state.is_done() && top.link != kNoLink) next_tree(scene, ray, visitor, counter);
        if (Traversal::step(tree, local, instance, state, visitor, counter, lanes, working)) {
            state.stop();
            top.link = kNoLink;
        }
    }

private:
    template <class Visitor, class Counter>
    HD void next_tree(const Scene& scene, const Ray& ray, const Visitor& visitor, const Counter& counter) {
        if (instance != kNoHit) finish_leaf(top, tlas_stack, visitor.limit());
        if (top.link == kNoLink) return;
        const RayBoxes boxes = make_ray_boxes(ray.origin, ray.direction, scene.tlas_reach, scene.tlas_growth);
        const uint32_t leaf = next_leaf(top, scene.tlas_nodes, boxes, ray.t_min, visitor.limit(), tlas_stack, counter);
        if (leaf == kNoLink) {
            top.link = kNoLink;
            return;
        }
        const InstanceRecord record = load_aligned(scene.instances + (leaf & ~kLeafBit));
        instance = record.instance;
        tree = scene.blases[record.blas];
        local = ray_in_instance(record, ray, visitor.accept);
        Traversal::start(tree, local, visitor, state);
    }
};

} // namespace pertev
