#pragma once

// State of a ray between two turns of the traversal of a whole scene, for traversals that can be suspended
// (trace/dynamic_fetch.h): in one tree, or between the trees of a scene with instances. Trees are visited in the
// order of trace/walk_scene.h.

#include <cstdint>

#include "base/host_device.h"
#include "trace/walk_scene.h"
#include "trace/warps/warp_vote.h"

namespace pertev {

/// `Scene` is SceneTrees or SingleTree of the structure that is traversed.
template <class Walk, class Scene>
struct ScenePlace;

template <class Walk>
struct ScenePlace<Walk, SingleTree<typename Walk::Tree>> {
    using Scene = SingleTree<typename Walk::Tree>;
    typename Walk::Place place;

    HD explicit ScenePlace(typename Walk::Place::Slot* slots) : place(slots) {}

    HD bool is_done() const { return place.is_done(); }
    template <class Visitor>
    HD void start(const Scene& scene, const Ray& ray, const Visitor& visitor) {
        Walk::start(scene.baked, ray, visitor, place);
    }
    /// All of `lanes` must call it together; it does nothing for those that are done.
    template <class Visitor, class Counter>
    HD void turn(const Scene& scene, const Ray& ray, Visitor& visitor, const Counter& counter, LaneMask lanes,
                 int working) {
        if (Walk::turn(scene.baked, ray, kNoHit, place, visitor, counter, lanes, working)) place.stop();
    }
};

template <class Walk>
struct ScenePlace<Walk, SceneTrees<typename Walk::Tree>> {
    using Scene = SceneTrees<typename Walk::Tree>;
    typename Walk::Place place; // in `tree`
    typename Walk::Tree tree = {};
    Ray local; // the ray in the tree's space
    uint32_t instance = kNoHit;
    TreeWalk top = {kNoLink}; // state in the tree over instances; kNoLink at its end
    TreeStack::Slot top_stack[kMaxTopLevelDepth];

    HD explicit ScenePlace(typename Walk::Place::Slot* slots) : place(slots) {}

    HD bool is_done() const { return place.is_done() && top.link == kNoLink; }
    template <class Visitor>
    HD void start(const Scene& scene, const Ray& ray, const Visitor& visitor) {
        tree = scene.baked;
        local = ray;
        instance = kNoHit;
        top = {scene.top_root};
        Walk::start(tree, local, visitor, place);
    }
    /// All of `lanes` must call it together; it does nothing for those that are done.
    template <class Visitor, class Counter>
    HD void turn(const Scene& scene, const Ray& ray, Visitor& visitor, const Counter& counter, LaneMask lanes,
                 int working) {
        if (place.is_done() && top.link != kNoLink) next_tree(scene, ray, visitor, counter);
        if (Walk::turn(tree, local, instance, place, visitor, counter, lanes, working)) {
            place.stop();
            top.link = kNoLink;
        }
    }

private:
    template <class Visitor, class Counter>
    HD void next_tree(const Scene& scene, const Ray& ray, const Visitor& visitor, const Counter& counter) {
        if (instance != kNoHit) leave_leaf(top, top_stack, visitor.limit());
        if (top.link == kNoLink) return;
        const RayBoxes boxes = make_ray_boxes(ray.origin, ray.direction, scene.top_reach, scene.top_growth);
        const uint32_t leaf = next_leaf(top, scene.top_nodes, boxes, ray.t_min, visitor.limit(), top_stack, counter);
        if (leaf == kNoLink) {
            top.link = kNoLink;
            return;
        }
        const InstanceRecord record = load_aligned(scene.instances + (leaf & ~kLeafBit));
        instance = record.instance;
        tree = scene.meshes[record.mesh_bvh];
        local = ray_in_instance(record, ray, visitor.accept);
        Walk::start(tree, local, visitor, place);
    }
};

} // namespace pertev
